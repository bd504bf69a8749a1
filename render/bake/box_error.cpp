// Error of a captured box (box_error.hpp).
#include "render/bake/box_error.hpp"

#include <algorithm>
#include <cmath>

#include "render/bake/mesh_surface.hpp"
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
            while (end < n && rgba[4ULL * (static_cast<std::size_t>(y) * n + end) + 3] != 0) ++end;
            if (end == x) continue;
            to.add(corner + (static_cast<float>(x) * texel) * along + (static_cast<float>(y) * texel) * up,
                   (static_cast<float>(end - x) * texel) * along, texel * up);
            x = end;
        }
    }
}

}  // namespace

float box_error(const BoxForm& form, const Geometry& shown, const vec3& half, float slack) {
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

}  // namespace surefoot::bake
