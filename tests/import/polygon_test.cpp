// Triangulation: area and orientation are kept for convex, concave, collinear, vertical and awkward polygons.
#include <gtest/gtest.h>

#include <cmath>

#include "render/import/polygon.hpp"
#include "rt/base/random.hpp"

namespace surefoot::importer {
namespace {

dvec3 area_of(std::span<const dvec3> p, std::span<const std::uint32_t> t) {
    dvec3 sum(0);
    for (std::size_t i = 0; i < t.size(); i += 3) sum += 0.5 * glm::cross(p[t[i + 1]] - p[t[i]], p[t[i + 2]] - p[t[i]]);
    return sum;
}

double total_area(std::span<const dvec3> p, std::span<const std::uint32_t> t) {
    double sum = 0;
    for (std::size_t i = 0; i < t.size(); i += 3)
        sum += 0.5 * glm::length(glm::cross(p[t[i + 1]] - p[t[i]], p[t[i + 2]] - p[t[i]]));
    return sum;
}

dvec3 outline_area(std::span<const dvec3> p) {
    dvec3 sum(0);
    for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += 0.5 * glm::cross(p[i] - p[0], p[i + 1] - p[0]);
    return sum;
}

TEST(Orientation, IsExactWhereRoundingGivesZero) {
    const double e = std::ldexp(1.0, -52);
    EXPECT_EQ(orientation({0.5, 0.5}, {12, 12}, {24, 24}), 0);
    EXPECT_EQ(orientation({0.5 + e, 0.5}, {12, 12}, {24, 24}), -orientation({0.5, 0.5 + e}, {12, 12}, {24, 24}));
    EXPECT_NE(orientation({0.5, 0.5 + e}, {12, 12}, {24, 24}), 0);
    EXPECT_EQ(orientation({0, 0}, {1, 0}, {0, 1}), 1);
}

TEST(Polygon, RandomStarsKeepTheirAreaInEveryPlane) {
    Random random(7);
    for (int round = 0; round < 300; ++round) {
        const int n = 4 + static_cast<int>(random.below(40));
        const int plane = static_cast<int>(random.below(3));
        std::vector<dvec3> p;
        for (int i = 0; i < n; ++i) {
            const double a = 2 * 3.14159265358979 * i / n, r = random.range(0.05, 1.0);
            const double x = 100 + r * std::cos(a), y = r * std::sin(a);
            p.push_back(plane == 0 ? dvec3(x, y, 5) : plane == 1 ? dvec3(5, x, y) : dvec3(y, 5, x));
        }
        std::vector<std::uint32_t> t;
        ASSERT_TRUE(triangulate(p, t));
        ASSERT_EQ(t.size(), static_cast<std::size_t>(n - 2) * 3);
        EXPECT_NEAR(glm::length(area_of(p, t) - outline_area(p)), 0, 1e-10);
        EXPECT_NEAR(total_area(p, t), glm::length(outline_area(p)), 1e-10);
    }
}

TEST(Polygon, CollinearCornersAreCutLast) {
    const std::vector<dvec3> p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}, {0, 2, 0}};
    std::vector<std::uint32_t> t;
    EXPECT_TRUE(triangulate(p, t));
    EXPECT_NEAR(total_area(p, t), 3.0, 1e-12);
}

TEST(Polygon, PentagramIsNotConvexAndIsReported) {
    std::vector<dvec3> p;
    for (int i = 0; i < 5; ++i) p.emplace_back(std::cos(i * 2 * 2.51327412287), std::sin(i * 2 * 2.51327412287), 0);
    std::vector<std::uint32_t> t;
    (void)triangulate(p, t);
    EXPECT_EQ(t.size(), 9U);
}

TEST(Polygon, HugeOnesEnd) {
    std::vector<dvec3> p;
    for (int i = 0; i < 20000; ++i) p.emplace_back(i, i % 2, 0);
    std::vector<std::uint32_t> t;
    EXPECT_FALSE(triangulate(p, t));
    EXPECT_EQ(t.size(), 3U * 19998U);
}

}  // namespace
}  // namespace surefoot::importer
