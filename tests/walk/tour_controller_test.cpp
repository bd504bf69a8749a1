// The visitor's buttons: viewpoints in turn, the tour and who ends it, pause, and what a stop leaves of them.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/walk/tour_controller.hpp"

namespace surefoot::walk {
namespace {

constexpr std::int64_t tick_ns = 2'000'000;

Path straight_path() {
    Path path;
    for (int i = 0; i <= 8; ++i) {
        PathSample s;
        s.time_s = i;
        s.pose.position = {10.0 * i, 1, 0};
        path.samples.push_back(s);
    }
    return path;
}

class TourControllerTest : public ::testing::Test {
protected:
    /// Ticks for so long with nothing pressed but what `press` says in the first; the hand moves at `speed`.
    void run(double seconds, double speed = 0, bool input::NavigationSample::*press = nullptr, bool stopped = false) {
        steering_.steers.plays();
        for (long i = 0; i < std::lround(seconds * 500); ++i) {
            now_ns_ += tick_ns;
            sample_ = {};
            sample_.pose = eye_;
            if (!stopped) sample_.pose.position.z -= speed * 0.002;
            sample_.velocity_m_s = {0, 0, stopped ? 0 : -speed};
            sample_.stopped = stopped;
            if (i == 0 && press != nullptr) sample_.*press = true;
            tour_controller_.follow(sample_, steering_, now_ns_);
            eye_ = sample_.pose;
        }
    }
    [[nodiscard]] double x() const { return eye_.position.x; }
    [[nodiscard]] double z() const { return eye_.position.z; }

    Path path_ = straight_path();
    TourController tour_controller_{path_};
    input::Steering steering_{{}, {}};
    input::NavigationSample sample_;
    Pose eye_ = tour_controller_.start();
    std::int64_t now_ns_ = 0;
};

TEST_F(TourControllerTest, ATourFromTheStartLosesNoTimeInAStallUntilItIsLeft) {
    tour_controller_.begin_tour(0);
    run(1);
    now_ns_ += 1'000'000'000;  // no step for a second
    run(0.1);
    EXPECT_NEAR(x(), 21, 1e-6);
    EXPECT_TRUE(tour_controller_.on_schedule());
    run(1, 0, &input::NavigationSample::pause);
    EXPECT_FALSE(tour_controller_.on_schedule());
    run(1, 0, &input::NavigationSample::pause);
    EXPECT_NEAR(x(), 31, 0.1) << "it goes on from where it paused";
}

TEST_F(TourControllerTest, ATourFromTheStartFollowsThePathUntilTheHandMoves) {
    tour_controller_.begin_tour(100 * tick_ns);
    run(0.1);
    EXPECT_EQ(x(), 0) << "it begins with the walk, not before";
    run(2.1);
    EXPECT_NEAR(x(), 20, 0.1);
    EXPECT_EQ(tour_controller_.jumps(), 0U) << "it stands where it begins";
    run(0.5, 1.4);
    EXPECT_FALSE(tour_controller_.touring());
    const double left_at = x();
    run(1.0);
    EXPECT_EQ(x(), left_at);
    EXPECT_LT(z(), -0.5);
}

TEST_F(TourControllerTest, ViewpointsLieAtEqualTimesAndComeInTurn) {
    for (int i = 1; i <= viewpoint_count; ++i) {
        run(0.1, 0, &input::NavigationSample::next_viewpoint);
        EXPECT_NEAR(x(), 10.0 * (i % viewpoint_count), 1e-9);
    }
    EXPECT_EQ(tour_controller_.jumps(), static_cast<std::uint32_t>(viewpoint_count));
    run(0.1, 0, &input::NavigationSample::next_viewpoint);
    run(0.1, 0, &input::NavigationSample::reset);
    EXPECT_EQ(x(), 0);
    run(0.1, 0, &input::NavigationSample::next_viewpoint);
    EXPECT_NEAR(x(), 10, 1e-9) << "after a reset the turn begins anew";
}

TEST_F(TourControllerTest, ATourFollowsThePathUntilTheHandMovesAndGoesOnWhereItWasLeft) {
    run(0.5, 1);
    run(1, 0, &input::NavigationSample::tour);
    EXPECT_TRUE(tour_controller_.touring());
    EXPECT_NEAR(x(), 10, 0.1);
    EXPECT_NEAR(sample_.velocity_m_s.x, 10, 1e-6);
    run(0.5, 1);
    EXPECT_FALSE(tour_controller_.touring());
    EXPECT_NEAR(x(), 10, 0.1) << "the hand takes over where the tour is";
    EXPECT_NEAR(z(), -0.5, 0.01);
    run(1, 0, &input::NavigationSample::tour);
    EXPECT_NEAR(x(), 20, 0.2);
    run(0.1, 0, &input::NavigationSample::next_viewpoint);
    EXPECT_FALSE(tour_controller_.touring());
    run(1, 0, &input::NavigationSample::tour);
    EXPECT_NEAR(x(), 30, 0.3) << "a viewpoint in between does not set it back";
    run(0.1, 0, &input::NavigationSample::reset);
    run(1, 0, &input::NavigationSample::tour);
    EXPECT_NEAR(x(), 10, 0.1) << "a reset does";
}

TEST_F(TourControllerTest, AHandThatHoldsOnWhileTheTourIsPressedDoesNotEndIt) {
    run(0.2, 1);
    run(0.3, 1, &input::NavigationSample::tour);
    EXPECT_TRUE(tour_controller_.touring());
    run(0.3, 0);
    EXPECT_TRUE(tour_controller_.touring());
    run(0.01, 1);
    EXPECT_FALSE(tour_controller_.touring());
}

TEST_F(TourControllerTest, APauseHoldsTheEyeAgainstHandAndTourUntilPressedAgain) {
    run(0.5, 1);
    const double stood = z();
    run(0.5, 1, &input::NavigationSample::pause);
    EXPECT_NEAR(z(), stood, 0.0021) << "from the tick of the press on";
    EXPECT_EQ(glm::length(sample_.velocity_m_s), 0);
    run(0.5, 1, &input::NavigationSample::pause);
    EXPECT_NEAR(z(), stood - 0.5, 0.01);
    run(1, 0, &input::NavigationSample::tour);
    run(1, 0, &input::NavigationSample::pause);
    EXPECT_NEAR(x(), 10, 0.1);
    run(1, 0, &input::NavigationSample::pause);
    EXPECT_NEAR(x(), 20, 0.2);
}

TEST_F(TourControllerTest, APauseKeepsTheZoomAndAViewpointEndsIt) {
    steering_.steers.plays();
    ASSERT_TRUE(steering_.place(eye_));
    const double usual = eye_.fov_y_rad;
    eye_.fov_y_rad = 2 * std::atan(std::tan(usual / 2) / 4);
    run(0.5, 0, &input::NavigationSample::pause);
    EXPECT_NEAR(input::pose_of(steering_.motion()).fov_y_rad, eye_.fov_y_rad, 1e-12);
    EXPECT_NEAR(steering_.motion().zoom, std::log(4), 1e-12) << "so it can be taken back";
    run(0.1, 0, &input::NavigationSample::next_viewpoint);
    EXPECT_EQ(steering_.motion().zoom, 0);
    EXPECT_EQ(input::pose_of(steering_.motion()).fov_y_rad, usual);
}

TEST_F(TourControllerTest, AStopEndsTheTourAndLeavesTheVisitorStanding) {
    run(1, 0, &input::NavigationSample::tour);
    const double stood = x();
    run(0.5, 1, nullptr, true);
    EXPECT_FALSE(tour_controller_.touring());
    EXPECT_EQ(x(), stood);
    run(0.5, 0);
    EXPECT_EQ(x(), stood) << "taken off, nothing carries the visitor on";
}

}  // namespace
}  // namespace surefoot::walk
