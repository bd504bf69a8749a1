// The in-frame check without a clock: what a charging device has charged counts once, and the next slice counts whole.
#include <gtest/gtest.h>

#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

using test::ample_us;

struct InFrameCheck : testing::Test {
    std::unique_ptr<Engine> engine = test::forest_engine();
    prepare::PreparedFrame prepared;
    Pose pose;

    void SetUp() override {
        ASSERT_NE(engine, nullptr);
        engine->reserve(prepared);
        pose = test::forest_pose(*engine);
        engine->prepare({pose, 0.1, 0.06}, 0, 0, 0, prepared);
    }
    SubmitReport draw(double limit_us) {
        engine->select(prepared, ample_us, {1, 1}, 0);
        return engine->submit(pose, {.elapsed_us = 0, .limit_us = limit_us});
    }
    SubmitReport draw_last(double limit_us) {
        engine->select_last();
        return engine->submit(pose, {.elapsed_us = 0, .limit_us = limit_us});
    }
};

TEST_F(InFrameCheck, LetsThroughWhatEndsAtTheLimitAndNotWhatEndsBeyondIt) {
    const SubmitReport whole = draw(ample_us);
    ASSERT_GT(whole.slices, 5U);
    ASSERT_EQ(whole.downgraded_slices, 0U);
    EXPECT_EQ(draw(whole.predicted_us * (1 + 1e-5)).downgraded_slices, 0U) << "costs are as predicted";
    EXPECT_GT(draw(0.97 * whole.predicted_us).downgraded_slices, 0U);
}

TEST_F(InFrameCheck, DoesSoForTheFormsOfTheLastCut) {
    draw(ample_us);
    const SubmitReport whole = draw_last(ample_us);
    ASSERT_GT(whole.slices, 5U);
    EXPECT_GT(draw_last(0.97 * whole.predicted_us).downgraded_slices, 0U) << "groups that wait for their slice's end count";
    EXPECT_EQ(draw_last(whole.predicted_us + 2 * engine->options().slice_us).downgraded_slices, 0U);
}

/// On this clock all takes `slow` times as long as the device charges. It stands still once, for stall_us, when so much has been
/// charged.
struct SlowClock {
    gl::Device* device = nullptr;
    double slow = 1;
    double stall_at_us = 1e18, stall_us = 0;

    static std::int64_t now_ns(void* context) {
        const auto& clock = *static_cast<const SlowClock*>(context);
        clock.device->draws.plays();
        const double charged_us = clock.device->charged_us();
        return static_cast<std::int64_t>(1e3 * (clock.slow * charged_us + (charged_us > clock.stall_at_us ? clock.stall_us : 0)));
    }
};

TEST_F(InFrameCheck, WhatFramesUsuallyDoLetsNoneMissItsDeadline) {
    const SubmitReport whole = draw(ample_us);
    SlowClock clock{&engine->device(), 1};
    SubmitLimits limits{.limit_us = 1.2 * whole.predicted_us, .deadline_us = 1.4 * whole.predicted_us};
    limits.now_ns = SlowClock::now_ns;
    limits.now_context = &clock;
    int coarse = 0;
    for (int i = 0; i < 120; ++i) {  // right, slow, to and fro, far too slow
        clock.slow = i < 30 ? 1 : i < 60 ? 1.7 : i < 90 ? (i % 2 == 0 ? 1 : 1.7) : 3;
        engine->select(prepared, ample_us, {1, 1}, 0);
        const SubmitReport report = engine->submit(pose, limits);
        if (clock.slow > 2) {  // the floor alone may take longer then
            EXPECT_GE(report.downgraded_slices + 2, report.slices) << i;
        } else {
            EXPECT_LE(report.finished_us, limits.deadline_us) << i;
        }
        coarse += report.downgraded_slices > 0 ? 1 : 0;
    }
    EXPECT_GE(coarse, 75) << "30 slow ones, 15 of those to and fro, 30 far too slow";
}

/// A machine that stands still for 50 ms now and then must not make the pictures of the next seconds coarse.
TEST_F(InFrameCheck, AStallOfTheMachineCostsItsOwnFrameAlone) {
    const SubmitReport whole = draw(ample_us);
    for (const double share : {0.1, 0.4, 0.7}) {
        SlowClock clock{&engine->device(), 1};
        SubmitLimits limits{.limit_us = 1.3 * whole.predicted_us, .deadline_us = 1.5 * whole.predicted_us};
        limits.now_ns = SlowClock::now_ns;
        limits.now_context = &clock;
        int coarse = 0;
        for (int i = 0; i < 60; ++i) {
            if (i == 30) {
                engine->device().draws.plays();
                clock.stall_at_us = engine->device().charged_us() + share * whole.predicted_us;
                clock.stall_us = 3 * whole.predicted_us;
            }
            engine->select(prepared, ample_us, {1, 1}, 0);
            const SubmitReport report = engine->submit(pose, limits);
            if (i != 30) coarse += report.downgraded_slices > 0 ? 1 : 0;
        }
        EXPECT_EQ(coarse, 0) << "after a stall at " << share << " of the frame";
    }
}

}  // namespace
}  // namespace surefoot
