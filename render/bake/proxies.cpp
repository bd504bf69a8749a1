// A cluster's mesh, valid from everywhere, merged from the actual objects; and how far a box is off them.
#include "render/bake/proxies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/bake/cluster_cards.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/bake/vertex_clusters.hpp"
#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

struct Squares {
    std::vector<vec3> positions;
    std::vector<std::uint32_t> indices;

    void add(const vec3& corner, const vec3& u, const vec3& v) {
        const auto base = static_cast<std::uint32_t>(positions.size());
        for (const vec3& p : {corner, corner + u, corner + u + v, corner + v}) positions.push_back(p);
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) indices.push_back(base + i);
    }
};

/// A rectangle for every run of opaque texels in a row; the whole face where it is painted in one colour.
void add_face(Squares& to, const BoxForm& form, std::size_t face, const vec3& half) {
    if (form.faces[face].covered <= 0) return;
    const int axis = static_cast<int>(face) / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    vec3 corner(0), along(0), up(0);
    corner[axis] = face % 2 == 1 ? half[axis] : -half[axis];
    corner[u] = -half[u];
    corner[v] = -half[v];
    along[u] = 2 * half[u];
    up[v] = 2 * half[v];
    if (!form.textured) {
        to.add(corner, along, up);
        return;
    }
    const std::uint32_t n = form.pixels;
    const float texel = 1.0F / static_cast<float>(n);
    const auto& rgba = form.faces[face].rgba;
    for (std::uint32_t y = 0; y < n; ++y) {
        for (std::uint32_t x = 0; x < n; ++x) {
            std::uint32_t end = x;
            while (end < n && rgba[4ULL * (static_cast<std::size_t>(y) * n + end) + 3] >= opaque_alpha) ++end;
            if (end == x) continue;
            to.add(corner + (static_cast<float>(x) * texel) * along + (static_cast<float>(y) * texel) * up,
                   (static_cast<float>(end - x) * texel) * along, texel * up);
            x = end;
        }
    }
}

/// The geometric error of a box impostor: how far its captured faces lie from the surface. Upper bound: the larger of parallax
/// and distance, plus one texel. Parallax: the deepest captured point behind its face. Distance: two-sided, between opaque texels
/// and surface. `shown` is relative to the box's centre. `slack`: as in ChainOptions.
float box_error(const BoxForm& form, const Geometry& shown, float slack) {
    const vec3 half(glm::max(form.box.half(), dvec3(1e-4)));
    Squares box;
    float depth = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        add_face(box, form, face, half);
        depth = std::max(depth, form.faces[face].depth_m);
    }
    const float diagonal = 2 * glm::length(half);
    if (box.indices.empty()) return diagonal;
    const MeshSurface surface(shown.vertices, shown.parts);
    measure::DistanceLimits limits;
    limits.relative = slack;
    limits.max_queries = 2000;
    limits.known_lower = form.textured ? depth : 0.0F;  // what is below the parallax does not matter
    const measure::DistanceBounds bounds = measure::two_sided_distance(surface.view(), {box.positions, box.indices}, limits);
    const float texel = form.textured ? diagonal / static_cast<float>(form.pixels) : 0.0F;
    return std::max(bounds.upper, limits.known_lower) + texel;
}

/// Appends parts of an object in the world frame relative to `centre`, in baked colours (a proxy's material), or in their own.
void append(Geometry& to, const LodChain& chain, std::span<const GeometryPart* const> parts, const dmat4& world,
            model::Index proxy_material) {
    if (parts.empty()) return;
    const dmat3 linear(world);
    const dmat3 cofactor = cofactors(linear);
    const bool mirrored = glm::dot(linear[0], cofactor[0]) < 0;
    // Sorted, not a table over the chain's vertices: of a large object a few are used, and this runs for every level above it.
    std::vector<std::uint32_t> used;
    for (const GeometryPart* part : parts) used.insert(used.end(), part->indices.begin(), part->indices.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    for (const std::uint32_t index : used) {
        model::Vertex v = chain.full.vertices[index];
        const dvec3 p = dvec3(world * dvec4(chain.full.centre + dvec3(position_of(v)), 1.0)) - to.centre;
        dvec3 n = cofactor * dvec3(v.normal[0], v.normal[1], v.normal[2]) * (mirrored ? -1.0 : 1.0);
        const double length = glm::length(n);
        n = length > 0 ? n / length : dvec3(0, 1, 0);
        for (int k = 0; k < 3; ++k) {
            v.position[k] = static_cast<float>(p[k]);
            v.normal[k] = static_cast<std::int8_t>(std::lround(127.0 * n[k]));
        }
        if (proxy_material != model::none) std::copy_n(chain.full.baked[index].begin(), 4, v.colour);
        to.vertices.push_back(v);
        to.baked.push_back(chain.full.baked[index]);
    }
    for (const GeometryPart* part : parts) {
        const model::Index material = proxy_material != model::none ? proxy_material : part->material;
        auto same = std::find_if(to.parts.begin(), to.parts.end(), [&](const GeometryPart& q) { return q.material == material; });
        if (same == to.parts.end()) {
            to.parts.push_back({material, {}});
            same = to.parts.end() - 1;
        }
        for (std::size_t i = 0; i < part->indices.size(); ++i) {
            const std::size_t corner = mirrored ? i - i % 3 + (3 - i % 3) % 3 : i;
            const auto at = std::lower_bound(used.begin(), used.end(), part->indices[corner]) - used.begin();
            same->indices.push_back(base + static_cast<std::uint32_t>(at));
        }
    }
}

/// Several objects merged into one frame, with the error of their coarse forms.
struct Merged {
    Geometry geometry;
    std::vector<std::uint32_t> owners;  ///< a vertex
    float error_m = 0;
};

/// Cards keep their material, because its alpha test makes their shape.
void append(Merged& to, const LodChain& chain, const Level& level, const dmat4& world, std::uint32_t owner,
            const ProxyInput& input) {
    std::vector<const GeometryPart*> solid, cards;
    for (const GeometryPart& part : level.parts) (input.is_cut_out(part.material) ? cards : solid).push_back(&part);
    append(to.geometry, chain, solid, world, input.proxy_material);
    append(to.geometry, chain, cards, world, model::none);
    to.owners.resize(to.geometry.vertices.size(), owner);
    to.error_m = std::max(to.error_m, static_cast<float>(level.error_m * largest_stretch(dmat3(world))));
}

/// The coarsest level within the error; the full detail where none is.
const Level& level_for(const LodChain& chain, double error_m) {
    for (const Level& level : chain.levels) {
        if (level.error_m <= error_m && level.error_m != model::trimmed_error_m) return level;
    }
    return chain.levels.back();
}

/// Each object as coarse as one common error allows; the error grows until all fit.
Merged merge_objects(const ProxyInput& input, const Box& box, std::span<const std::uint32_t> members) {
    std::vector<double> stretch;
    for (const std::uint32_t m : members) stretch.push_back(std::max(largest_stretch(dmat3(input.objects[m].world)), 1e-30));
    double allowed_m = 0.001 * box.diagonal();
    for (;; allowed_m *= 2) {
        std::uint64_t triangles = 0;
        for (std::size_t i = 0; i < members.size(); ++i) {
            triangles += level_for(input.forms[input.objects[members[i]].mesh].chain, allowed_m / stretch[i]).triangles;
        }
        if (triangles <= input.max_input || allowed_m > box.diagonal()) break;
    }
    Merged merged;
    merged.geometry.centre = box.centre();
    for (std::size_t i = 0; i < members.size(); ++i) {
        const PlacedObject& object = input.objects[members[i]];
        const LodChain& chain = input.forms[object.mesh].chain;
        append(merged, chain, level_for(chain, allowed_m / stretch[i]), object.world, static_cast<std::uint32_t>(i), input);
    }
    return merged;
}

const LodChain& chain_of(const ProxyInput& input, std::uint32_t entity) {
    const auto n = static_cast<std::uint32_t>(input.objects.size());
    return entity < n ? input.forms[input.objects[entity].mesh].chain : input.clusters[entity - n].chain;
}

/// The finest forms of the children instead, where the objects are too many: their errors add up, level by level.
Merged merge_children(const ProxyInput& input, const ClusterTree::Cluster& cluster) {
    Merged merged;
    merged.geometry.centre = cluster.box.centre();
    std::uint32_t owner = 0;
    for (const std::uint32_t e : cluster.children) {
        const dmat4 world = e < input.objects.size() ? input.objects[e].world : dmat4(1.0);
        const LodChain& chain = chain_of(input, e);
        const Level* finest = &chain.levels.front();
        for (const Level& level : chain.levels) {
            if (level.triangles <= input.max_input / cluster.children.size()) finest = &level;
        }
        append(merged, chain, *finest, world, owner++, input);
    }
    return merged;
}

/// Whether the objects of a cluster are too many to be merged one by one.
bool too_many(const ProxyInput& input, std::span<const std::uint32_t> members) { return 16 * members.size() > input.max_input; }

Merged merge(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members) {
    return too_many(input, members) ? merge_children(input, cluster) : merge_objects(input, cluster.box, members);
}

/// Clusters the solid parts by a grid, and thins cards out to their share of the triangles.
LodChain cluster_chain(Merged& merged, const ProxyInput& input, const ClusteringLimits& limits) {
    Geometry& g = merged.geometry;
    const auto all = static_cast<double>(g.triangles());
    const std::vector<GeometryPart> cards =
        take_cards(g, input.cut_out, input.proxy_material, std::max(limits.max_triangles / 8, 2U), input.hidden);
    if (cards.empty()) return cluster_vertices(g, merged.owners, input.two_sided, limits);
    const double share = static_cast<double>(g.triangles()) / all;
    const auto solid_of = [&](std::uint32_t triangles) { return static_cast<std::uint32_t>(share * triangles); };
    ClusteringLimits solid = limits;
    solid.max_triangles = std::max(solid_of(limits.max_triangles), 12U);
    solid.min_triangles = std::max(solid_of(limits.min_triangles), 12U);
    LodChain chain;
    if (g.triangles() > 0) chain = cluster_vertices(g, merged.owners, input.two_sided, solid);
    const std::uint32_t taken = chain.levels.empty() ? 0 : chain.levels.back().triangles;
    CardLimits card;
    card.max_triangles = std::max(limits.max_triangles - std::min(limits.max_triangles, taken), 4U);
    card.min_triangles = std::max(limits.min_triangles - solid_of(limits.min_triangles), 4U);
    card.slack = limits.slack;
    card.hidden = input.hidden;
    chain = with_cards(std::move(chain), g, cards, card);
    g.parts.insert(g.parts.end(), cards.begin(), cards.end());
    // What is solid and every material's cards have a least number of triangles each; together these may be too many.
    while (chain.levels.size() > 1 && chain.levels.back().triangles > limits.max_triangles) chain.levels.pop_back();
    return chain;
}

}  // namespace

ClusterForm make_cluster(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members) {
    std::uint32_t children_coarsest = 0;
    for (const std::uint32_t e : cluster.children) children_coarsest += chain_of(input, e).levels.front().triangles;
    Merged merged = merge(input, cluster, members);
    ClusteringLimits limits;
    limits.max_triangles = std::clamp(children_coarsest * 7 / 10, 12U, 2000U);
    limits.min_triangles = std::clamp(static_cast<std::uint32_t>(4 * members.size()), 32U, 128U);
    limits.slack = input.slack;
    ClusterForm out;
    out.chain = cluster_chain(merged, input, limits);
    float min_m = input.proxy_material == model::none ? 0.0F : static_cast<float>(min_proxy_error * cluster.box.diagonal());
    for (std::size_t i = out.chain.levels.size(); i-- > 0;) {  // fine to coarse: errors keep rising
        Level& level = out.chain.levels[i];
        level.error_m = std::max(level.error_m + merged.error_m, min_m);
        min_m = std::nextafter(level.error_m, std::numeric_limits<float>::infinity());
    }
    return out;
}

float bound_box(const ProxyInput& input, const PlacedObject& object, const BoxForm& box) {
    const auto self = static_cast<std::uint32_t>(&object - input.objects.data());
    const Merged merged = merge_objects(input, object.box, std::span(&self, 1));
    return box_error(box, merged.geometry, input.slack) + merged.error_m;
}

float bound_box(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members,
                const BoxForm& box) {
    const Merged merged = merge(input, cluster, members);
    return box_error(box, merged.geometry, input.slack) + merged.error_m;
}

}  // namespace surefoot::bake
