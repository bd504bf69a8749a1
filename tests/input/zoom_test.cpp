// Zoom: how fast and how far, what it does to turning, what ends it, and whether its prediction holds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "input/motion/motion.hpp"
#include "rt/base/random.hpp"
#include "tests/time_units.hpp"

namespace surefoot::input {
namespace {

/// An eye that is at rest at time 0, and its steps of a millisecond.
struct Zooming {
    MotionLimits limits;
    MotionState state;
    std::int64_t now = 0;
    NavigationSample sample = step(state, limits, {}, 0);

    void hold(double zoom, double seconds, double turn = 0) {
        input::Command command;
        command.request.zoom = zoom;
        command.request.turn = turn;
        for (int i = 0; i < static_cast<int>(seconds * 1e3); ++i) sample = step(state, limits, command, now += ms);
    }
    [[nodiscard]] double magnification() const { return std::tan(Pose{}.fov_y_rad / 2) / std::tan(sample.pose.fov_y_rad / 2); }
};

TEST(ZoomAction, MagnifiesByItsFactorEachSecondAndNoFurtherThanItsLimit) {
    Zooming eye;
    eye.hold(1, 1);  // gets going
    const double first = eye.magnification();
    eye.hold(1, 1);
    EXPECT_NEAR(eye.magnification() / first, eye.limits.zoom_per_s, 1e-9);
    eye.hold(1, 10);
    EXPECT_NEAR(eye.magnification(), eye.limits.max_zoom, 1e-9);
    EXPECT_EQ(eye.sample.zoom_rate, 0) << "at its end";
    eye.hold(-1, 20);
    EXPECT_EQ(eye.sample.pose.fov_y_rad, Pose{}.fov_y_rad) << "never wider than at the beginning, and the same bits";
    eye.hold(0, 1);
    EXPECT_EQ(eye.sample.uncertainty_rad, Zooming{}.sample.uncertainty_rad) << "who does not zoom pays nothing";

    Zooming none;
    none.limits.max_zoom = 1;
    none.hold(1, 5);
    EXPECT_EQ(none.sample.pose.fov_y_rad, Pose{}.fov_y_rad);
}

TEST(ZoomAction, WhatIsMagnifiedIsTurnedMoreSlowly) {
    Zooming eye;
    eye.hold(1, 10);
    eye.hold(0, 1, 1);
    EXPECT_NEAR(glm::length(eye.sample.angular_rad_s), eye.limits.turn_rad_s / eye.limits.max_zoom, 1e-3);
    const double yaw = eye.state.yaw.value;
    eye.hold(0, 1);
    input::Command pointer;
    pointer.request.turn_by_rad = 0.4;
    const double from = eye.state.yaw.value;
    EXPECT_NE(from, yaw);
    eye.sample = step(eye.state, eye.limits, pointer, eye.now += ms);
    eye.hold(0, 2);
    EXPECT_NEAR(eye.state.yaw.value - from, 0.4 / eye.limits.max_zoom, 1e-3);
}

TEST(ZoomAction, EndsAtAStopAndAtAnotherPlace) {
    Zooming eye;
    eye.hold(1, 2);
    input::Command stop;
    stop.order = Order::stop;
    const double at = eye.magnification();
    eye.sample = step(eye.state, eye.limits, stop, eye.now += ms);
    EXPECT_EQ(eye.magnification(), at);
    EXPECT_EQ(eye.sample.zoom_rate, 0);
    eye.hold(1, 1);
    input::Command brake;  // a device was lost
    brake.order = Order::brake;
    for (int i = 0; i < 50; ++i) eye.sample = step(eye.state, eye.limits, brake, eye.now += ms);
    EXPECT_EQ(eye.sample.zoom_rate, 0);
    // Walls and the pause put the eye where it is.
    ASSERT_TRUE(place(eye.state, eye.sample.pose, true));
    EXPECT_NEAR(pose_of(eye.state).fov_y_rad, eye.sample.pose.fov_y_rad, 1e-12);
    eye.hold(-1, 10);
    EXPECT_EQ(eye.sample.pose.fov_y_rad, Pose{}.fov_y_rad);
    eye.hold(1, 2);
    ASSERT_TRUE(place(eye.state, Pose{}));
    EXPECT_EQ(pose_of(eye.state).fov_y_rad, Pose{}.fov_y_rad) << "a viewpoint has its own field of view";
}

TEST(ZoomAction, NonsenseIsRest) {
    Zooming eye;
    eye.hold(std::numeric_limits<double>::quiet_NaN(), 0.01);
    EXPECT_EQ(eye.sample.pose.fov_y_rad, Pose{}.fov_y_rad);
    EXPECT_GT(eye.state.refused, 0U);
}

TEST(ZoomAction, NoSideOfTheViewLeavesThePredictionsBound) {
    Random random(5);
    const auto side = [](const Pose& pose, double wide) { return std::atan(wide * std::tan(pose.fov_y_rad / 2)); };
    double closest = 0;
    for (int i = 0; i < 500; ++i) {
        Zooming eye;
        eye.hold(random.range(0, 1), random.range(0, 2));
        eye.hold(random.range(-1, 1), random.range(0, 0.3));
        if (eye.sample.zoom_rate == 0) continue;
        const double lead_s = random.range(0.005, 0.1);
        const Prediction ahead = predict(eye.sample, eye.limits, lead_s);
        eye.hold(random.range(-1, 1), 0.5 * lead_s);
        eye.hold(random.range(-1, 1), lead_s - 0.5 * lead_s);
        for (const double wide : {0.5, 1.0, 1.78, 5.3}) {
            const double off = std::abs(side(eye.sample.pose, wide) - side(ahead.pose, wide));
            ASSERT_LE(off, ahead.uncertainty_rad) << lead_s << " s, " << wide;
            closest = std::max(closest, off / ahead.uncertainty_rad);
        }
    }
    EXPECT_GT(closest, 0.3) << "and it is no wide one";
}

}  // namespace
}  // namespace surefoot::input
