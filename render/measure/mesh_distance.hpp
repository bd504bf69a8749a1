// Distance between triangle meshes: bounds that hold for every point, and a sampled distance to test the bounds.
//
// A simplifier's own error number is no bound, so the bake measures here. The directed distance from A to B is the largest
// distance of a point of A to the surface B. The two-sided distance is the larger of both directions (Hausdorff).
// Method: branch and bound over the triangles of A. The distance to one triangle of B is convex, so its maximum over a triangle
// of A is at a corner. If no single triangle of B is near enough, several may cover the triangle of A (triangle_coverage.hpp). If
// they do not, it is split at its longest edge.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::measure {

/// Positions and triples of indices into them. At least one triangle; positions finite; any unit.
struct MeshView {
    std::span<const vec3> positions;
    std::span<const std::uint32_t> indices;
    [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }
};

/// Nearest-point queries on a mesh: boxes in a binary tree. Keeps its own copy of the corners.
class TriangleTree {
public:
    explicit TriangleTree(const MeshView& mesh);

    /// The nearest point found.
    struct Hit {
        float distance = std::numeric_limits<float>::infinity();
        std::uint32_t triangle = 0xffffffffU;  ///< number in the tree's own order; for distance_to()
    };
    /// Nearest triangle to p. `hint`: a triangle of this tree that is probably near; its distance starts the search.
    [[nodiscard]] Hit nearest(const vec3& p, std::uint32_t hint = 0xffffffffU) const;
    /// Distance from p to a point of the triangle, so never below the true distance, except for rounding.
    [[nodiscard]] float distance_to(std::uint32_t triangle, const vec3& p) const;
    [[nodiscard]] float diagonal() const { return diagonal_; }
    /// Number in the mesh of a triangle of the tree. Its indices start at three times this number.
    [[nodiscard]] std::uint32_t in_mesh(std::uint32_t triangle) const { return in_mesh_[triangle]; }
    /// Calls visit(a, b, c) for each triangle in leaves whose box overlaps [low, high], until visit returns false.
    template <class Visitor>
    void each_in(const vec3& low, const vec3& high, const Visitor& visit) const {
        each_from(0, low, high, visit);
    }

private:
    struct Node {
        vec3 min, max;
        std::uint32_t first = 0;  ///< leaf: first triangle; inner: the second child (the first follows the node)
        std::uint32_t count = 0;  ///< leaf: triangles; inner: 0
    };
    struct Corners {
        vec3 a, b, c;
    };
    template <class Visitor>
    bool each_from(std::uint32_t index, const vec3& low, const vec3& high, const Visitor& visit) const {
        const Node& node = nodes_[index];
        if (glm::any(glm::greaterThan(node.min, high)) || glm::any(glm::lessThan(node.max, low))) return true;
        if (node.count == 0) return each_from(index + 1, low, high, visit) && each_from(node.first, low, high, visit);
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            if (!visit(corners_[i].a, corners_[i].b, corners_[i].c)) return false;
        }
        return true;
    }
    std::uint32_t build(std::span<std::uint32_t> order, const std::vector<Corners>& source, const std::vector<vec3>& centres);
    std::vector<Node> nodes_;
    std::vector<Corners> corners_;
    std::vector<std::uint32_t> in_mesh_;
    float diagonal_ = 0;
};

/// lower <= true distance <= upper. upper holds for every point, rounding included.
struct DistanceBounds {
    float lower = 0;
    float upper = 0;
};

/// The search stops at upper <= max(lower * (1 + relative), absolute), or after max_queries. Bounds hold in both cases.
struct DistanceLimits {
    float relative = 0.1F;
    float absolute = 0;
    float known_lower = 0;        ///< a distance already proven, as by the other direction; smaller ones are not refined
    std::size_t max_queries = 0;  ///< 0: 20 000 and a quarter of the triangles
};

/// Largest distance of a point of `from` to the surface `to`.
/// initial_upper: empty, or a valid bound for each triangle of `from`; then only the worst triangles are searched.
DistanceBounds directed_distance(const MeshView& from, const TriangleTree& to, const DistanceLimits& limits,
                                 std::span<const float> initial_upper = {});

/// The larger of both directions.
DistanceBounds two_sided_distance(const MeshView& a, const MeshView& b, const DistanceLimits& limits);

/// Distances of `count` points, spread evenly over the area of `from`, to the surface `to`. Seeded. `largest` is a lower bound.
struct SampledDistance {
    float largest = 0, median = 0, mean = 0;
};
SampledDistance sampled_distance(const MeshView& from, const TriangleTree& to, std::size_t count, std::uint64_t seed);

}  // namespace surefoot::measure
