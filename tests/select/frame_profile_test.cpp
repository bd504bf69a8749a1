// The usual course of frames: what it learns, and what it changes in the in-frame check.
#include "render/select/frame_profile.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "render/select/select.hpp"

namespace surefoot::select {
namespace {

constexpr double frame_limit_us = 32'000;

/// A check in the middle of a frame: 8 ms were predicted for what is finished.
CheckInput middle(double wrong, const FrameProfile& profile) {
    CheckInput in{.elapsed_us = 8'000 * wrong,
                  .predicted_so_far_us = 8'000,
                  .next_us = 3'000,
                  .next_stand_in_us = 2'000,
                  .rest_stand_in_us = 12'000,
                  .limit_us = frame_limit_us};
    const FrameProfile::Usual usual = profile.at(8'000, frame_limit_us);
    in.usual_wrong = usual.wrong;
    in.usual_tail = usual.tail;
    return in;
}

/// Frames of 24 ms, predicted right. The first 8 ms of them take `wrong` times as long, and the rest less or more.
void draw_frames(FrameProfile& profile, int count, double wrong, double end_us = 24'000) {
    for (int i = 0; i < count; ++i) {
        profile.begin();
        profile.note(8'000 * wrong, 8'000, wrongness(middle(wrong, profile)), frame_limit_us);
        profile.finish(end_us, 24'000, frame_limit_us);
    }
}

TEST(FrameProfile, KnowsNothingAtFirst) {
    const FrameProfile profile;
    for (const double us : {0.0, 8'000.0, 1e9, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(profile.at(us, frame_limit_us).wrong, 1.0);
        EXPECT_EQ(profile.at(us, frame_limit_us).tail, 1.0);
    }
    EXPECT_TRUE(still_fits(middle(1.0, profile)));
    EXPECT_FALSE(still_fits(middle(1.8, profile))) << "late by so much, it would end late";
}

TEST(FrameProfile, ALatenessThatEachFrameMakesUpForStopsNoFrame) {
    FrameProfile profile;
    draw_frames(profile, 60, 1.8);
    EXPECT_NEAR(profile.at(8'000, frame_limit_us).wrong, wrongness(middle(1.8, profile)), 0.01);
    EXPECT_NEAR(profile.at(8'000, frame_limit_us).tail, (24'000 - 14'400) / 16'000.0, 0.01);
    EXPECT_TRUE(still_fits(middle(1.8, profile)));
    EXPECT_NEAR(forecast_us(middle(1.8, profile)), 14'400 + 15'000, 200) << "the rest counts as predicted, not as less";
    EXPECT_FALSE(still_fits(middle(3.0, profile))) << "twice as late as usual is late";
    EXPECT_EQ(profile.at(20'000, frame_limit_us).wrong, 1.0) << "nothing was checked there";
}

TEST(FrameProfile, FramesThatAreLateToTheEndCountAsLate) {
    FrameProfile profile;
    draw_frames(profile, 60, 1.8, 1.8 * 24'000);
    EXPECT_NEAR(profile.at(8'000, frame_limit_us).tail, 1.8, 0.01);
    EXPECT_FALSE(still_fits(middle(1.8, profile)));
}

TEST(FrameProfile, EarlyFramesPromiseNothing) {
    FrameProfile profile;
    draw_frames(profile, 60, 0.5, 12'000);
    const CheckInput usual = middle(1.0, profile), unknown = middle(1.0, FrameProfile());
    EXPECT_LT(usual.usual_wrong, 1.0);
    EXPECT_EQ(forecast_us(usual), forecast_us(unknown));
}

TEST(FrameProfile, OneFrameSaysLittleAndNoNumberNothing) {
    FrameProfile profile;
    draw_frames(profile, 1, 100);  // beside a burst of other work
    EXPECT_LE(profile.at(8'000, frame_limit_us).wrong, 1.5);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    FrameProfile broken;
    broken.begin();
    broken.note(nan, 8'000, nan, frame_limit_us);
    broken.note(9'000, 10'000, 1.0, frame_limit_us);
    broken.finish(nan, nan, nan);
    for (double us = 0; us < frame_limit_us; us += 1'000) {
        EXPECT_EQ(broken.at(us, frame_limit_us).wrong, 1.0);
        EXPECT_EQ(broken.at(us, frame_limit_us).tail, 1.0);
    }
}

TEST(FrameProfile, TheFirstCheckOfABinCountsAndNoMoreFit) {
    FrameProfile profile;
    profile.begin();
    for (int i = 0; i < 1000; ++i) profile.note(32.0 * i, 32.0 * i, i % 63 == 0 ? 2.0 : 1.0, frame_limit_us);
    profile.finish(frame_limit_us, frame_limit_us, frame_limit_us);
    for (double us = 3'000; us < frame_limit_us; us += 2'000) EXPECT_NEAR(profile.at(us, frame_limit_us).wrong, 1.0, 0.13) << us;
    EXPECT_GT(profile.at(0, frame_limit_us).wrong, 1.1) << "2, an eighth of it";
    profile.finish(frame_limit_us, frame_limit_us, frame_limit_us);
    EXPECT_LT(profile.at(0, frame_limit_us).wrong, 1.2) << "each note is learnt once";
}

}  // namespace
}  // namespace surefoot::select
