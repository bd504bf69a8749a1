// Visitors at random among things that move, judged by code that shares nothing with the walker's; and what is predicted of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "input/motion/motion.hpp"
#include "rt/base/random.hpp"
#include "tests/ground/moving_scenes.hpp"

namespace surefoot::test {

namespace {

/// Lifts, sliding platforms, walls and doors, beams and tables that turn, flaps that swing, and some still boxes.
MovingScene fairground(std::uint64_t seed) {
    Random random(seed);
    MovingScene scene;
    add_floor(scene.still, -12, 12, -12, 12, 0);
    add_wall(scene.still, {-12, -12}, {12, -12}, -1, 6);
    add_wall(scene.still, {12, -12}, {12, 12}, -1, 6);
    add_wall(scene.still, {12, 12}, {-12, 12}, -1, 6);
    add_wall(scene.still, {-12, 12}, {-12, -12}, -1, 6);
    for (int i = 0; i < 10; ++i) {
        const dvec3 at = any_in(random, dvec3(-11, 0, -11), dvec3(10, 0, 10));
        add_box(scene.still, at, at + any_in(random, dvec3(0.1, 0.1, 0.1), dvec3(2, 2.5, 2)));
    }
    for (int i = 0; i < 14; ++i) {
        const dvec3 at = any_in(random, dvec3(-9, 0, -9), dvec3(9, 0, 9));
        const double speed = random.range(0.2, 2.5), turn_s = random.range(3, 15);
        MovingThing thing;
        switch (i % 5) {
            case 0: {
                const double up = random.range(0.5, 3);
                thing = platform(at + dvec3(-1, -0.2, -1), at + dvec3(1, 0.03, 1), {0, up, 0}, up / speed);
                break;
            }
            case 1: {
                const dvec3 way = any_in(random, dvec3(-4, 0, -4), dvec3(4, 0, 4));
                const double high = random.below(2) == 0 ? 0.15 : 2.2;  // a platform, or a block
                thing = platform(at + dvec3(-1, 0, -1), at + dvec3(1, high, 1), way, glm::length(way) / speed);
                break;
            }
            case 2: {
                const dvec3 way = any_in(random, dvec3(-4, 0, 0), dvec3(4, 0, 0));
                thing = platform(at + dvec3(-0.03, 0, -1.5), at + dvec3(0.03, 2.4, 1.5), way, std::abs(way.x) / speed);
                break;
            }
            case 3: {
                const double high = random.below(2) == 0 ? 0.2 : 1.4;  // a table to ride on, or a beam
                add_box(thing.at_rest, at + dvec3(-1.8, 0, -0.6), at + dvec3(1.8, high, 0.6));
                thing.pivot = at;
                for (int k = 0; k <= 4; ++k) thing.stands.push_back({turn_s * k / 4, dvec3(0.0), k * std::numbers::pi / 2});
                break;
            }
            default:
                add_box(thing.at_rest, at + dvec3(0, 0, -1), at + dvec3(0.05, 2, 1));
                thing.pivot = at, thing.axis = {0, 0, 1};
                thing.stands = {{0, dvec3(0.0), 0}, {turn_s / 2, dvec3(0.0), -1.2}, {turn_s, dvec3(0.0), 0}};
                break;
        }
        scene.things.push_back(thing);
    }
    return scene;
}

/// What became of a visitor.
struct Judged {
    double worst_still_m = 0, worst_moving_m = 0, walked_m = 0;
    std::size_t crossings = 0, passing_steps = 0, steps = 0, moving_judged = 0, carried_steps = 0;
    std::uint64_t put_aside = 0, passed_through = 0, returns = 0;
    dvec3 end{0.0};
};

Judged visit_fairground(std::uint64_t seed, std::size_t steps) {
    const MovingScene scene = fairground(seed);
    const exact::ExactGround still = scene.still_judge();
    Rider rider(scene, {0.1, 1.7, 0.2});
    Random random(seed + 1000);
    Judged out;
    double heading = random.range(0, 6.28), turn = 0, speed = 1.4;
    for (; out.steps < steps; ++out.steps) {
        const double dt_s = out.steps / 1000 % 2 == 0 ? 0.002 : 0.02;
        if (out.steps % 150 == 0) turn = random.range(-1.2, 1.2), speed = random.below(3) == 0 ? 0 : random.range(0.3, 3);
        heading += turn * dt_s;
        const dvec3 before = rider.eye, feet_before = rider.walker.feet();
        const bool stood = rider.walker.stands();
        const std::uint64_t far_jumps = rider.walker.returns() + rider.walker.freed();
        rider.step(speed * dvec3(std::cos(heading), 0, std::sin(heading)), dt_s);
        const bool jumped = rider.walker.returns() + rider.walker.freed() != far_jumps;
        if (!rider.walker.stands() || !stood || jumped) continue;
        out.walked_m += std::hypot(rider.eye.x - before.x, rider.eye.z - before.z);
        out.carried_steps += rider.walker.ride().way != dvec3(0.0) ? 1 : 0;
        const model::Capsule body = rider.walker.capsule_at(rider.walker.feet());
        // Who is put aside gets there past still walls too: the middle of the body does.
        const dvec3 up(0, 0.9, 0);
        out.crossings += still.crosses(before, rider.eye) ? 1 : 0;
        out.crossings += still.crosses(feet_before + up, rider.walker.feet() + up) ? 1 : 0;
        out.worst_still_m = std::max(out.worst_still_m, still.penetration(body.low, body.length, body.radius));
        out.passing_steps += rider.walker.passing() > 0 ? 1 : 0;
        if (out.steps % 5 != 0 || rider.walker.passing() > 0) continue;
        ++out.moving_judged;
        const exact::ExactGround moving = scene.moving_judge(rider.time_s);
        out.worst_moving_m = std::max(out.worst_moving_m, moving.penetration(body.low, body.length, body.radius));
    }
    out.put_aside = rider.walker.put_aside(), out.passed_through = rider.walker.passed_through();
    out.returns = rider.walker.returns();
    out.end = rider.eye;
    return out;
}

input::Ground ground_of_rider(model::Walker& walker) {
    const auto query = [](void* context, const dvec3& from, const dvec3& wanted, double dt_s) noexcept {
        return static_cast<model::Walker*>(context)->walk(from, wanted, dt_s);
    };
    const auto halt = [](void* context) noexcept { static_cast<model::Walker*>(context)->halt(); };
    const auto carried = [](void* context) noexcept {
        const model::Walker::Ride& ride = static_cast<model::Walker*>(context)->ride();
        return input::Carried{ride.way, ride.turn_rad, ride.max_m_s, ride.max_turn_rad_s};
    };
    return {query, &walker, 9.81, halt, carried};
}

void expect_well(const Judged& one, std::uint64_t seed) {
    std::printf(
        "seed %llu: %.0f m, carried in %zu steps; overlap %.5f m with what is still, %.5f m with what moves; put aside "
        "%llu times, passed through %llu times, in %zu steps; %llu returns\n",
        static_cast<unsigned long long>(seed), one.walked_m, one.carried_steps, one.worst_still_m, one.worst_moving_m,
        static_cast<unsigned long long>(one.put_aside), static_cast<unsigned long long>(one.passed_through), one.passing_steps,
        static_cast<unsigned long long>(one.returns));
    EXPECT_LE(one.worst_still_m, 0.01) << seed;
    EXPECT_LE(one.worst_moving_m, 0.0101) << seed << ": with the rounding of the keys' rotations";
    EXPECT_EQ(one.crossings, 0U) << seed;
    EXPECT_LT(one.passing_steps, one.steps / 5) << seed;
    EXPECT_GT(one.moving_judged, one.steps / 10) << seed;
}

}  // namespace

TEST(MovingVisitors, AreInNoWallAndNoThingAndGoOn) {
    double walked_m = 0;
    std::size_t carried_steps = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Judged one = visit_fairground(seed, 10'000);
        expect_well(one, seed);
        walked_m += one.walked_m, carried_steps += one.carried_steps;
    }
    EXPECT_GT(walked_m, 60);
    EXPECT_GT(carried_steps, 1000U);
}

TEST(MovingVisitors, WhoRepeatWhatTheyDidEndAtTheSameBits) {
    const Judged once = visit_fairground(2, 3000), twice = visit_fairground(2, 3000);
    EXPECT_EQ(once.end, twice.end);
    EXPECT_EQ(once.put_aside, twice.put_aside);
}

TEST(Nightly, MovingVisitorsOfFortyScenes) {
    for (std::uint64_t seed = 100; seed < 140; ++seed) expect_well(visit_fairground(seed, 30'000), seed);
}

/// Being carried is predicted: no walk leaves its uncertainty, nor turns further, unless it was put elsewhere.
TEST(MovingVisitors, NoRideLeavesItsUncertainty) {
    struct Open {
        input::Prediction ahead;
        std::int64_t due = 0;
    };
    constexpr std::int64_t millisecond_ns = 1'000'000;
    std::vector<double> used;
    std::size_t carried_samples = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const model::Model model = fairground(seed).model();
        model::Walker walker(model, {});
        const input::Ground question = ground_of_rider(walker);
        Random random(seed + 50);
        const input::MotionLimits limits;
        input::MotionState state;
        ASSERT_TRUE(input::place(state, Pose{{0.1, 1.7, 0.2}, {1, 0, 0, 0}, 1}));
        std::vector<Open> open;
        input::Command command;
        std::uint64_t jumps = 0;
        std::int64_t now = 0;
        for (int i = 0; i < 60'000; ++i) {
            if (random.below(600) == 0) {
                command.request = {};
                if (random.below(3) != 0) {
                    command.request.forward = random.range(-0.3, 1), command.request.turn = random.range(-1, 1);
                    command.request.speed = random.range(-1, 1);
                }
            }
            walker.set_time(static_cast<double>(now += 2 * millisecond_ns) * 1e-9);
            const input::NavigationSample sample = input::step(state, limits, command, now, question);
            if (walker.returns() + walker.freed() + walker.put_aside() != jumps) {
                jumps = walker.returns() + walker.freed() + walker.put_aside();
                open.clear();
                ASSERT_TRUE(input::place(state, sample.pose, true));
                continue;
            }
            carried_samples += sample.carried_m_s != dvec3(0.0) ? 1 : 0;
            ASSERT_LE(glm::length(sample.carried_m_s), sample.max_carried_m_s * (1 + 1e-6)) << i;
            for (auto it = open.begin(); it != open.end();) {
                if (it->due > now) {
                    ++it;
                    continue;
                }
                const double off_m = glm::length(sample.pose.position - it->ahead.pose.position);
                ASSERT_LE(off_m, it->ahead.uncertainty_m + 1e-9) << seed << ' ' << i;
                const double w = std::abs(glm::dot(sample.pose.orientation, it->ahead.pose.orientation));
                ASSERT_LE(2 * std::acos(std::min(1.0, w)), it->ahead.uncertainty_rad + 1e-7) << seed << ' ' << i;
                used.push_back(off_m / it->ahead.uncertainty_m);
                it = open.erase(it);
            }
            const std::int64_t lead = 8LL << random.below(4);
            if (i % 7 == 0 && walker.stands())
                open.push_back(
                    {input::predict(sample, limits, static_cast<double>(lead) * 1e-3, 9.81), now + lead * millisecond_ns});
        }
    }
    std::sort(used.begin(), used.end());
    std::printf("carried in %zu samples; share of the bound used: median %.2f, p99 %.2f, largest %.2f\n", carried_samples,
                used[used.size() / 2], used[used.size() * 99 / 100], used.back());
    EXPECT_GT(carried_samples, 2000U);
}

}  // namespace surefoot::test
