// Distances to triangles of every thinness: never too small, and hardly too large.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/measure/mesh_distance.hpp"
#include "rt/base/random.hpp"

namespace surefoot {
namespace {

using Wide = long double;
using WideVector = std::array<Wide, 3>;

WideVector wide(const vec3& v) { return {v.x, v.y, v.z}; }
WideVector minus(const WideVector& a, const WideVector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide dot(const WideVector& a, const WideVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// To the three edges; within a thin triangle's width of the distance to all of it.
double to_edges(const vec3& point, const std::array<vec3, 3>& corners) {
    Wide least = 1e30L;
    for (std::size_t i = 0; i < 3; ++i) {
        const WideVector from = wide(corners[i]), way = minus(wide(corners[(i + 1) % 3]), from), to = minus(wide(point), from);
        const Wide length2 = dot(way, way), t = length2 > 0 ? std::clamp(dot(to, way) / length2, 0.0L, 1.0L) : 0.0L;
        const WideVector off{to[0] - t * way[0], to[1] - t * way[1], to[2] - t * way[2]};
        least = std::min(least, dot(off, off));
    }
    return static_cast<double>(std::sqrt(least));
}

TEST(TriangleTree, DistancesToSliversAreThoseToTheirEdges) {
    Random random(11);
    const std::array<std::uint32_t, 3> indices{0, 1, 2};
    double worst = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double width = std::pow(10.0, random.range(-14, -6));
        const dvec3 along = glm::normalize(any_in(random, dvec3(-1), dvec3(1)));
        const dvec3 aside = any_in(random, dvec3(-width), dvec3(width));
        const dvec3 start = any_in(random, dvec3(-1), dvec3(1));
        const double reach = random.range(0, 1.5);
        const std::array<vec3, 3> corners{vec3(start), vec3(start + along), vec3(start + reach * along + aside)};
        const double at = random.range(-0.5, 1.5), off = std::pow(10.0, random.range(-6, 0.5));
        const vec3 point(start + at * along + off * any_in(random, dvec3(-1), dvec3(1)));
        const measure::TriangleTree tree({corners, indices});
        const double distance = tree.nearest(point).distance, expected = to_edges(point, corners);
        worst = std::max(worst, (distance - expected) / std::max(expected, 1e-6));
        // Corners are floats: their own rounding makes it wider than asked.
        ASSERT_GE(distance, expected - width - 1e-6) << i;
    }
    EXPECT_LT(worst, 1e-3) << "an error bound would be so much too large";
}

}  // namespace
}  // namespace surefoot
