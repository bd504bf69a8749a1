// Motion: stated lag, limits, poses that do not drift in an hour, predictions that hold.
#include "input/motion/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"
#include "tests/time_units.hpp"

namespace surefoot::input {
namespace {

constexpr int virtual_seconds = 3600;

Command walk(double forward, double side = 0, double turn = 0, double look = 0) {
    Command c;
    c.request.forward = forward;
    c.request.side = side;
    c.request.turn = turn;
    c.request.look = look;
    return c;
}

TEST(Filter, LagIsAtMostWhatItStates) {
    const FilterSettings settings;
    const double stated = worst_lag_s(settings);
    std::printf("filter lag: at most %.1f ms (cutoff %.1f Hz)\n", stated * 1e3, settings.min_cutoff_hz);
    for (const double dt : {0.0005, 0.001, 0.004, 1.0 / 60, 1.0 / 30})
        for (const double slope : {0.02, 0.2, 1.0, 5.0}) {
            OneEuro<dvec2> filter;
            double lag = 0;
            for (double t = dt; t < 1; t += dt) {
                const double out = filter.step(settings, dvec2(slope * t, 0), dt).x;
                lag = t - out / slope;
                ASSERT_LE(lag, stated + 1e-12) << "a ramp of " << slope << " at " << dt;
            }
            if (dt == 0.001) std::printf("  ramp of %.2f full deflections/s: %.1f ms\n", slope, lag * 1e3);
        }
    OneEuro<dvec2> filter;
    double t = 0;
    while (filter.step(settings, dvec2(1, 0), 0.001).x < 1 - std::exp(-1.0)) t += 0.001;
    EXPECT_LE(t, stated) << "of a step";
    std::printf("  full step to 63 %%: %.1f ms\n", t * 1e3);
    while (filter.step(settings, dvec2(0), 0.001).x != 0) t += 0.001;
    EXPECT_LT(t, 0.5) << "rest is reached, exactly";
}

TEST(Motion, SpeedAndAccelerationStayWithinTheirLimits) {
    Random random(1);
    const MotionLimits limits;
    MotionState state;
    NavigationSample before = step(state, limits, {}, 0);
    std::int64_t now = 0;
    Command command;
    double fastest = 0;
    for (int i = 0; i < 300'000; ++i) {
        const std::int64_t passed = random.below(20) == 0 ? random.below(80) * ms : ms;
        if (random.below(50) == 0) {
            command = walk(random.range(-3, 3), random.range(-3, 3), random.range(-3, 3), random.range(-3, 3));
            command.request.up = random.range(-3, 3);
            command.request.speed = random.range(-2, 2);
        }
        const dvec3 was = state.velocity;
        const auto after = step(state, limits, command, now += passed);
        const double dt = std::min(static_cast<double>(passed) * 1e-9, longest_step_s), speed = glm::length(after.velocity_m_s);
        fastest = std::max(fastest, speed);
        ASSERT_LE(speed, limits.max_m_s + 1e-9);
        ASSERT_LE(glm::length(state.velocity - was), limits.accel_m_s2 * dt + 1e-9);
        ASSERT_LE(glm::length(after.angular_rad_s), std::max(limits.turn_rad_s, limits.look_rad_s) + 1e-9);
        ASSERT_LE(glm::length(after.pose.position - before.pose.position), limits.max_m_s * dt + 1e-9) << "no leap";
        ASSERT_LE(std::abs(state.pitch.value), limits.max_pitch_rad + 1e-12);
        before = after;
    }
    EXPECT_GT(fastest, 0.8 * limits.walk_m_s * limits.fastest);
}

TEST(Motion, WalksWhereItLooks) {
    MotionState state;
    MotionLimits limits;
    step(state, limits, {}, 0);
    std::int64_t now = 0;
    for (int i = 0; i < 2000; ++i) step(state, limits, walk(1), now += ms);
    EXPECT_NEAR(state.velocity.z, -limits.walk_m_s, 1e-9);
    EXPECT_LT(state.position.z, -2);
    EXPECT_NEAR(state.position.x, 0, 1e-12);
    Pose left;
    left.orientation = glm::angleAxis(1.5707963267948966, dvec3(0, 1, 0));
    ASSERT_TRUE(place(state, left));
    for (int i = 0; i < 2000; ++i) step(state, limits, walk(1), now += ms);
    EXPECT_LT(state.position.x, -2) << "turned to the left, -X is ahead";
    for (int i = 0; i < 1000; ++i) step(state, limits, walk(0, 0, 1, 1), now += ms);
    const Pose pose = pose_of(state);
    EXPECT_GT(pose.forward().y, 0.3) << "look > 0 is up";
    EXPECT_GT(pose.forward().z, 0.3) << "turn > 0 is to the left";
    EXPECT_NEAR(pose.right().y, 0, 1e-12) << "level horizon";
    limits.level = true;
    const double height = state.position.y;
    for (int i = 0; i < 1000; ++i) step(state, limits, walk(1), now += ms);
    EXPECT_EQ(state.position.y, height) << "level walk keeps its height";
}

TEST(Motion, PlacedPosesComeBackAndBadOnesAreRefused) {
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        Pose pose;
        pose.position = {random.range(-1e4, 1e4), random.range(-10, 10), random.range(-1e4, 1e4)};
        pose.orientation =
            glm::normalize(dquat(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)));
        MotionState state;
        ASSERT_TRUE(place(state, pose));
        const Pose back = pose_of(state);
        ASSERT_EQ(back.position, pose.position);
        ASSERT_LT(glm::length(back.forward() - pose.forward()) + glm::length(back.up() - pose.up()), 1e-12) << i;
    }
    for (const double half : {0.7853981633974483, -0.7853981633974483}) {  // straight up and down
        Pose pose;
        pose.orientation = dquat(std::cos(half), std::sin(half), 0, 0);
        MotionState state;
        ASSERT_TRUE(place(state, pose));
        EXPECT_LT(glm::length(pose_of(state).right() - pose.right()), 1e-7);
    }
    MotionState state;
    Pose bad;
    bad.position.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(place(state, bad));
    bad = {};
    bad.orientation = dquat(0, 0, 0, 0);
    EXPECT_FALSE(place(state, bad));
    EXPECT_EQ(pose_of(state).position, dvec3(0.0));
}

TEST(Motion, OrientationDoesNotDriftInAnHourAtAThousandHertz) {
    Random random(4);
    MotionState state;
    const MotionLimits limits;
    step(state, limits, {}, 0);
    Command command;
    long double yaw = 0, pitch = 0;  // the same sum in 64-bit mantissas
    double norm = 0, horizon = 0;
    std::int64_t now = 0;
    for (int i = 0; i < virtual_seconds * 1000; ++i) {
        if (i % 700 == 0) command = walk(0, 0, random.range(-1, 1), state.pitch.value > 0 ? -random.unit() : random.unit());
        const dvec2 was = state.rates;
        const auto sample = step(state, limits, command, now += ms);
        const dvec2 mean = 0.5 * (was + state.rates);
        yaw += static_cast<long double>(mean.x * 1e-3);
        pitch += static_cast<long double>(mean.y * 1e-3);
        norm = std::max(norm, std::abs(glm::length(sample.pose.orientation) - 1));
        horizon = std::max(horizon, std::abs(sample.pose.right().y));
    }
    const long double two_pi = 6.283185307179586476925286766559L;
    const long double away = std::remainder(yaw - static_cast<long double>(state.yaw.value), two_pi);
    const double yaw_drift = static_cast<double>(std::abs(away));
    const double pitch_drift = static_cast<double>(std::abs(pitch - static_cast<long double>(state.pitch.value)));
    std::printf("orientation after %d s at 1 kHz: norm %.1e, horizon %.1e, yaw %.1e rad, pitch %.1e rad\n", virtual_seconds, norm,
                horizon, yaw_drift, pitch_drift);
    EXPECT_LT(norm, 1e-12);
    EXPECT_LT(horizon, 1e-12);
    EXPECT_LT(yaw_drift, 1e-12);
    EXPECT_LT(pitch_drift, 1e-12);
}

TEST(Motion, TheSameWalkAtAnyRateEndsAtTheSamePlace) {
    std::vector<dvec3> ends;
    for (const std::int64_t tick : {1 * ms, 2 * ms, 4 * ms, 8 * ms}) {
        MotionState state;
        step(state, {}, {}, 0);
        for (std::int64_t now = tick; now <= 4000 * ms; now += tick)
            step(state, {}, now <= 2000 * ms ? walk(1, 0, 0.5) : walk(0), now);
        ends.push_back(state.position);
    }
    for (const dvec3& end : ends) EXPECT_LT(glm::length(end - ends[0]), 0.02);
}

TEST(Motion, StopIsThisStepAndBrakeWithinItsTime) {
    MotionLimits limits;
    MotionState state;
    step(state, limits, {}, 0);
    std::int64_t now = 0;
    Command fast = walk(1, 0, 1);
    fast.request.speed = 1;
    for (int i = 0; i < 3000; ++i) step(state, limits, fast, now += ms);
    EXPECT_GT(glm::length(state.velocity), 5);
    MotionState other = state;
    const Pose held = pose_of(state);
    Command stop;
    stop.order = Order::stop;
    const auto stopped = step(state, limits, stop, now + ms);
    EXPECT_EQ(stopped.velocity_m_s, dvec3(0.0));
    EXPECT_EQ(stopped.angular_rad_s, dvec3(0.0));
    EXPECT_EQ(stopped.pose.position, held.position);
    EXPECT_TRUE(stopped.stopped);
    Command brake;
    brake.order = Order::brake;
    for (int i = 0; i < 31; ++i) step(other, limits, brake, now += ms);
    EXPECT_EQ(other.velocity, dvec3(0.0));
    EXPECT_EQ(other.rates, dvec2(0.0));
}

TEST(Motion, StallsAndClocksThatGoBackMakeNoLeap) {
    MotionState state;
    const MotionLimits limits;
    step(state, limits, walk(1), 0);
    for (int i = 1; i <= 1000; ++i) step(state, limits, walk(1), i * ms);
    dvec3 before = state.position;
    step(state, limits, walk(1), 60'000 * ms);
    EXPECT_LE(glm::length(state.position - before), limits.walk_m_s * longest_step_s + 1e-9);
    before = state.position;
    step(state, limits, walk(1), 5 * ms);
    EXPECT_EQ(state.position, before);
    EXPECT_EQ(state.clock_back, 1U);
    Command bad = walk(std::numeric_limits<double>::quiet_NaN());
    bad.request.turn = std::numeric_limits<double>::infinity();
    step(state, limits, bad, 60'010 * ms);
    EXPECT_TRUE(std::isfinite(state.position.z) && std::isfinite(state.yaw.value));
    EXPECT_EQ(state.refused, 1U);
}

struct Wall {
    double z;
    bool mad = false;
};
dvec3 stop_at_wall(void* context, const dvec3& from, const dvec3& wanted, double /*dt_s*/) noexcept {
    const auto& wall = *static_cast<const Wall*>(context);
    if (wall.mad) return {std::numeric_limits<double>::quiet_NaN(), 1e300, 0};
    (void)from;
    return {wanted.x, wanted.y, std::max(wanted.z, wall.z)};
}

TEST(Motion, TheGroundMayOnlyHoldBack) {
    Wall wall{-1};
    const Ground ground{stop_at_wall, &wall, 0, nullptr};
    MotionState state;
    step(state, {}, {}, 0, ground);
    std::int64_t now = 0;
    NavigationSample sample;
    for (int i = 0; i < 3000; ++i) sample = step(state, {}, walk(0.7, 0.7), now += ms, ground);
    EXPECT_GE(state.position.z, -1.0);
    EXPECT_GT(state.position.x, 1) << "slides along";
    EXPECT_NEAR(sample.velocity_m_s.z, 0, 0.02) << "the wall takes the speed that it stops";
    wall.mad = true;
    const dvec3 before = state.position;
    for (int i = 0; i < 100; ++i) step(state, {}, walk(1), now += ms, ground);
    EXPECT_EQ(state.position, before);
    EXPECT_GT(state.refused, 0U);
}

TEST(Prediction, NoWalkLeavesItsUncertainty) {
    Random random(9);
    const MotionLimits limits;
    MotionState state;
    step(state, limits, {}, 0);
    std::int64_t now = 0;
    Wall wall{-3};
    struct Open {
        NavigationSample sample;
        Prediction ahead;
        std::int64_t due;
    };
    std::vector<Open> open;
    Command command;
    int checked = 0;
    std::vector<double> used;
    for (int i = 0; i < 400'000; ++i) {
        if (random.below(60) == 0) {
            command = walk(random.range(-2, 2), random.range(-2, 2), random.range(-2, 2), random.range(-2, 2));
            command.request.speed = random.range(-1, 1);
            command.order = random.below(20) == 0 ? Order::stop : Order::walk;
        }
        const Ground ground = (i / 50'000) % 2 == 0 ? Ground{} : Ground{stop_at_wall, &wall, 0, nullptr};
        if (i % 50'000 == 0) wall.z = state.position.z - 3;
        const auto sample = step(state, limits, command, now += ms, ground);
        for (auto it = open.begin(); it != open.end();) {
            if (it->due > now) {
                ++it;
                continue;
            }
            const double off = glm::length(sample.pose.position - it->ahead.pose.position);
            const double turned = 2 * glm::length(dvec3((glm::inverse(sample.pose.orientation) * it->ahead.pose.orientation).x,
                                                        (glm::inverse(sample.pose.orientation) * it->ahead.pose.orientation).y,
                                                        (glm::inverse(sample.pose.orientation) * it->ahead.pose.orientation).z));
            ASSERT_LE(off, it->ahead.uncertainty_m + 1e-9) << i;
            ASSERT_LE(turned, it->ahead.uncertainty_rad + 1e-9) << i;
            if (it->ahead.uncertainty_m > 1e-6) used.push_back(off / it->ahead.uncertainty_m);
            ++checked;
            it = open.erase(it);
        }
        if (i % 7 == 0) {
            const int lead_ms = 8 << random.below(4);
            open.push_back({sample, predict(sample, limits, lead_ms * 1e-3), now + lead_ms * ms});
        }
    }
    std::sort(used.begin(), used.end());
    std::printf("predictions checked: %d; share of the bound used: median %.2f, p99 %.2f, largest %.2f\n", checked,
                used[used.size() / 2], used[used.size() * 99 / 100], used.back());
    EXPECT_GT(checked, 50'000);
    EXPECT_GT(used.back(), 0.5) << "a bound that nothing comes near is no use";
}

}  // namespace
}  // namespace surefoot::input
