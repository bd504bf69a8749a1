// How far two meshes are apart: an upper bound of the two-sided (Hausdorff) distance, and a sampled lower bound to check it.
// No simplifier's own figure is a bound (meshoptimizer 0.18 under-reports up to 27-fold): this is ours. DESIGN 5.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::measure {

/// Triangles as three corners each, and a tree of boxes over them for nearest-point questions.
class TriangleTree {
public:
    struct Triangle {
        vec3 a, b, c;
    };
    explicit TriangleTree(std::vector<Triangle> triangles);
    struct Nearest {
        float distance = 0;
        std::uint32_t triangle = 0;
    };
    /// At most `start` away, else {start, 0}. The tree may not be empty.
    [[nodiscard]] Nearest nearest(const vec3& p, float start) const;
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
    [[nodiscard]] bool empty() const { return triangles_.empty(); }

private:
    struct Node {
        vec3 min, max;
        std::uint32_t first = 0, count = 0;  ///< leaf: triangles; inner: count 0, children at first and first + 1
    };
    void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, int depth);
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

float point_triangle_distance(const vec3& p, const TriangleTree::Triangle& t);

/// Upper bound of the largest distance from a point of `from` to `to`. Distance to one convex triangle is convex, so over a
/// triangle it is largest at a corner: min over near triangles of the max over corners bounds it; where that is loose the
/// triangle is quartered, until the bound is within `slack` of what a sample proves, or below `floor_m`.
float directed_bound(const TriangleTree& from, const TriangleTree& to, float slack, float floor_m);
float two_sided_bound(const TriangleTree& a, const TriangleTree& b, float slack, float floor_m);

/// Lower bound: the largest distance of n points spread over `from` by area, seeded.
float sampled_distance(const TriangleTree& from, const TriangleTree& to, std::uint32_t n, std::uint64_t seed);

}  // namespace surefoot::measure
