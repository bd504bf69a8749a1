// Conic ranges against sampled points: nothing is inside that should not be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/model/conic_range.hpp"
#include "tests/random_direction.hpp"

namespace surefoot::model {
namespace {

using test::any_direction;

ConicRange any_range(Random& random, const dvec3& centre) {
    ConicRange range;
    range.centre = centre;
    range.min_m = random.below(3) == 0 ? 0 : random.range(0, 4);
    range.max_m = random.below(4) == 0 ? std::numeric_limits<double>::infinity() : range.min_m + random.range(0, 8);
    range.direction = any_direction(random);
    range.alpha_rad = random.below(4) == 0 ? all_directions_rad : random.range(0.05, all_directions_rad);
    return range;
}

/// Two ranges: with one centre, one of them in the other, or anyhow.
std::pair<ConicRange, ConicRange> any_pair(Random& random) {
    const dvec3 centre = any_in(random, dvec3(-3), dvec3(3));
    const bool same = random.below(2) == 0;
    const ConicRange a = any_range(random, centre);
    ConicRange b = any_range(random, same ? centre : centre + any_direction(random) * random.range(0, 6));
    if (random.below(3) == 0) b.direction = glm::normalize(a.direction + 0.3 * any_direction(random));
    if (random.below(6) == 0) {  // a large sphere
        b.min_m = 0;
        b.max_m = 60;
        b.alpha_rad = all_directions_rad;
    }
    return {a, b};
}

ConicRange grown(ConicRange range, double by) {
    range.min_m = std::max(0.0, range.min_m - by);
    range.max_m += by;
    range.alpha_rad += by;
    return range;
}

void expect_intersections_inside(int points) {
    Random random(1);
    int inside = 0, in_both = 0, exact = 0, in_exact = 0;
    for (int tried = 0; tried < points;) {
        const auto pair = any_pair(random);
        const ConicRange &a = pair.first, &b = pair.second;
        dvec3 eye = a.centre + any_direction(random) * random.range(0, 8);
        for (int i = 0; i < 30 && !(contains(a, eye) && contains(b, eye)); ++i)
            eye = a.centre + any_direction(random) * random.range(0, 8);
        const ConicRange both = intersection(a, b, eye);
        const bool same_cone = both.direction == a.direction || both.direction == b.direction;
        const bool is_exact = !both.empty() && same_cone && (both.alpha_rad == a.alpha_rad || both.alpha_rad == b.alpha_rad) &&
                              (both.centre == a.centre || both.centre == b.centre) && both.centre != eye;
        if (is_exact) ++exact;
        if (!both.empty() && !is_exact) {
            EXPECT_TRUE(contains(both, eye));
        }
        for (int i = 0; i < 20; ++i, ++tried) {
            dvec3 point = a.centre + any_direction(random) * random.range(0, 9);
            if (i % 2 == 0 && !both.empty())  // in or just outside of what is claimed
                point = both.centre + any_direction(random) * std::min(both.max_m, 20.0) * random.range(0, 1.05);
            const bool truly = contains(a, point) && contains(b, point);
            in_both += truly ? 1 : 0;
            if (contains(both, point)) {
                ++inside;
                ASSERT_TRUE(contains(grown(a, 1e-12), point) && contains(grown(b, 1e-12), point)) << "wrongly inside";
            } else if (is_exact && truly) {
                ++in_exact;
                ADD_FAILURE() << "an exact intersection leaves a point out";
            }
        }
    }
    EXPECT_GT(inside, points / 20) << "too little is claimed";
    EXPECT_GT(in_both, points / 20);
    EXPECT_GT(exact, points / 400);
    EXPECT_EQ(in_exact, 0);
}

TEST(ConicRanges, IntersectionsHoldNoPointOfAMillionWrongly) { expect_intersections_inside(1'000'000); }

TEST(ConicRanges, ASphereIsInsideOnlyIfAllItsPointsAre) {
    Random random(2);
    int inside = 0, outside = 0;
    for (int i = 0; i < 3000; ++i) {
        const ConicRange range = any_range(random, dvec3(0));
        const dvec3 centre = any_direction(random) * random.range(0, 8);
        const double radius = random.range(0, 3), inner = inner_radius_m(range, centre);
        EXPECT_EQ(contains(range, centre), inner >= 0) << inner;
        const bool holds = contains(range, centre, radius);
        bool truly = true;
        for (int j = 0; j < 200; ++j) truly = truly && contains(grown(range, 1e-12), centre + any_direction(random) * radius);
        EXPECT_TRUE(truly || !holds);
        ++(holds ? inside : outside);
        const bool wide_edges =
            (range.min_m == 0 || range.min_m > 0.5) && (range.alpha_rad < 2.5 || range.alpha_rad == all_directions_rad);
        if (inner > 0.01 && std::isfinite(inner) && wide_edges) {  // and it is the largest one
            bool sticks_out = false;
            for (int j = 0; j < 50'000 && !sticks_out; ++j)
                sticks_out = !contains(range, centre + any_direction(random) * inner * 1.02);
            EXPECT_TRUE(sticks_out);
        }
    }
    EXPECT_GT(inside, 300);
    EXPECT_GT(outside, 300);
}

/// A million spheres, each by a few points of its surface.
TEST(ConicRanges, NoSphereOfAMillionIsInsideWrongly) {
    Random random(4);
    int inside = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const ConicRange range = any_range(random, dvec3(0));
        const dvec3 centre = any_direction(random) * random.range(0, 8);
        const double radius = random.range(0, 3);
        if (!contains(range, centre, radius)) continue;
        ++inside;
        for (int j = 0; j < 16; ++j) ASSERT_TRUE(contains(grown(range, 1e-12), centre + any_direction(random) * radius)) << i;
    }
    EXPECT_GT(inside, 100'000);
}

TEST(ConicRanges, TheEnclosingSphereHoldsAll) {
    Random random(3);
    int tried = 0;
    for (int i = 0; i < 2000; ++i) {
        const ConicRange range = any_range(random, any_in(random, dvec3(-3), dvec3(3)));
        const ConicRange sphere = enclosing_sphere(range);
        if (!std::isfinite(range.max_m)) continue;
        for (int j = 0; j < 50; ++j) {
            const dvec3 point = range.centre + any_direction(random) * random.range(range.min_m, range.max_m);
            if (!contains(range, point)) continue;
            ++tried;
            EXPECT_TRUE(contains(grown(sphere, 1e-9), point));
        }
    }
    EXPECT_GT(tried, 10'000);
}

TEST(ConicRanges, OfFigure10ChooseTheImpostorBetweenItsDistancesAlone) {
    ConicRange impostor;  // ConicRange { distance 10 1000 }
    impostor.min_m = 10;
    impostor.max_m = 1000;
    const ConicRange unlimited;
    const dvec3 direction = glm::normalize(dvec3(1, 0.2, -0.4));
    for (int i = 0; i < 834; ++i) {  // to 2000 m
        const double m = 0.5 * std::pow(1.01, i);
        EXPECT_EQ(contains(impostor, direction * m), m >= 10 && m <= 1000) << m;
        EXPECT_TRUE(contains(unlimited, direction * m));
    }
}

TEST(ConicRanges, TheirEdgesAreWhereTheySay) {
    ConicRange range;
    range.min_m = 2;
    range.max_m = 4;
    range.direction = {1, 0, 0};
    range.alpha_rad = 0.5;
    EXPECT_TRUE(contains(range, {3, 0, 0}) && contains(range, {2, 0, 0}) && contains(range, {4, 0, 0}));
    EXPECT_FALSE(contains(range, {1.99, 0, 0}) || contains(range, {4.01, 0, 0}) || contains(range, {-3, 0, 0}));
    EXPECT_TRUE(contains(range, dvec3(std::cos(0.499), std::sin(0.499), 0) * 3.0));
    EXPECT_FALSE(contains(range, dvec3(std::cos(0.501), std::sin(0.501), 0) * 3.0));
    EXPECT_FALSE(contains(range, dvec3(0))) << "nearer than min_m";
    EXPECT_FALSE(contains(range, {NAN, 0, 0}));
    EXPECT_FALSE(contains(empty_range(), dvec3(0)));
    EXPECT_TRUE(intersection(range, empty_range(), {3, 0, 0}).empty());
    const ConicRange far = sphere_range({100, 0, 0}, 1);
    EXPECT_TRUE(intersection(range, far, {3, 0, 0}).empty()) << "they do not meet";
}

}  // namespace
}  // namespace surefoot::model
