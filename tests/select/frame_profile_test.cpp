// The usual course of frames: what it learns, and what it changes in the in-frame check.
#include "render/select/frame_profile.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "render/select/select.hpp"

namespace surefoot::select {
namespace {

constexpr double frame_limit_us = 32'000, deadline_us = 36'000;

/// A check in the middle of a frame: 8 ms were predicted for what is finished.
CheckInput middle(double wrong, const FrameProfile& profile) {
    CheckInput in{.elapsed_us = 8'000 * wrong,
                  .predicted_so_far_us = 8'000,
                  .next_us = 3'000,
                  .next_stand_in_us = 2'000,
                  .rest_stand_in_us = 12'000,
                  .limit_us = frame_limit_us,
                  .deadline_us = deadline_us};
    const FrameProfile::Usual usual = profile.at(8'000, frame_limit_us);
    in.usual_head = usual.head;
    in.usual_tail = usual.tail;
    return in;
}

/// Frames of 24 ms, predicted right. The first 8 ms of them take `wrong` times as long, and the rest less or more.
void draw_frames(FrameProfile& profile, int count, double wrong, double end_us = 24'000) {
    for (int i = 0; i < count; ++i) {
        profile.begin();
        profile.note(8'000 * wrong, 8'000, frame_limit_us);
        profile.finish(end_us, 24'000, frame_limit_us);
    }
}

TEST(FrameProfile, KnowsNothingAtFirst) {
    const FrameProfile profile;
    for (const double us : {0.0, 8'000.0, 1e9, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(profile.at(us, frame_limit_us).head, 1.0);
        EXPECT_EQ(profile.at(us, frame_limit_us).tail, 1.0);
    }
    EXPECT_TRUE(still_fits(middle(1.0, profile)));
    EXPECT_FALSE(still_fits(middle(1.7, profile))) << "late by so much, it would end late";
}

TEST(FrameProfile, ALatenessThatEachFrameMakesUpForStopsNoFrame) {
    FrameProfile profile;
    draw_frames(profile, 60, 1.7);
    EXPECT_NEAR(profile.at(8'000, frame_limit_us).head, 1.7, 0.01);
    EXPECT_EQ(profile.at(8'000, frame_limit_us).tail, 1.0) << "the rest counts as predicted, not as less";
    EXPECT_TRUE(still_fits(middle(1.7, profile)));
    EXPECT_NEAR(forecast_us(middle(1.7, profile)), 13'600 + 15'000, 100);
    EXPECT_EQ(profile.at(20'000, frame_limit_us).head, 1.0) << "nothing was checked there";
}

/// Pictures are timed by themselves. Forms that were late once must not make them look late.
TEST(FrameProfile, WhatComesLastIsNoPartOfTheTail) {
    FrameProfile profile;
    draw_frames(profile, 1, 1.0, 28'000);
    CheckInput in = middle(1.0, profile);
    EXPECT_NEAR(in.usual_tail, 1.25, 1e-9);
    in.rest_stand_in_us = 4'000;
    in.last_us = 8'000;
    EXPECT_NEAR(forecast_us(in), 8'000 + 1.25 * 7'000 + 8'000, 1e-6);
    const double before_us = forecast_us(in);
    in.elapsed_us = 12'000;  // the frame itself is slow: then all of it is
    EXPECT_GT(forecast_us(in), before_us + 4'000 + 0.1 * 8'000);
    in = middle(1.0, {});
    const double in_slices_us = forecast_us(in);
    in.last_us = std::exchange(in.rest_stand_in_us, 0);
    EXPECT_EQ(forecast_us(in), in_slices_us) << "where nothing is known it counts as slices do";
}

TEST(FrameProfile, NoFrameIsForgivenMoreThanItsDeadline) {
    FrameProfile profile;
    draw_frames(profile, 60, 3.0);
    CheckInput in = middle(2.0, profile);
    EXPECT_LT(forecast_us(in), frame_limit_us);
    EXPECT_FALSE(still_fits(in)) << "if it goes on so, it misses";
    in.deadline_us = 1e9;
    EXPECT_TRUE(still_fits(in));
    in.deadline_us = 0;
    EXPECT_FALSE(still_fits(in)) << "none is given: the limit";
}

TEST(FrameProfile, FramesThatAreLateToTheEndCountAsLateAtOnce) {
    FrameProfile profile;
    draw_frames(profile, 60, 1.7);
    draw_frames(profile, 1, 1.7, 1.7 * 24'000);
    EXPECT_NEAR(profile.at(8'000, frame_limit_us).tail, 1.7, 0.01);
    EXPECT_FALSE(still_fits(middle(1.7, profile)));
    draw_frames(profile, 2, 1.7);
    EXPECT_GT(profile.at(8'000, frame_limit_us).tail, 1.4) << "forgotten slowly";
}

TEST(FrameProfile, OneStalledFrameTeachesNothingAndTwoDo) {
    FrameProfile profile;
    draw_frames(profile, 10, 1.0);
    draw_frames(profile, 1, 1.0, 60'000);  // the rest took 3.25 times as long: the machine stood still
    EXPECT_EQ(profile.at(8'000, frame_limit_us).tail, 1.0);
    draw_frames(profile, 1, 1.0);
    draw_frames(profile, 1, 1.0, 60'000);
    EXPECT_EQ(profile.at(8'000, frame_limit_us).tail, 1.0) << "alone again";
    draw_frames(profile, 1, 1.0, 60'000);
    EXPECT_GT(profile.at(8'000, frame_limit_us).tail, 3.0) << "the second in a row";
}

/// Else no frame would draw the rest again, and none would learn.
TEST(FrameProfile, ALatenessThatCoarseFramesCannotSeeIsForgotten) {
    FrameProfile profile;
    draw_frames(profile, 2, 1.0, 60'000);
    EXPECT_FALSE(still_fits(middle(1.0, profile)));
    int coarse = 0;
    while (coarse < 100 && !still_fits(middle(1.0, profile))) {
        profile.begin();
        profile.note(8'000, 8'000, frame_limit_us);
        profile.finish(11'000, 11'000, frame_limit_us);  // all after the check was drawn coarse
        ++coarse;
    }
    EXPECT_LE(coarse, 20);
    EXPECT_GE(coarse, 5) << "not at once: it may be so";
}

TEST(FrameProfile, OneFrameAsPredictedEndsWhatWasForgiven) {
    FrameProfile profile;
    draw_frames(profile, 60, 1.7);
    draw_frames(profile, 1, 1.0);
    EXPECT_EQ(profile.at(8'000, frame_limit_us).head, 1.0);
    for (int i = 0; i < 40; ++i) draw_frames(profile, 1, i % 2 == 0 ? 1.7 : 1.0);
    EXPECT_LT(profile.at(8'000, frame_limit_us).head, 1.1) << "every other frame is late";
}

TEST(FrameProfile, EarlyFramesPromiseNothing) {
    FrameProfile profile;
    draw_frames(profile, 60, 0.5, 12'000);
    EXPECT_EQ(forecast_us(middle(1.0, profile)), forecast_us(middle(1.0, FrameProfile())));
}

TEST(FrameProfile, OneFrameSaysLittleAShortRestAndNoNumberNothing) {
    FrameProfile profile;
    draw_frames(profile, 1, 100);  // beside a burst of other work
    EXPECT_LE(profile.at(8'000, frame_limit_us).head, 1.375);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    FrameProfile broken;
    broken.begin();
    broken.note(nan, 8'000, frame_limit_us);
    broken.note(9'000, 10'000, frame_limit_us);
    broken.finish(nan, nan, nan);
    FrameProfile ended;
    ended.begin();
    ended.note(20'000, 20'000, frame_limit_us);
    ended.finish(24'000, 21'000, frame_limit_us);  // four times as long as predicted, by fixed costs of a frame's end
    for (double us = 0; us < frame_limit_us; us += 1'000) {
        EXPECT_EQ(broken.at(us, frame_limit_us).head, 1.0);
        EXPECT_EQ(broken.at(us, frame_limit_us).tail, 1.0);
        EXPECT_EQ(ended.at(us, frame_limit_us).tail, 1.0);
    }
}

TEST(FrameProfile, TheFirstCheckOfABinCountsOnce) {
    FrameProfile profile;
    profile.begin();
    for (int i = 1; i < 1000; ++i) profile.note(i % 63 == 1 ? 64.0 * i : 32.0 * i, 32.0 * i, frame_limit_us);
    profile.finish(frame_limit_us, frame_limit_us, frame_limit_us);
    EXPECT_NEAR(profile.at(0, frame_limit_us).head, 1.125, 1e-9) << "2, an eighth of it";
    EXPECT_EQ(profile.at(2'500, frame_limit_us).head, 1.0) << "its first check was as predicted";
    profile.finish(frame_limit_us, frame_limit_us, frame_limit_us);
    EXPECT_NEAR(profile.at(0, frame_limit_us).head, 1.125, 1e-9) << "each note is learnt once";
}

}  // namespace
}  // namespace surefoot::select
