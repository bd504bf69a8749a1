// Levels of detail of one geometry: edges collapse or cards are thinned out, and mesh_distance bounds the errors.
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "render/bake/cards.hpp"
#include "render/bake/corners.hpp"
#include "render/bake/edge_collapse.hpp"
#include "render/bake/geometry.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/bake/picture_shift.hpp"
#include "render/bake/round_shapes.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

std::size_t Geometry::triangles() const {
    std::size_t n = 0;
    for (const GeometryPart& part : parts) n += part.indices.size() / 3;
    return n;
}

Box Geometry::box() const {
    Box box;
    for (const model::Vertex& v : vertices) box.grow(dvec3(position_of(v)));
    return box;
}

void raise_errors(std::vector<Level>& levels) {
    constexpr float apart = 1.001F;
    for (std::size_t i = levels.size(); i-- > 1;) {
        Level &finer = levels[i], &coarser = levels[i - 1];
        if (coarser.error_m <= finer.error_m)
            coarser.error_m =
                std::max(finer.error_m * apart, std::nextafter(finer.error_m, std::numeric_limits<float>::infinity()));
    }
}

void optimise(Geometry& geometry) {
    for (GeometryPart& part : geometry.parts) {
        meshopt_optimizeVertexCache(part.indices.data(), part.indices.data(), part.indices.size(), geometry.vertices.size());
    }
    std::vector<std::uint32_t> map(geometry.vertices.size(), model::none);
    std::vector<model::Vertex> kept;
    std::vector<std::array<std::uint8_t, 4>> baked;
    kept.reserve(geometry.vertices.size());
    baked.reserve(geometry.vertices.size());
    for (GeometryPart& part : geometry.parts) {
        for (std::uint32_t& index : part.indices) {
            if (map[index] == model::none) {
                map[index] = static_cast<std::uint32_t>(kept.size());
                kept.push_back(geometry.vertices[index]);
                baked.push_back(geometry.baked[index]);
            }
            index = map[index];
        }
    }
    geometry.vertices = std::move(kept);
    geometry.baked = std::move(baked);
}

namespace {

/// Leaves at most `share` of one material's triangles, and merges what is apart: for what edge collapses no longer make smaller.
std::vector<std::uint32_t> merge_apart(const Geometry& g, std::size_t vertices, const GeometryPart& part, double share) {
    const std::size_t triangles = part.indices.size() / 3;
    const std::size_t target = std::max<std::size_t>(2, static_cast<std::size_t>(static_cast<double>(triangles) * share)) * 3;
    if (target >= part.indices.size()) return part.indices;
    std::vector<std::uint32_t> out(part.indices.size());
    float unused = 0;  // its own error is no bound
    out.resize(meshopt_simplifySloppy(out.data(), part.indices.data(), part.indices.size(), g.vertices[0].position, vertices,
                                      sizeof(model::Vertex), target, 1.0F, &unused));
    return out;
}

/// A level whose picture lies off by more of its size shows baked colours instead, and counts as wrong by that much.
constexpr double squeezed_picture_error = 1.0 / 4;

/// What is thinned out.
struct Thinned {
    std::map<model::Index, Cards> cards;  ///< by material
    /// Cards are half or more of the whole, by area. One sees through such an object: a box of plain colours would be a dark
    /// solid. Its pixels cost most.
    bool mostly = false;
    [[nodiscard]] bool contains(model::Index material) const { return cards.contains(material); }
};

Thinned find_cards(const Geometry& g, const ChainOptions& options) {
    Thinned thinned;
    double of_cards = 0, all = 0;
    for (const GeometryPart& part : g.parts) {
        const double area = area_of(g, part.indices);
        all += area;
        if (part.material >= options.cut_out.size() || !options.cut_out[part.material]) continue;
        const bool hidden = part.material < options.hidden.size() && options.hidden[part.material];
        auto found = hidden ? single_triangles(part) : thinnable_cards(g, part);
        if (found.empty()) continue;
        of_cards += area;
        const std::size_t triangles = part.indices.size() / 3;
        spread(g, found, static_cast<std::size_t>(options.ratio * static_cast<double>(triangles)) + 1);
        thinned.cards[part.material] = std::move(found);
    }
    thinned.mostly = of_cards > 0 && 2 * of_cards >= all;
    return thinned;
}

/// Share of the solid triangles to keep in a level. If most triangles are cards, solid parts shrink in smaller steps, because a
/// trunk that is reduced to a few spikes shows in every crown.
double solid_share(const Thinned& thinned, double share) { return thinned.mostly ? std::sqrt(share) : share; }

/// Of the triangles of `parts`, those that simplify() is to leave.
double expected_share(const Thinned& thinned, const std::vector<GeometryPart>& parts, double share) {
    double all = 0, left = 0;
    for (const GeometryPart& part : parts) {
        const auto n = static_cast<double>(part.indices.size());
        all += n;
        left += n * (thinned.contains(part.material) ? share : solid_share(thinned, share));
    }
    return all > 0 ? left / all : share;
}

void optimise_order(GeometryPart& part, const Geometry& g) {
    meshopt_optimizeVertexCache(part.indices.data(), part.indices.data(), part.indices.size(), g.vertices.size());
}

/// How a level is made from the next finer one.
enum class Step : std::uint8_t { fixed_borders, free_borders, sloppy };

/// About `share` of the solid triangles of `from`.
std::vector<GeometryPart> collapse_solids(const Geometry& g, const Thinned& thinned, const std::vector<GeometryPart>& from,
                                          double share, bool fixed_borders) {
    std::vector<GeometryPart> solids;
    std::uint32_t target = 0;
    for (const GeometryPart& part : from) {
        if (thinned.contains(part.material)) continue;
        solids.push_back(part);
        const double left = solid_share(thinned, share) * (static_cast<double>(part.indices.size()) / 3.0);
        target += std::max(2U, static_cast<std::uint32_t>(left));
    }
    if (solids.empty()) return solids;
    CollapseOptions options;
    options.fixed_borders = fixed_borders;
    EdgeCollapse mesh(g.vertices, solids, options);
    mesh.reduce_to(target);
    return mesh.parts();
}

/// About `share` of the triangles of `from`, which has some of those of g. vertices: those of full detail.
Level simplify(const Geometry& g, std::size_t vertices, const Thinned& thinned, const std::vector<GeometryPart>& from,
               double share, Step step) {
    Level level;
    if (step != Step::sloppy) level.parts = collapse_solids(g, thinned, from, share, step == Step::fixed_borders);
    for (const GeometryPart& part : from) {
        const auto cards = thinned.cards.find(part.material);
        if (cards == thinned.cards.end() && step != Step::sloppy) continue;
        const auto all =
            std::find_if(g.parts.begin(), g.parts.end(), [&](const GeometryPart& p) { return p.material == part.material; });
        const double left = static_cast<double>(part.indices.size()) / static_cast<double>(all->indices.size());
        // Its input is a mesh with its seams whole: full detail.
        GeometryPart smaller{part.material, cards != thinned.cards.end()
                                                ? some_cards(cards->second, share * left)
                                                : merge_apart(g, vertices, *all, solid_share(thinned, share) * left)};
        if (!smaller.indices.empty()) level.parts.push_back(std::move(smaller));
    }
    for (GeometryPart& part : level.parts) {
        if (!thinned.contains(part.material)) optimise_order(part, g);
        level.triangles += static_cast<std::uint32_t>(part.indices.size() / 3);
    }
    return level;
}

/// What the faces of a box show: of each, the mean of the baked colours of what faces that way, by area as seen from there; and
/// of all where next to nothing does. In the order of box_level: down and up along x, y, z.
std::array<std::array<std::uint8_t, 4>, 6> face_colours(const Geometry& g) {
    constexpr double next_to_nothing = 0.01;
    std::array<dvec3, 7> sum{};  // 6: of all
    std::array<double, 7> area{};
    for (const GeometryPart& part : g.parts) {
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            dvec3 colour(0.0);
            std::array<dvec3, 3> at;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::array<std::uint8_t, 4>& baked = g.baked[part.indices[i + k]];
                colour += dvec3(baked[0], baked[1], baked[2]) / 3.0;
                at[k] = dvec3(position_of(g.vertices[part.indices[i + k]]));
            }
            const dvec3 facing = 0.5 * glm::cross(at[1] - at[0], at[2] - at[0]);
            const auto add = [&](std::size_t face, double seen) {
                sum[face] += seen * colour;
                area[face] += seen;
            };
            for (int axis = 0; axis < 3; ++axis)
                add(static_cast<std::size_t>(2 * axis) + (facing[axis] > 0 ? 1 : 0), std::abs(facing[axis]));
            add(6, glm::length(facing));
        }
    }
    std::array<std::array<std::uint8_t, 4>, 6> out{};
    for (std::size_t face = 0; face < 6; ++face) {
        const std::size_t of = area[face] > next_to_nothing * area[6] ? face : 6;
        const dvec3 mean = sum[of] / std::max(area[of], 1e-300);
        for (std::size_t c = 0; c < 3; ++c)
            out[face][c] = static_cast<std::uint8_t>(std::lround(std::clamp(mean[static_cast<int>(c)], 0.0, 255.0)));
        out[face][3] = 255;
    }
    return out;
}

/// The level again in the proxy material: one part, its own vertices with the baked colours, no texture to bind. But cards, which
/// would be solid, stay as they are.
void to_proxy(Geometry& g, const Thinned& thinned, Level& level, model::Index material) {
    GeometryPart part{material, {}};
    std::vector<GeometryPart> kept;
    std::vector<std::uint32_t> map(g.vertices.size(), model::none);
    for (const GeometryPart& p : level.parts) {
        if (thinned.contains(p.material) || p.material == material) {
            kept.push_back(p);
            continue;
        }
        for (const std::uint32_t index : p.indices) {
            if (map[index] == model::none) {
                map[index] = static_cast<std::uint32_t>(g.vertices.size());
                model::Vertex v = g.vertices[index];
                for (std::size_t c = 0; c < 3; ++c) v.colour[c] = g.baked[index][c];
                v.colour[3] = 255;
                g.vertices.push_back(v);
                g.baked.push_back(g.baked[index]);
            }
            part.indices.push_back(map[index]);
        }
    }
    if (!part.indices.empty()) kept.push_back(std::move(part));
    level.parts = std::move(kept);
}

/// Twelve triangles round everything: valid from everywhere, whatever the shape.
Level box_level(Geometry& g, const Box& box, model::Index proxy_material) {
    const auto largest = std::max_element(g.parts.begin(), g.parts.end(), [](const GeometryPart& a, const GeometryPart& b) {
        return a.indices.size() < b.indices.size();
    });
    const model::Index material = proxy_material != model::none ? proxy_material : largest->material;
    const auto colours = face_colours(g);
    Level level;
    GeometryPart part{material, {}};
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, w = (axis + 2) % 3;
        const bool high = face % 2 == 1;
        const std::array<std::uint8_t, 4>& mean = colours[static_cast<std::size_t>(face)];
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (int corner = 0; corner < 4; ++corner) {
            model::Vertex v{};
            std::copy(mean.begin(), mean.end(), v.colour);
            const bool cu = corner == 1 || corner == 2, cw = corner >= 2;
            v.position[axis] = static_cast<float>(high ? box.max[axis] : box.min[axis]);
            v.position[u] = static_cast<float>(cu == high ? box.max[u] : box.min[u]);  // counter-clockwise from outside
            v.position[w] = static_cast<float>(cw ? box.max[w] : box.min[w]);
            v.normal[axis] = high ? 127 : -127;
            g.vertices.push_back(v);
            g.baked.push_back(mean);
        }
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) part.indices.push_back(base + i);
    }
    level.triangles = 12;
    level.parts.push_back(std::move(part));
    return level;
}

/// The full detail, against which every level is bounded.
struct Reference {
    MeshSurface surface;
    measure::TriangleTree tree;
    measure::DistanceLimits limits;

    Reference(const Geometry& g, float slack) : surface(g.vertices, g.parts), tree(surface.view()) {
        limits.relative = slack;
        limits.absolute = 0.0005F * tree.diagonal();  // half a pixel where it fills a screen of 1000
    }
    /// Upper bound of the two-sided distance.
    [[nodiscard]] float bound(const Geometry& g, const Level& level) const {
        const MeshSurface coarse(g.vertices, level.parts);
        const measure::DistanceBounds there =
            measure::directed_distance(surface.view(), measure::TriangleTree(coarse.view()), limits);
        measure::DistanceLimits back = limits;
        back.known_lower = there.lower;
        return std::max(there.upper, measure::directed_distance(coarse.view(), tree, back).upper);
    }
};

/// A plate simplifies without geometric error. Without a minimum error it would lose its texture at any distance.
bool may_lose_pictures(const Level& level, const ChainOptions& options, double diagonal_m) {
    if (static_cast<double>(level.error_m) >= min_proxy_error * diagonal_m) return true;
    return std::none_of(level.parts.begin(), level.parts.end(), [&](const GeometryPart& part) {
        return part.material < options.pictures.size() && options.pictures[part.material] != Picture::none;
    });
}

/// Drops levels that are hardly better than the next coarser one: such a step costs time and shows nothing. Keeps full detail.
/// Where levels are to be close together, all are kept that are better at all.
void drop_little_gains(std::vector<Level>& levels, double ratio) {
    const float gain = ratio > 0.8 ? 0.999F : 0.9F;
    std::vector<Level> kept;
    for (Level& level : levels)
        if (kept.empty() || level.error_m <= gain * kept.back().error_m) kept.push_back(std::move(level));
    levels = std::move(kept);
}

/// What the steps of a chain share: full detail as measured, and the levels from fine to coarse.
struct ChainWork {
    Geometry& full;
    const ChainOptions& options;
    Box box = full.box();
    Reference reference{full, options.slack};
    Thinned thinned = find_cards(full, options);
    std::vector<Picture> laid_on = pictures_laid_on(options, thinned);
    PictureReference pictures{full, laid_on};
    CoincidentVertices coincident{full};
    std::size_t own_vertices = full.vertices.size();
    std::map<model::Index, double> card_area_m2 = {};  ///< by material
    std::vector<Level> levels = {};
    std::vector<GeometryPart> parts = full.parts;  ///< of the coarsest level so far, as the simplifier left them
    bool torn = false, squeezed = false;           ///< the pictures, from then on

    static std::vector<Picture> pictures_laid_on(const ChainOptions& options, const Thinned& thinned) {
        std::vector<Picture> laid_on = options.pictures;  // cards keep theirs, and miss it where they are left out
        laid_on.resize(std::max(laid_on.size(), options.cut_out.size()), Picture::none);
        for (const auto& [material, cards] : thinned.cards) laid_on[material] = Picture::none;
        return laid_on;
    }
    ChainWork(Geometry& geometry, const ChainOptions& chosen) : full(geometry), options(chosen) {
        for (const GeometryPart& part : full.parts)
            if (thinned.contains(part.material)) card_area_m2[part.material] = area_of(full, part.indices);
        levels.push_back({full.parts, static_cast<std::uint32_t>(full.triangles()), 0});
    }
    [[nodiscard]] bool may_colour() const { return options.proxy_material != model::none; }
    [[nodiscard]] float share_of_size(double share) const { return static_cast<float>(share * box.diagonal()); }
};

/// The simplifier's proposal for the next coarser level, in up to three tries; nothing if the chain ends here.
/// Borders first stay where they are: tiles of ground and walls that meet must not part. What is all border (leaves) gives way.
/// Pieces of one object keep their borders as long as that makes a level at all. Neighbours no longer meet after that.
std::optional<Level> next_level(ChainWork& work) {
    const double ratio = work.options.ratio, before = work.levels.back().triangles;
    const auto propose = [&](Step step) { return simplify(work.full, work.own_vertices, work.thinned, work.parts, ratio, step); };
    const double wanted = before * expected_share(work.thinned, work.parts, ratio);
    const double max_triangles = std::max(0.8, (1.0 + ratio) / 2) * before;  // above this it is no level of its own
    const auto is_level = [&](const Level& level) { return level.triangles > 0 && level.triangles <= max_triangles; };
    Level next = propose(Step::fixed_borders);
    if (work.options.is_piece && is_level(next)) return next;
    if (next.triangles > std::min(wanted * 1.4, max_triangles)) next = propose(Step::free_borders);
    if (!is_level(next) || next.triangles > std::max(wanted * 1.5, wanted + 0.02 * before)) {
        next = propose(Step::sloppy);
        work.torn = true;
    }
    if (!is_level(next)) return std::nullopt;
    return next;
}

/// Enlarges the cards that are left. The sloppy mode picks any of coincident vertices: there, corners get the best of them.
void finish_parts(ChainWork& work, Level& level) {
    for (GeometryPart& part : level.parts) {
        const auto cards = work.thinned.cards.find(part.material);
        if (cards == work.thinned.cards.end()) {
            if (work.torn) repair_corners(work.full, work.coincident, part);
            continue;
        }
        enlarge_cards(work.full, part, cards->second, work.card_area_m2[part.material]);
        optimise_order(part, work.full);
    }
}

/// Sets the level's error: the larger of its geometry's and its picture's. A torn or squeezed picture gives way to baked colours:
/// vertices from distant places of the texture were merged, and the colours still look like the object.
void bound_level(ChainWork& work, Level& level) {
    level.error_m = work.reference.bound(work.full, level);
    const bool pictured = std::any_of(level.parts.begin(), level.parts.end(), [&](const GeometryPart& part) {
        return part.material < work.laid_on.size() && work.laid_on[part.material] != Picture::none;
    });
    if (!pictured) return;
    const float without_m = work.share_of_size(work.torn ? min_proxy_error : squeezed_picture_error);
    const float shift_m = work.torn && work.may_colour() ? without_m : work.pictures.shift_m(level);
    work.squeezed = work.squeezed || shift_m > std::max(without_m, level.error_m);
    if (!work.may_colour() || (!work.torn && !work.squeezed)) {
        level.error_m = std::max(level.error_m, shift_m);
        return;
    }
    to_proxy(work.full, work.thinned, level, work.options.proxy_material);
    level.error_m = std::max(level.error_m, without_m);
}

/// Appends the level. Errors must rise: a finer level that is no better than this one has no use and goes, full detail stays.
void append_level(ChainWork& work, Level&& level) {
    const float before_m = work.levels.back().error_m;
    if (level.error_m <= before_m && work.levels.size() == 1) {
        const float floor_m = static_cast<float>(work.box.diagonal()) * 0.002F;
        level.error_m = std::nextafter(before_m, 1.0F) + floor_m * 1e-3F;
    } else if (level.error_m <= before_m) {
        level.error_m = before_m;
        work.levels.pop_back();
    }
    work.levels.push_back(std::move(level));
}

/// Ends the chain with the twelve triangles of a box if its coarsest level is still large.
void add_box_level(ChainWork& work) {
    if (work.levels.back().triangles <= 48 || work.options.is_piece || work.thinned.mostly) return;
    Level round = box_level(work.full, work.box, work.options.proxy_material);
    round.error_m = std::max({work.reference.bound(work.full, round), work.pictures.shift_m(round),
                              std::nextafter(work.levels.back().error_m, 1e30F)});
    if (work.may_colour()) round.error_m = std::max(round.error_m, work.share_of_size(min_proxy_error));
    work.levels.push_back(std::move(round));
}

/// Gives coarse levels the baked colours in one part; never the full detail.
void colour_coarse_levels(ChainWork& work) {
    if (!work.may_colour()) return;
    for (std::size_t i = 1; i < work.levels.size(); ++i) {
        Level& level = work.levels[i];
        if (level.triangles < work.options.proxy_below && may_lose_pictures(level, work.options, work.box.diagonal()))
            to_proxy(work.full, work.thinned, level, work.options.proxy_material);
    }
}

/// Levels by collapsed edges, each of the one before.
void collapse_levels(ChainWork& work) {
    while (work.levels.back().triangles > work.options.smallest) {
        std::optional<Level> next = next_level(work);
        if (!next) break;
        work.parts = next->parts;
        finish_parts(work, *next);
        bound_level(work, *next);
        append_level(work, std::move(*next));
    }
    add_box_level(work);
    colour_coarse_levels(work);
}

}  // namespace

LodChain make_chain(Geometry full, const ChainOptions& options) {
    std::vector<Level> round = round_levels(full, options);
    LodChain chain;
    if (round.empty()) {
        ChainWork work(full, options);
        collapse_levels(work);
        chain.levels = std::move(work.levels);
    } else {
        chain.levels = {{full.parts, static_cast<std::uint32_t>(full.triangles()), 0}};
        std::move(round.begin(), round.end(), std::back_inserter(chain.levels));
    }
    std::reverse(chain.levels.begin(), chain.levels.end());
    drop_little_gains(chain.levels, options.ratio);
    chain.full = std::move(full);
    return chain;
}

}  // namespace surefoot::bake
