// Where a walk along a path will be: the region of the next poses, which the path knows.
#include <gtest/gtest.h>

#include <numbers>

#include "render/engine.hpp"
#include "tools/walk/pose_source.hpp"

namespace surefoot::walk {
namespace {

constexpr std::int64_t path_period_ns = 33'333'333;
constexpr model::Viewport path_viewport;

/// Straight on for a second, then a turn of 113 degrees a second.
Path with_a_turn() {
    Path path;
    for (int i = 0; i <= 120; ++i) {
        const double time_s = i / 60.0;
        Pose pose;
        pose.position = {1.5 * time_s, 1.7, 0};
        pose.orientation = glm::angleAxis(std::max(0.0, time_s - 1) * 113 * std::numbers::pi / 180, dvec3(0, 1, 0));
        path.samples.push_back({time_s, pose});
    }
    return path;
}

TEST(PathPoses, TheRegionCoversAllPosesUntilTheHorizonAndLittleElse) {
    const Path path = with_a_turn();
    PathPoses poses(path, path_period_ns);
    for (std::uint64_t slot = 1; slot < 50; ++slot) {
        const FramePose now = poses.sample({slot, 0, 0});
        ASSERT_TRUE(now.predicted.known);
        for (std::uint64_t k = 1; k <= 4; ++k)
            EXPECT_TRUE(covers(now.predicted.region, poses.sample({slot + k, 0, 0}).pose, path_viewport)) << slot << " + " << k;
        EXPECT_LT(now.predicted.region.radius_m, 0.37) << "0.15 m of way in three periods, and a margin";
        EXPECT_LT(now.predicted.region.angle_rad, 0.135) << "11.3 degrees in three periods, and a margin";
    }
}

TEST(PathPoses, TheFirstRegionCoversThePresentPoseToo) {
    const Path path = with_a_turn();
    PathPoses poses(path, path_period_ns);
    const FramePose first = poses.sample({});
    EXPECT_TRUE(covers(first.predicted.region, first.pose, path_viewport));
}

TEST(PathPoses, ThePredictedRegionOfASteadyTurnCoversItsPoses) {
    const Path path = with_a_turn();
    PathPoses poses(path, path_period_ns);
    const double period_s = 1e-9 * static_cast<double>(path_period_ns);
    const prepare::Region region =
        predict_region(poses.sample({39, 0, 0}).pose, poses.sample({40, 0, 0}).pose, period_s, horizon_s(period_s));
    for (std::uint64_t k = 0; k <= 3; ++k) EXPECT_TRUE(covers(region, poses.sample({40 + k, 0, 0}).pose, path_viewport)) << k;
    EXPECT_LT(region.angle_rad, 0.22) << "the middle of the turn, not its beginning, is the centre";
}

/// Standing still, the field of view opens from 1 to 91 degrees.
Path with_a_zoom(double degrees_a_second) {
    Path path;
    for (int i = 0; i <= 90; ++i) {
        Pose pose;
        pose.fov_y_rad = (1 + i) * std::numbers::pi / 180;
        path.samples.push_back({i / degrees_a_second, pose});
    }
    return path;
}

TEST(PathPoses, TheRegionCoversAChangingFieldOfViewAlsoOfAVeryWidePicture) {
    const Path path = with_a_zoom(30);
    for (const model::Viewport viewport : {path_viewport, model::Viewport{7680, 720}, model::Viewport{1280, 720, 2, 0}}) {
        PathPoses poses(path, path_period_ns, viewport);
        for (std::uint64_t slot = 1; slot < 160; ++slot) {  // there and back
            const FramePose now = poses.sample({slot, 0, 0});
            for (std::uint64_t k = 1; k <= 4; ++k)
                EXPECT_TRUE(covers(now.predicted.region, poses.sample({slot + k, 0, 0}).pose, viewport))
                    << viewport.width << " px, " << slot << " + " << k;
        }
    }
}

TEST(PathPoses, AWideningViewIsPredictedFromTwoPosesAndANarrowSetIsNotUsedForIt) {
    const Path path = with_a_zoom(60);
    PathPoses poses(path, path_period_ns);
    const double period_s = 1e-9 * static_cast<double>(path_period_ns);
    const Pose before = poses.sample({19, 0, 0}).pose, now = poses.sample({20, 0, 0}).pose;
    const prepare::Region widening = predict_region(before, now, period_s, horizon_s(period_s)),
                          as_wide_as_now = predict_region(now, now, period_s, horizon_s(period_s)),
                          closing = predict_region(now, before, period_s, horizon_s(period_s));
    for (std::uint64_t k = 0; k <= 3; ++k) {
        EXPECT_TRUE(covers(widening, poses.sample({20 + k, 0, 0}).pose, path_viewport)) << k;
        EXPECT_TRUE(covers(closing, poses.sample({19 - k, 0, 0}).pose, path_viewport)) << k;
    }
    EXPECT_FALSE(covers(as_wide_as_now, poses.sample({23, 0, 0}).pose, path_viewport));
    EXPECT_EQ(as_wide_as_now.centre.fov_y_rad, now.fov_y_rad);
    EXPECT_EQ(closing.centre.fov_y_rad, before.fov_y_rad);
}

}  // namespace
}  // namespace surefoot::walk
