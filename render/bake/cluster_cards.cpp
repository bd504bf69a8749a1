// Each level has the clustered mesh of the solid parts, and some of the cards (cluster_cards.hpp).
#include "render/bake/cluster_cards.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "render/bake/cards.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

constexpr double largest_in_clusters = 2.5;  ///< times its size; they are seen from farther than an object's own

bool is_hidden(const std::vector<bool>& hidden, model::Index material) { return material < hidden.size() && hidden[material]; }

bool can_be_thinned(const Geometry& g, const GeometryPart& part, std::uint32_t largest_triangles) {
    const auto cards = thinnable_cards(g, part);
    return !cards.empty() && std::ranges::all_of(cards, [&](const auto& card) { return card.size() / 3 <= largest_triangles; });
}

void to_baked_colours(Geometry& g, GeometryPart&& part, model::Index material) {
    for (const std::uint32_t index : part.indices) {
        std::copy_n(g.baked[index].begin(), 3, g.vertices[index].colour);
        g.vertices[index].colour[3] = 255;
    }
    const auto same = std::ranges::find(g.parts, material, &GeometryPart::material);
    if (same == g.parts.end())
        g.parts.push_back({material, std::move(part.indices)});
    else
        same->indices.insert(same->indices.end(), part.indices.begin(), part.indices.end());
}

/// Input of all levels of the cards, and the reference for their errors.
struct Thinning {
    Thinning(const Geometry& geometry, const std::vector<GeometryPart>& parts, const CardLimits& wanted) : g(geometry) {
        limits.relative = wanted.slack;
        for (const GeometryPart& part : parts) {
            const bool any = is_hidden(wanted.hidden, part.material);
            cards.push_back({part.material, any ? single_triangles(part) : cards_of(g, part), area_of(g, part.indices)});
            spread(g, cards.back().cards, wanted.max_triangles);
            triangles += part.indices.size() / 3;
        }
        source.add(g.vertices, parts);
        MeshSurface everything;
        everything.add(g.vertices, g.parts);
        everything.add(g.vertices, parts);
        all = std::make_unique<measure::TriangleTree>(everything.view());
        limits.absolute = 0.0005F * all->diagonal();
        limits.max_queries = 1000 + triangles / 8;
    }

    struct OfMaterial {
        model::Index material;
        Cards cards;
        double area_m2;
    };
    const Geometry& g;
    std::vector<OfMaterial> cards;
    std::size_t triangles = 0;
    MeshSurface source;  ///< the cards
    std::unique_ptr<measure::TriangleTree> all;
    measure::DistanceLimits limits;
};

/// About `budget` triangles of cards, with vertices of their own.
Geometry some_of(const Thinning& from, double budget) {
    Geometry out;
    out.centre = from.g.centre;
    const double share = budget / static_cast<double>(from.triangles);
    for (const Thinning::OfMaterial& m : from.cards) {
        GeometryPart part{m.material, {}};
        std::map<std::uint32_t, std::uint32_t> taken;
        for (const std::uint32_t index : some_cards(m.cards, share)) {
            const auto [where, fresh] = taken.try_emplace(index, static_cast<std::uint32_t>(out.vertices.size()));
            if (fresh) {
                out.vertices.push_back(from.g.vertices[index]);
                out.baked.push_back(from.g.baked[index]);
            }
            part.indices.push_back(where->second);
        }
        enlarge_cards(out, part, m.cards, m.area_m2, largest_in_clusters);
        out.parts.push_back(std::move(part));
    }
    optimise(out);
    return out;
}

/// Upper bound of the two-sided distance between all cards and those that are left.
float bound_of(const Thinning& from, const Geometry& some) {
    const MeshSurface coarse(some.vertices, some.parts);
    const measure::DistanceBounds there =
        measure::directed_distance(from.source.view(), measure::TriangleTree(coarse.view()), from.limits);
    measure::DistanceLimits back = from.limits;
    back.known_lower = there.lower;
    return std::max(there.upper, measure::directed_distance(coarse.view(), *from.all, back).upper);
}

void add_to(Geometry& to, Level& level, Geometry&& cards) {
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    to.vertices.insert(to.vertices.end(), cards.vertices.begin(), cards.vertices.end());
    to.baked.insert(to.baked.end(), cards.baked.begin(), cards.baked.end());
    for (GeometryPart& part : cards.parts) {
        for (std::uint32_t& index : part.indices) index += base;
        level.triangles += static_cast<std::uint32_t>(part.indices.size() / 3);
        level.parts.push_back(std::move(part));
    }
}

/// The solid part for cards of that error: the coarsest level that is no worse, or else the finest. The level's error is the
/// larger of both.
Level solid_within(const std::vector<Level>& solid, float error_m) {
    Level level;
    if (!solid.empty()) {
        const auto found = std::ranges::find_if(solid, [&](const Level& l) { return l.error_m <= error_m; });
        level = found == solid.end() ? solid.back() : *found;
    }
    level.error_m = std::max(level.error_m, error_m);
    return level;
}

}  // namespace

std::vector<GeometryPart> take_cards(Geometry& g, const std::vector<bool>& cut_out, model::Index proxy_material,
                                     std::uint32_t largest_triangles, const std::vector<bool>& hidden) {
    std::vector<GeometryPart> parts = std::move(g.parts), cards;
    g.parts.clear();
    for (GeometryPart& part : parts) {
        if (part.material >= cut_out.size() || !cut_out[part.material])
            g.parts.push_back(std::move(part));
        else if (is_hidden(hidden, part.material) || can_be_thinned(g, part, largest_triangles))
            cards.push_back(std::move(part));
    }
    for (GeometryPart& part : parts)  // what was not moved
        if (!part.indices.empty()) to_baked_colours(g, std::move(part), proxy_material);
    return cards;
}

LodChain with_cards(LodChain chain, const Geometry& g, const std::vector<GeometryPart>& cards, const CardLimits& limits) {
    const Thinning from(g, cards, limits);
    std::vector<double> budgets{static_cast<double>(std::min<std::size_t>(limits.max_triangles, from.triangles))};
    while (budgets.back() >= 2.0 * limits.min_triangles) budgets.push_back(budgets.back() / 2);
    std::vector<Level> solid = std::move(chain.levels);
    chain.levels.clear();
    chain.full.centre = g.centre;
    for (; !budgets.empty(); budgets.pop_back()) {  // from the coarsest: a finer one must be better, else it is left out
        Geometry some = some_of(from, std::max(budgets.back(), 2.0));
        Level level = solid_within(solid, bound_of(from, some));
        if (!chain.levels.empty() && level.error_m >= chain.levels.back().error_m) continue;
        add_to(chain.full, level, std::move(some));
        chain.levels.push_back(std::move(level));
    }
    return chain;
}

}  // namespace surefoot::bake
