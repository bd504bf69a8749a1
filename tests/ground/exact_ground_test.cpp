// The exact judge's distances, contacts, floors and crossings: of a box, by search, and of many triangles one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rt/base/random.hpp"
#include "tests/ground/exact_scenes.hpp"
#include "tests/ground/exact_shapes.hpp"

namespace surefoot::exact {
namespace {

using importer::Primitive;
using importer::WalkRule;

ExactGround ground_of_all(const Primitive& primitive) {
    SceneMaker make;
    make.add({primitive}, dmat4(1.0), WalkRule::block);
    return {make.scene, blocking_triangles(make.scene)};
}

/// From 0 to 1 on all axes.
ExactGround unit_box() { return ground_of_all(one_box(vec3(0), vec3(1))); }

}  // namespace

TEST(ExactGround, DistancesToABoxAreThoseToItsFacesEdgesAndCorners) {
    const ExactGround box = unit_box();
    EXPECT_EQ(box.triangles(), 12U);
    EXPECT_NEAR(box.distance({1.5, -5, 0.5}, 10, 5), 0.5, 1e-12) << "beside a face";
    EXPECT_NEAR(box.distance({2, 0.5, 2}, 0.2, 5), std::sqrt(2.0), 1e-12) << "beside an edge";
    EXPECT_NEAR(box.distance({2, 2, 2}, 1, 5), std::sqrt(3.0), 1e-12) << "off a corner";
    EXPECT_NEAR(box.distance({0.4, 1.25, 0.6}, 1, 5), 0.25, 1e-12) << "above";
    EXPECT_NEAR(box.distance({0.4, 0.3, 0.5}, 0.3, 5), 0.3, 1e-12) << "inside";
    EXPECT_NEAR(box.distance({0.4, 0.5, 0.6}, 3, 5), 0, 1e-12) << "through the top";
    EXPECT_NEAR(box.distance({3, 0, 0.5}, 1, 2.0), 2.0, 1e-12) << "at the limit";
    EXPECT_TRUE(std::isinf(box.distance({3, 0, 0.5}, 1, 1.9))) << "beyond the limit";
    EXPECT_NEAR(box.penetration({1.1, 0, 0.5}, 1, 0.25), 0.15, 1e-12);
    EXPECT_EQ(box.penetration({1.3, 0, 0.5}, 1, 0.25), 0);
}

TEST(ExactGround, FirstContactsWithABoxAreWhereTheRadiusReachesIt) {
    const ExactGround box = unit_box();
    EXPECT_NEAR(box.first_contact({2, 0.1, 0.5}, 0.5, 0.25, {-1, 0, 0}), 0.75, 1e-10) << "a face";
    EXPECT_NEAR(box.first_contact({0.5, 2, 0.5}, 1, 0.25, {0, -3, 0}), 0.25, 1e-10) << "the top";
    EXPECT_NEAR(box.first_contact({2, 0.5, 1.15}, 0.5, 0.25, {-2, 0, 0}), 0.4, 1e-10) << "an edge, 0.15 m aside: at 0.2 m";
    EXPECT_EQ(box.first_contact({2, 0.1, 0.5}, 0.5, 0.25, {-0.7, 0, 0}), ExactGround::none) << "too short";
}

TEST(ExactGround, OverlapsCountOnlyWhereTheMoveGoesDeeper) {
    const ExactGround box = unit_box();
    const dvec3 touching(0.3, 1.25, 0.5), within(0.3, 1.2, 0.5);
    EXPECT_EQ(box.first_contact(touching, 1, 0.25, {0.3, 0, 0}), ExactGround::none) << "slides";
    EXPECT_EQ(box.first_contact(within, 1, 0.25, {0, 1, 0}), ExactGround::none) << "leaves";
    EXPECT_EQ(box.first_contact(within, 1, 0.25, {0, -0.1, 0}), 0) << "goes deeper";
    // It is over one triangle of the top, and within the radius of the other too: each counts for itself.
    EXPECT_EQ(box.first_contact(within, 1, 0.25, {0.3, 0, 0.1}), 0) << "towards the other triangle";
    EXPECT_EQ(box.first_contact(within, 1, 0.25, {-0.1, 0, 0.1}), ExactGround::none) << "away from it";
}

TEST(ExactGround, FloorsOfABoxAreItsTopAndItsBottom) {
    const ExactGround box = unit_box();
    EXPECT_EQ(box.floors_at(0.3, 0.6, 0.7), (std::vector<double>{0, 1}));
    EXPECT_EQ(box.floors_at(0.5, 0.5, 0.7), (std::vector<double>{0, 0, 1, 1})) << "on a diagonal: of two triangles each";
    EXPECT_EQ(box.floors_at(1.0, 0.25, 0.7), (std::vector<double>{0, 1})) << "on the rim";
    EXPECT_EQ(box.floors_at(1.0001, 0.25, 0.7), std::vector<double>{}) << "beyond the rim";
}

TEST(ExactGround, FloorsAreNoSteeperThanTheLimit) {
    const ExactGround slope = ground_of_all(one_quad(vec3(0), vec3(0, 0, 1), vec3(1, 1, 0)));  // 45 degrees
    EXPECT_EQ(slope.floors_at(0.25, 0.5, 0.70), std::vector<double>{0.25});
    EXPECT_EQ(slope.floors_at(0.25, 0.5, 0.72), std::vector<double>{});
}

TEST(ExactGround, SegmentsThroughABoxCrossTheSideThatTheyMeetFirst) {
    const ExactGround box = unit_box();
    const std::optional<Hit> hit = box.crosses({-1, 0.5, 0.5}, {3, 0.5, 0.6});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->node, 0U);
    EXPECT_EQ(hit->triangle / 2, 2U) << "the side at low x";
    EXPECT_FALSE(box.crosses({-1, 1.5, 0.5}, {3, 1.5, 0.6})) << "above";
    EXPECT_FALSE(box.crosses({0.5, 1, 0.5}, {0.5, 3, 0.5})) << "starts on the top";
    EXPECT_TRUE(box.crosses({0.5, 1, -1}, {0.25, 1, 0.5})) << "in the plane of the top, through the rim of the front";
}

namespace {

/// Of a convex function, by halving in three.
template <class Function>
double smallest_value(const Function& f, double low, double high) {
    for (int i = 0; i < 50; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (f(a) <= f(b) ? high : low) = f(a) <= f(b) ? b : a;
    }
    return std::min({f(low), f(high), f(0.5 * (low + high))});
}

/// Distance by search alone: over the segment and one side of the triangle. The place along another side is a closed form.
double searched_distance(const Corners& t, const dvec3& low, double length) {
    const dvec3 side = t[1] - t[0], other = t[2] - t[0];
    const auto squared_at = [&](double height) {
        const dvec3 from = low + dvec3(0, height, 0) - t[0];
        const auto squared_along = [&](double u) {
            const dvec3 to = from - u * side;
            const dvec3 apart = to - std::clamp(glm::dot(to, other) / glm::dot(other, other), 0.0, 1.0 - u) * other;
            return glm::dot(apart, apart);
        };
        return smallest_value(squared_along, 0, 1);
    };
    return std::sqrt(smallest_value(squared_at, 0, length));
}

}  // namespace

TEST(ExactGround, DistancesAreThoseThatASearchFinds) {
    Random random(7);
    for (int i = 0; i < 500; ++i) {
        Primitive one;
        for (int c = 0; c < 3; ++c) one.positions.emplace_back(any_in(random, dvec3(-1), dvec3(1)));
        if (i % 5 == 1) one.positions[1] = one.positions[0] + vec3(0, 1, 0);  // an upright edge
        for (vec3& corner : one.positions) {
            if (i % 5 == 2) corner.y = 0.25F;   // level
            if (i % 5 == 3) corner.x = 0.125F;  // upright
        }
        one.indices = {0, 1, 2};
        dvec3 low = any_in(random, dvec3(-1), dvec3(1));
        if (i % 10 == 3) low.x = 0.125;  // in the plane of the upright ones
        const double length = i % 7 == 0 ? 0.0 : random.range(0, 0.9);
        const Corners corners{dvec3(one.positions[0]), dvec3(one.positions[1]), dvec3(one.positions[2])};
        EXPECT_NEAR(ground_of_all(one).distance(low, length, 9), searched_distance(corners, low, length), 2e-7) << i;
    }
}

namespace {

/// Strewn triangles of 1 cm to 3 m, and each of them alone.
struct StrewnGround {
    ExactGround whole;
    std::vector<ExactGround> singles;
};

const StrewnGround& strewn_ground() {
    static const StrewnGround made = [] {
        Random random(11);
        Primitive strewn;
        std::vector<ExactGround> singles;
        for (std::uint32_t i = 0; i < 600; ++i) {
            const dvec3 at = any_in(random, dvec3(-8, -2, -8), dvec3(8, 2, 8));
            const double size = std::pow(10.0, random.range(-1.9, 0.5));
            Primitive one;
            for (int c = 0; c < 3; ++c) one.positions.emplace_back(at + size * any_in(random, dvec3(-1), dvec3(1)));
            one.indices = {0, 1, 2};
            singles.push_back(ground_of_all(one));
            strewn.positions.insert(strewn.positions.end(), one.positions.begin(), one.positions.end());
            strewn.indices.insert(strewn.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
        }
        return StrewnGround{ground_of_all(strewn), std::move(singles)};
    }();
    return made;
}

/// A capsule among them, and a move of it.
struct Probe {
    dvec3 low{0.0}, move{0.0};
    double length = 0, radius = 0;
};

Probe any_probe(Random& random) {
    Probe probe;
    probe.low = any_in(random, dvec3(-8, -2, -8), dvec3(8, 2, 8));
    probe.move = any_in(random, dvec3(-0.6), dvec3(0.6));
    probe.length = random.range(0, 1.4);
    probe.radius = random.below(2) == 0 ? 0.25 : 0.02;
    return probe;
}

}  // namespace

TEST(ExactGround, ManyTrianglesAreAsFarAsTheNearestAlone) {
    const StrewnGround& ground = strewn_ground();
    Random random(12);
    for (int i = 0; i < 100; ++i) {
        const Probe probe = any_probe(random);
        double nearest = std::numeric_limits<double>::infinity();
        for (const ExactGround& single : ground.singles) nearest = std::min(nearest, single.distance(probe.low, probe.length, 3));
        EXPECT_EQ(ground.whole.distance(probe.low, probe.length, 3), nearest) << i;
    }
}

TEST(ExactGround, ManyTrianglesHaveTheFloorsOfEachAlone) {
    const StrewnGround& ground = strewn_ground();
    Random random(13);
    std::size_t floors = 0;
    for (int i = 0; i < 400; ++i) {
        const Probe probe = any_probe(random);
        std::vector<double> heights;
        for (const ExactGround& single : ground.singles)
            for (const double height : single.floors_at(probe.low.x, probe.low.z, 0.5)) heights.push_back(height);
        std::sort(heights.begin(), heights.end());
        EXPECT_EQ(ground.whole.floors_at(probe.low.x, probe.low.z, 0.5), heights) << i;
        floors += heights.size();
    }
    EXPECT_GT(floors, 100U);
}

TEST(ExactGround, FirstContactsAreTheFirstOfEachAloneAndLieAtTheRadius) {
    const StrewnGround& ground = strewn_ground();
    Random random(14);
    int starts = 0, contacts = 0;
    for (int i = 0; i < 300; ++i) {
        const auto [low, move, length, radius] = any_probe(random);
        double first = ExactGround::none;
        for (const ExactGround& single : ground.singles) first = std::min(first, single.first_contact(low, length, radius, move));
        EXPECT_NEAR(ground.whole.first_contact(low, length, radius, move), first, 1e-12) << i;
        if (ground.whole.distance(low, length, 3) <= radius) continue;
        ++starts;
        for (int k = 0; k < 50; ++k)
            EXPECT_GT(ground.whole.distance(low + (k / 50.0) * std::min(first, 1.0) * move, length, 3), radius - 2e-12) << i;
        if (first > 1) continue;
        ++contacts;
        EXPECT_NEAR(ground.whole.distance(low + first * move, length, 3), radius, 1e-10) << i;
    }
    EXPECT_GT(starts, 50);
    EXPECT_GT(contacts, 20);
}

TEST(ExactGround, CrossingsAreFoundFromBothEndsAndInTheTriangleAlone) {
    const StrewnGround& ground = strewn_ground();
    Random random(15);
    int crossings = 0, only = 0;
    for (int i = 0; i < 300; ++i) {
        const Probe probe = any_probe(random);
        const dvec3 to = probe.low + 10.0 * probe.move;
        const std::optional<Hit> hit = ground.whole.crosses(probe.low, to), back = ground.whole.crosses(to, probe.low);
        std::vector<Hit> through;
        for (std::uint32_t s = 0; s < ground.singles.size(); ++s)
            if (ground.singles[s].crosses(probe.low, to)) through.push_back({0, s});
        ASSERT_EQ(hit.has_value(), !through.empty()) << i;
        ASSERT_EQ(back.has_value(), !through.empty()) << i;
        if (!hit) continue;
        ++crossings;
        only += through.size() == 1 ? 1 : 0;
        EXPECT_TRUE(std::find(through.begin(), through.end(), *hit) != through.end()) << i;
        EXPECT_TRUE(std::find(through.begin(), through.end(), *back) != through.end()) << i;
        EXPECT_EQ(*hit == *back, through.size() == 1) << i << ": another one from the other end";
    }
    EXPECT_GT(crossings, 30);
    EXPECT_GT(only, 10);
}

TEST(ExactGround, AFloorWithoutGapsIsMetAtItsCornersAndEdges) {
    Random random(5);
    Primitive waves;
    constexpr std::uint32_t side = 20;
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j) waves.positions.emplace_back(0.1 * i, random.range(-0.03, 0.03), 0.1 * j);
    for (std::uint32_t i = 0; i < side; ++i) {
        for (std::uint32_t j = 0; j < side; ++j) {
            const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
            waves.indices.insert(waves.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    }
    const ExactGround ground = ground_of_all(waves);
    for (int i = 0; i < 2000; ++i) {
        const vec3& corner = waves.positions[random.below(static_cast<std::uint32_t>(waves.positions.size()))];
        dvec3 at = glm::clamp(dvec3(corner.x, 0, corner.z), 0.2, 1.8);
        at.y = 0;
        if (i % 2 == 1) at.x += random.range(-0.05, 0.05);  // on an edge
        ASSERT_FALSE(ground.floors_at(at.x, at.z, 0.1).empty()) << i;
        const dvec3 above = at + dvec3(0.01, 0.5, random.range(-0.01, 0.01)), below = at - dvec3(0.01, 0.5, 0.01);
        ASSERT_TRUE(ground.crosses(above, below)) << i;
    }
}

}  // namespace surefoot::exact
