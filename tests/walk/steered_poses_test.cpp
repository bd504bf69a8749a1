// From samples to frame poses: the newest counts, also at the last moment; carried to the frame's time, but never far.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/time_units.hpp"
#include "tools/walk/steered_poses.hpp"

namespace surefoot::walk {
namespace {

constexpr std::int64_t period_ns = 33'333'333;

struct SteeredPosesTest : ::testing::Test {
    rt::TripleBuffer<SteeredSample> samples;
    input::MotionLimits limits;
    SteeredPoses poses{samples, limits, period_ns, nullptr};

    /// Walking along +x at 2 m/s, at x metres.
    SteeredSample& publish(std::int64_t time_ns, double x, std::uint64_t reports) {
        SteeredSample& s = samples.back();
        s = {};
        s.time_ns = time_ns;
        s.nav.pose.position = {x, 0, 0};
        s.nav.velocity_m_s = {2, 0, 0};
        s.nav.stamp_ns = time_ns - ms;
        s.reports = reports;
        samples.publish();
        return s;
    }
    double x_at(std::int64_t due_ns) { return poses.sample({0, due_ns, due_ns}).pose.position.x; }
};

TEST_F(SteeredPosesTest, TheNewestSampleIsInTheFrameAndANewerOneBeforeItsFirstSlice) {
    publish(10 * ms, 1, 5);
    publish(12 * ms, 2, 7);
    FramePose pose = poses.sample({0, 12 * ms, 12 * ms});
    EXPECT_EQ(pose.pose.position.x, 2);
    EXPECT_EQ(pose.reports, 7U);
    EXPECT_EQ(pose.stamp_ns, 11 * ms);
    EXPECT_FALSE(poses.latch({0, 12 * ms, 13 * ms}, pose)) << "nothing newer";
    publish(13 * ms, 2.002, 8);
    ASSERT_TRUE(poses.latch({0, 12 * ms, 14 * ms}, pose));
    EXPECT_EQ(pose.reports, 8U);
    EXPECT_NEAR(pose.pose.position.x, 2.0, 1e-12) << "at the frame's time, not at the sample's";
    EXPECT_FALSE(poses.latch({0, 12 * ms, 14 * ms}, pose));
}

TEST_F(SteeredPosesTest, APoseIsCarriedToTheFramesTimeAndAStalledInputStandsStill) {
    publish(10 * ms, 1, 1);
    EXPECT_NEAR(x_at(12 * ms), 1.004, 1e-12);
    EXPECT_NEAR(x_at(9 * ms), 0.998, 1e-12);
    const double furthest = 1 + 2e-9 * static_cast<double>(carry_limit_ns);
    EXPECT_NEAR(x_at(200 * ms), furthest, 1e-12);
    EXPECT_NEAR(x_at(2000 * ms), furthest, 1e-12);
}

TEST_F(SteeredPosesTest, EveryPoseOfTheNextThreeFramesIsForeseen) {
    publish(10 * ms, 1, 1);
    const FramePose pose = poses.sample({0, 11 * ms, 11 * ms});
    ASSERT_TRUE(pose.predicted.known);
    EXPECT_DOUBLE_EQ(pose.predicted.speed_m_s, 2);
    const double horizon_s = 3 * static_cast<double>(period_ns) * 1e-9;
    for (const double share : {0.0, 0.3, 1.0}) {
        const double t = share * horizon_s;
        for (const double a : {-limits.accel_m_s2, 0.0, limits.accel_m_s2}) {
            Pose there = pose.pose;
            there.position.x += 2 * t + 0.5 * a * t * t;
            EXPECT_TRUE(covers(pose.predicted.region, there, {1280, 720})) << "after " << t << " s at " << a << " m/s2";
        }
    }
    Pose beyond = pose.pose;
    beyond.position.x += 5;
    EXPECT_FALSE(covers(pose.predicted.region, beyond, {1280, 720})) << "a region of everything foresees nothing";
}

TEST(Covers, ZoomingOutUsesUpWhatIsLeftOfTurning) {
    prepare::Region region;
    region.radius_m = 0.25;
    region.angle_rad = 0.06;
    Pose pose = region.centre;
    const auto holds = [&](double zoom_rad, double turn_rad, model::Viewport viewport) {
        pose.fov_y_rad = region.centre.fov_y_rad + zoom_rad;
        pose.orientation = glm::angleAxis(turn_rad, dvec3(0, 1, 0));
        return covers(region, pose, viewport);
    };
    EXPECT_TRUE(holds(-0.5, 0.059, {1280, 720}));
    EXPECT_TRUE(holds(0.05, 0.03, {1280, 720}));
    EXPECT_FALSE(holds(0.05, 0.05, {1280, 720}));
    EXPECT_FALSE(holds(0.13, 0, {1280, 720}));
    region.centre.fov_y_rad = 0.1;  // narrow and very wide: zooming opens the sides three times as fast
    EXPECT_TRUE(holds(0.03, 0, {1280, 720}));
    EXPECT_FALSE(holds(0.06, 0, {3840, 720}));
}

TEST_F(SteeredPosesTest, JumpsAndStopsAreReportedAndATourIsNotPredictedByTheLimits) {
    publish(10 * ms, 1, 1);
    EXPECT_FALSE(poses.sample({0, 10 * ms, 10 * ms}).jumped);
    SteeredSample next = samples.front();
    next.jumps = 1;
    next.nav.stopped = true;
    next.touring = true;
    samples.back() = next;
    samples.publish();
    FramePose pose = poses.sample({0, 11 * ms, 11 * ms});
    EXPECT_TRUE(pose.jumped);
    EXPECT_TRUE(pose.stopped);
    EXPECT_FALSE(pose.predicted.known);
    const auto step = pose.pose.position - pose.before.position;
    EXPECT_LT(glm::length(step - next.nav.velocity_m_s * (static_cast<double>(period_ns) * 1e-9)), 1e-9)
        << "its first frame knows";
    EXPECT_GT(glm::length(step), 0.0) << "or the test shows nothing";
    EXPECT_FALSE(poses.sample({0, 12 * ms, 12 * ms}).jumped) << "said once";
}

}  // namespace
}  // namespace surefoot::walk
