// A walker's poses stay in what is predicted of them, on stairs, at walls and at drops.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "input/motion/motion.hpp"
#include "render/model/ground/near.hpp"
#include "rt/base/random.hpp"
#include "tests/ground/grounds.hpp"
#include "tools/walk/region_clip.hpp"

namespace surefoot::test {

namespace {

constexpr std::int64_t ms = 1'000'000;

/// A court of 20 m with stairs of 0.25 m up to a gallery, drops of 0.9 m, pillars, and a slope.
model::Ground court() {
    Triangles t;
    add_floor(t, -10, 10, -10, 10, 0);
    add_wall(t, {-10, -10}, {10, -10}, -1, 5);
    add_wall(t, {10, -10}, {10, 10}, -1, 5);
    add_wall(t, {10, 10}, {-10, 10}, -1, 5);
    add_wall(t, {-10, 10}, {-10, -10}, -1, 5);
    for (int i = 0; i < 8; ++i) add_box(t, {2 + 0.3 * i, 0, -8}, {10, 0.25 * (i + 1), -2});
    add_box(t, {-8, 0, 2}, {-4, 0.9, 8});
    add_quad(t, {-4, 0.9, 2}, {-4, 0.9, 8}, {-2, 0, 8}, {-2, 0, 2});
    for (int i = 0; i < 5; ++i) add_box(t, {1.0 + i, 0, 3}, {1.3 + i, 3, 3.3});
    for (int i = 0; i < 4; ++i) add_box(t, {1 + 1.4 * i, 0, 6}, {1.7 + 1.4 * i, 0.25, 9});  // gutters between them
    add_box(t, {-9, 0, -8}, {-6, 0.6, -3});                                                 // up by stairs, down at once
    for (int i = 0; i < 3; ++i) add_box(t, {-9, 0, -3 + 0.3 * i}, {-6, 0.2 * (3 - i), -2.7 + 0.3 * i});
    return ground_of(t);
}

input::Ground ground_of_walker(model::Walker& walker) {
    const auto query = [](void* context, const dvec3& from, const dvec3& wanted, double dt_s) noexcept {
        return static_cast<model::Walker*>(context)->walk(from, wanted, dt_s);
    };
    const auto halt = [](void* context) noexcept { static_cast<model::Walker*>(context)->halt(); };
    return {query, &walker, 9.81, halt};
}

}  // namespace

TEST(WalkerPrediction, NoWalkLeavesItsUncertainty) {
    const model::Ground ground = court();
    model::Walker walker(ground, {});
    const input::Ground question = ground_of_walker(walker);
    Random random(11);
    const input::MotionLimits limits;
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{0, 1.7, 0}, {1, 0, 0, 0}, 1}));
    struct Open {
        input::Prediction ahead;
        std::int64_t due;
    };
    std::vector<Open> open;
    std::vector<double> used;
    input::Command command;
    std::int64_t now = 0;
    double lowest = 9, highest = -9;
    for (int i = 0; i < 200'000; ++i) {
        if (i % 8000 == 0) {
            const std::array<dvec3, 5> places{{{1, 1.7, -5}, {8, 3.7, -5}, {-6, 2.6, 5}, {0.5, 1.7, 7.5}, {-7.5, 1.7, -1}}};
            ASSERT_TRUE(input::place(state, Pose{places[random.below(5)], {std::cos(0.8), 0, std::sin(0.8), 0}, 1}));
            open.clear();
        }
        if (random.below(600) == 0) {
            command.request = {};
            command.request.forward = random.range(-0.3, 1), command.request.side = random.range(-0.5, 0.5);
            command.request.turn = random.range(-1, 1), command.request.look = random.range(-0.3, 0.3);
            command.request.speed = random.range(-1, 1);
            command.order = random.below(30) == 0 ? input::Order::stop : input::Order::walk;
        }
        const input::NavigationSample sample = input::step(state, limits, command, now += ms, question);
        lowest = std::min(lowest, sample.pose.position.y), highest = std::max(highest, sample.pose.position.y);
        for (auto it = open.begin(); it != open.end();) {
            if (it->due > now) {
                ++it;
                continue;
            }
            const double off = glm::length(sample.pose.position - it->ahead.pose.position);
            ASSERT_LE(off, it->ahead.uncertainty_m + 1e-9) << i;
            if (it->ahead.uncertainty_m > 1e-6) used.push_back(off / it->ahead.uncertainty_m);
            it = open.erase(it);
        }
        const std::int64_t lead = 8LL << random.below(4);
        if (i % 7 == 0) open.push_back({input::predict(sample, limits, static_cast<double>(lead) * 1e-3, 9.81), now + lead * ms});
    }
    std::sort(used.begin(), used.end());
    std::printf("share of the bound used: median %.2f, p99 %.2f, largest %.2f; eye at %.2f to %.2f m\n", used[used.size() / 2],
                used[used.size() * 99 / 100], used.back(), lowest, highest);
    EXPECT_GT(highest, 3.5) << "it was on the gallery";
    EXPECT_LT(lowest, 1.69) << "and fell from it";
}

/// The region of poses is a ball around where walls let the eye come to, no larger than to the nearest wall.
TEST(WalkerPrediction, NoPoseBeyondAWallIsForeseenAndHardlyAPoseIsMissed) {
    const model::Ground ground = court();
    model::Walker walker(ground, {});
    walk::RegionClip clip(ground, {});
    const input::Ground question = ground_of_walker(walker);
    Random random(12);
    const input::MotionLimits limits;
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{0, 1.7, 0}, {1, 0, 0, 0}, 1}));
    struct Open {
        dvec3 centre;
        double radius;
        std::int64_t due;
    };
    std::vector<Open> open;
    input::Command command;
    std::int64_t now = 0;
    int beyond = 0, missed = 0, checked = 0, clipped = 0;
    for (int i = 0; i < 100'000; ++i) {
        if (random.below(500) == 0) {
            command.request = {};
            command.request.forward = random.range(0, 1), command.request.turn = random.range(-1, 1);
            command.request.speed = random.range(-1, 1);
        }
        const input::NavigationSample sample = input::step(state, limits, command, now += ms, question);
        for (auto it = open.begin(); it != open.end();) {
            if (it->due > now) {
                ++it;
                continue;
            }
            ++checked;
            missed += glm::length(sample.pose.position - it->centre) > it->radius ? 1 : 0;
            it = open.erase(it);
        }
        if (i % 50 != 0) continue;
        constexpr double ahead_s = 0.1;
        const input::Prediction ahead = input::predict(sample, limits, ahead_s, 9.81);
        walk::PredictedRegion region;
        region.known = region.on_foot = true;
        region.region = {ahead.pose, ahead.uncertainty_m, ahead.uncertainty_rad};
        region.feet = walker.feet(), region.eye = walker.eye(), region.way = sample.velocity_m_s * ahead_s;
        clip.clip(region);
        const dvec3 eye = region.region.centre.position;
        const double radius = region.region.radius_m;
        clipped += radius < ahead.uncertainty_m ? 1 : 0;
        model::for_triangles_near(ground, {eye - radius, eye + radius}, [&](const model::GroundTriangle& t) {
            const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
            if (std::abs(n.y) > 0.7 * glm::length(n)) return;
            beyond += model::separation({eye, 0, 0}, t).distance < radius - 1e-9 ? 1 : 0;
        });
        open.push_back({eye, radius, now + 100 * ms});
    }
    std::printf("regions: %d, clipped %d; eyes outside of theirs: %d of %d\n", 100'000 / 50, clipped, missed, checked);
    EXPECT_EQ(beyond, 0);
    EXPECT_GT(clipped, 10);
    EXPECT_LT(missed, checked / 50);
}

/// Beside the wall of a shaft. The lift may stop at once or go on, and walls of the floor that it leaves are no bound of that.
TEST(WalkerPrediction, WallsOfTheFloorThatALiftLeavesDoNotClip) {
    Triangles t;
    add_wall(t, {0.4, -5}, {0.4, 5}, -9, 2.5);
    const model::Ground ground = ground_of(t);
    walk::RegionClip clip(ground, {});
    constexpr double unclipped_m = 1.2;
    const auto clipped = [&](double rise_m, double carried_m) {
        walk::PredictedRegion region;
        region.known = region.on_foot = true;
        region.eye = dvec3(0, 1.7, 0), region.way = {0.05, rise_m, 0};
        region.region = {Pose{region.eye + region.way, {1, 0, 0, 0}, 1}, unclipped_m, 0.1};
        region.carried_m = carried_m;
        clip.clip(region);
        return region.region;
    };
    const auto holds = [](const prepare::Region& region, const dvec3& eye) {
        return glm::length(region.centre.position - eye) <= region.radius_m + 1e-9;
    };
    EXPECT_LT(clipped(0, 0).radius_m, 0.41) << "the wall stops who walks";
    for (const double rise_m : {0.5, -0.5}) {
        const prepare::Region rider = clipped(rise_m, 0.6);
        EXPECT_LT(rider.radius_m, unclipped_m) << "the wall is beside him all the same";
        for (const double share : {0.0, 0.5, 1.0, 1.2})
            EXPECT_TRUE(holds(rider, {0.1, 1.7 + share * rise_m, 0.05})) << rise_m << ' ' << share;
    }
}

TEST(WalkerMotion, IsLevelHoweverTheEyeLooks) {
    Triangles t;
    add_floor(t, -20, 20, -20, 20, 0);
    const model::Ground ground = ground_of(t);
    model::Walker walker(ground, {});
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{0, 1.7, 0}, glm::angleAxis(-1.0, dvec3(1, 0, 0)), 1}));
    input::Command command;
    command.request.forward = 1, command.request.up = 1;
    input::NavigationSample sample;
    for (std::int64_t now = 0; now < 3000 * ms; now += ms)
        sample = input::step(state, {}, command, now, ground_of_walker(walker));
    EXPECT_NEAR(sample.pose.position.y, 1.7, 1e-3) << "a walker neither flies up nor digs itself in";
    EXPECT_LT(sample.pose.position.z, -2.5) << "and is not slowed down by looking at its feet";
    EXPECT_NEAR(sample.velocity_m_s.y, 0, 1e-3);
}

TEST(WalkerMotion, AStopHoldsItInTheAir) {
    Triangles t;
    add_floor(t, -20, 20, -20, 20, 0);
    const model::Ground ground = ground_of(t);
    model::Walker walker(ground, {});
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{0, 4.5, 0}, {1, 0, 0, 0}, 1}));
    input::Command command;
    command.request.forward = 0.1;
    std::int64_t now = 0;
    for (int i = 0; i < 300; ++i) input::step(state, {}, command, now += ms, ground_of_walker(walker));
    command.order = input::Order::stop;
    const dvec3 before = input::step(state, {}, command, now += ms, ground_of_walker(walker)).pose.position;
    EXPECT_LT(before.y, 4.4);
    for (int i = 0; i < 300; ++i)
        ASSERT_EQ(input::step(state, {}, command, now += ms, ground_of_walker(walker)).pose.position, before);
}

}  // namespace surefoot::test
