// The grid and the frame loop on injected time: slots are conserved, policies are exact, records are whole.
#include <gtest/gtest.h>

#include "rt/base/random.hpp"
#include "rt/clock/grid.hpp"
#include "rt/frame/corrections.hpp"
#include "rt/frame/form_correction.hpp"
#include "rt/frame/loop.hpp"
#include "rt/frame/overshoot.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

TEST(Grid, RunAndSkippedAreElapsedExactlyUnderAnyWork) {
    Random random(1);
    for (const LatePolicy policy : {LatePolicy::lock, LatePolicy::floating}) {
        const Grid grid{7, 16'666'667};
        std::uint64_t slot = 0, run = 0, skipped = 0;
        std::int64_t now = grid.t0_ns;
        for (int i = 0; i < 100000; ++i) {
            now += static_cast<std::int64_t>(random.unit() * random.unit() * 60e6) + (i % 5000 == 0 ? 500 * ms : 0);
            const NextSlot next = next_slot(grid, policy, slot, now);
            ++run;
            skipped += next.skipped;
            ASSERT_GT(next.slot, slot);
            ASSERT_EQ(run + skipped, next.slot);
            ASSERT_GE(next.start_ns, std::min(now, grid.due_ns(next.slot)));
            if (policy == LatePolicy::lock) {
                ASSERT_EQ((next.shown_ns - grid.t0_ns) % grid.period_ns, 0) << "lock shows on the grid only";
                ASSERT_GE(next.shown_ns, now);
            }
            slot = next.slot;
            now = std::max(now, next.start_ns);
        }
    }
}

TEST(Grid, LockSkipsWholeSlotsAndFloatOnlyThoseThatHavePassed) {
    const Grid grid{0, 10 * ms};
    const NextSlot lock = next_slot(grid, LatePolicy::lock, 0, 12 * ms);
    EXPECT_TRUE(lock.missed);
    EXPECT_EQ(lock.slot, 2U);
    EXPECT_EQ(lock.skipped, 1U);
    EXPECT_EQ(lock.shown_ns, 20 * ms);
    const NextSlot floating = next_slot(grid, LatePolicy::floating, 0, 12 * ms);
    EXPECT_TRUE(floating.missed);
    EXPECT_EQ(floating.slot, 1U);
    EXPECT_EQ(floating.skipped, 0U);
    EXPECT_EQ(floating.shown_ns, 12 * ms);
    EXPECT_FALSE(next_slot(grid, LatePolicy::lock, 0, 10 * ms).missed) << "exactly on the deadline is in time";
}

/// Work of a given length; counts what it is asked.
class FakeStages final : public FrameStages {
public:
    FakeStages(VirtualClock& clock, std::vector<std::int64_t> work_ns) : clock_(clock), work_ns_(std::move(work_ns)) {}
    void sample(FrameRecord&) override { ++samples; }
    void select(FrameRecord&) override { clock_.advance(ms); }
    void submit(FrameRecord& r) override { clock_.advance(work_ns_[r.frame % work_ns_.size()]); }
    void finish(FrameRecord&) override {}
    void account(FrameRecord& r) override { missed += r.missed ? 1 : 0; }
    int samples = 0, missed = 0;

private:
    VirtualClock& clock_;
    std::vector<std::int64_t> work_ns_;
};

TEST(Loop, FillsRecordsAndSkipsLateSlots) {
    VirtualClock clock;
    FakeStages stages(clock, {5 * ms, 5 * ms, 14 * ms, 5 * ms});
    SpscRing<FrameRecord> ring(64);
    FrameLoopOptions options;
    options.period_ns = 10 * ms;
    options.t0_ns = 10 * ms;
    options.frames = 8;
    const FrameLoopResult result = run_frame_loop(options, clock, stages, ring);
    EXPECT_EQ(result.run, 8U);
    EXPECT_EQ(result.skipped, 2U);
    EXPECT_EQ(result.elapsed, result.run + result.skipped);
    EXPECT_EQ(stages.samples, 8);
    EXPECT_EQ(stages.missed, 2);
    FrameRecord r;
    std::uint64_t slot = 0;
    for (int i = 0; ring.try_pop(r); ++i) {
        EXPECT_EQ(r.slot, slot + r.skipped_before + (i > 0 ? 1 : 0));
        slot = r.slot;
        EXPECT_EQ(r.due_ns, 10 * ms + static_cast<std::int64_t>(r.slot) * 10 * ms);
        EXPECT_EQ(r.selected_ns - r.woken_ns, ms);
        EXPECT_EQ(r.missed, i % 4 == 2);
        if (r.missed) {
            EXPECT_EQ(r.cause, Cause::submit);
        }
    }
}

TEST(Loop, ControlBlocksAlternateAndTheBareLoopBurnsTheSame) {
    VirtualClock clock;
    FakeStages stages(clock, {6 * ms});
    SpscRing<FrameRecord> ring(256);
    const ControlSchedule schedule{5, 4};
    FrameLoopOptions options;
    options.period_ns = 10 * ms;
    options.t0_ns = 10 * ms;
    options.control = &schedule;
    run_frame_loop(options, clock, stages, ring);
    FrameRecord r;
    int walk = 0, bare = 0;
    while (ring.try_pop(r)) {
        EXPECT_EQ(r.control, !ControlSchedule::is_walk(r.block));
        (r.control ? bare : walk) += 1;
        if (r.control) {
            EXPECT_EQ(r.complete_ns - r.woken_ns, 7 * ms);
        }
    }
    EXPECT_EQ(walk, 20);
    EXPECT_EQ(bare, 20);
}

TEST(Controller, SpendsTheTablesHeadroomUntilFramesAreMeasured) {
    CostController c;
    EXPECT_EQ(c.headroom(1.4), 1.4);
    for (int i = 0; i < 57; ++i) c.update(100, 101);
    EXPECT_EQ(c.headroom(1.4), 1.4);  // six of 64 are still unknown
    for (int i = 0; i < 200; ++i) c.update(100, 101);
    EXPECT_EQ(c.headroom(1.4), CostController::min_headroom);
    EXPECT_EQ(c.headroom(1.02), 1.02);  // never above the table's
    EXPECT_EQ(c.headroom(0.5), 1);
}

TEST(Controller, UpperIsTheNinetiethPercentileOfRecentFrames) {
    CostController c;
    for (int i = 0; i < 1000; ++i) c.update(100, i % 5 == 0 ? 125 : 100);  // a fifth of the frames cost a quarter more
    EXPECT_EQ(c.factor(), 1);
    EXPECT_EQ(c.headroom(1.4), 1.25);
    for (int i = 0; i < 1000; ++i) c.update(100, i % 20 == 0 ? 190 : 100);  // a twentieth is outliers
    EXPECT_EQ(c.headroom(1.4), CostController::min_headroom);
    for (int i = 0; i < 7; ++i) c.update(100, 150);  // rises as soon as a tenth of the window says so
    EXPECT_GT(c.headroom(2), 1.4);
    for (int i = 0; i < 64; ++i) c.update(100, 100);  // and falls with the window, not long after it
    EXPECT_EQ(c.headroom(2), CostController::min_headroom);
}

TEST(Controller, MeetsADoubledCostAndIsDeafToOutliers) {
    CostController c;
    for (int i = 0; i < 40; ++i) c.update(100, 200);
    EXPECT_NEAR(c.factor(), 2.0, 1e-9);
    for (int i = 0; i < 40; ++i) c.update(100, 1000);
    EXPECT_EQ(c.factor(), CostController::highest);
    CostController deaf;
    for (int i = 0; i < 60; ++i) deaf.update(100, i % 3 == 0 ? 10000 : 100);
    EXPECT_NEAR(deaf.factor(), 1.0, 1e-9);
    for (const double bad : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        deaf.update(bad, 100), deaf.update(100, bad);
    EXPECT_NEAR(deaf.factor(), 1.0, 1e-9);
}

TEST(Corrections, EachStateKeepsItsOwnAndStartsWithTheLastOnes) {
    Corrections c;
    for (int i = 0; i < 100; ++i) c.update(0, 100, 150);
    EXPECT_NEAR(c.of(0).factor(), 1.5, 1e-9);
    EXPECT_EQ(c.of(4).factor(), c.of(0).factor()) << "not drawn yet: as the last state";
    for (int i = 0; i < 100; ++i) c.update(4, 100, 80);
    EXPECT_NEAR(c.of(4).factor(), 0.8, 1e-9);
    EXPECT_NEAR(c.of(0).factor(), 1.5, 1e-9) << "kept, although 100 frames of another state came between";
    EXPECT_EQ(c.of(2).factor(), c.of(4).factor()) << "the last frame's state is 4";
    EXPECT_EQ(c.of(99).factor(), c.of(4).factor()) << "states above the last are the last";
    for (int i = 0; i < 100; ++i) c.update(5, 100, 130);
    EXPECT_NEAR(c.of(0).factor(), 1.5, 1e-9) << "a wrong price of one state spoils no other";
    EXPECT_NEAR(c.of(4).factor(), 0.8, 1e-9);
    c.update(4, 100, 80);
    EXPECT_NEAR(c.of(5).factor(), 1.3, 1e-9);
    c.forget_from(5);
    EXPECT_EQ(c.of(5).factor(), c.of(4).factor()) << "what is forgotten starts again as the last state";
    EXPECT_NEAR(c.of(0).factor(), 1.5, 1e-9);
}

TEST(Corrections, AResolutionNotDrawnYetIsDearerThanTheLastOneUpToTheTable) {
    Corrections c;
    for (int i = 0; i < 100; ++i) c.update(4, 100, 64);
    EXPECT_NEAR(c.factor(0), 0.8, 1e-9) << "a quarter more";
    EXPECT_NEAR(c.expected(0), 0.8, 1e-9);
    c.update(0, 100, 80);
    EXPECT_NEAR(c.factor(0), 0.8, 1e-9) << "it starts there";
    for (int i = 0; i < 10; ++i) c.update(0, 100, 100);
    EXPECT_NEAR(c.factor(0), 1.0, 0.05) << "and learns its own as fast as ever";
    EXPECT_NEAR(c.factor(4), 0.64, 1e-9) << "kept";
    c.forget_from(1);
    EXPECT_EQ(c.factor(4), c.factor(0)) << "forgotten";
    for (int i = 0; i < 60; ++i) c.update(0, 100, 98);
    EXPECT_NEAR(c.factor(4), 1.0, 1e-9) << "not above the table, where the last one is just below";
    Corrections fresh;
    for (int i = 0; i < 30; ++i) fresh.update(4, 100, 64);
    EXPECT_EQ(fresh.factor(0), fresh.factor(4)) << "whose error it is cannot be known yet";
    Corrections filter;
    for (int i = 0; i < 100; ++i) filter.update(4, 100, 64);
    EXPECT_NEAR(filter.factor(9), 0.64, 1e-9) << "the other filter at the same resolution: the machine's error is all its own";
    Corrections dear;
    for (int i = 0; i < 100; ++i) dear.update(4, 100, 144);
    EXPECT_NEAR(dear.factor(0), 1.44, 1e-9) << "no hope that another resolution is less wrong";
    dear.update(0, 100, 144);
    EXPECT_NEAR(dear.factor(0), 1.44, 1e-9);
}

TEST(Corrections, WhatSlowsTheDrawnStateSlowsTheOthers) {
    Corrections c;
    for (int i = 0; i < 100; ++i) c.update(0, 100, 100);
    EXPECT_NEAR(c.expected(4), 1, 1e-9) << "not drawn yet: as the last state";
    for (int i = 0; i < 100; ++i) c.update(4, 100, 120);
    EXPECT_NEAR(c.expected(4), 1.2, 1e-9);
    EXPECT_NEAR(c.expected(0), 1, 1e-9) << "its own prices were learnt, the machine is as before";
    for (int i = 0; i < 100; ++i) c.update(4, 100, 180);
    EXPECT_NEAR(c.expected(0), 1.5, 1e-9) << "half as much again in what is drawn";
    EXPECT_NEAR(c.of(0).factor(), 1, 1e-9);
    for (int i = 0; i < 100; ++i) c.update(4, 100, 120);
    EXPECT_NEAR(c.expected(0), 1, 1e-9) << "and back";
    for (int i = 0; i < 100; ++i) c.update(4, 100, 1000);
    EXPECT_LE(c.expected(0), CostController::highest);
}

TEST(Corrections, MonthsOfChangesKeepWhatIsExpectedNearWhatWasLearnt) {
    Corrections c;
    for (int visit = 0; visit < 3000; ++visit) {  // dear after a while, in both states alike: each visit adds to what has drifted
        for (const std::size_t state : {std::size_t{0}, std::size_t{4}})
            for (int i = 0; i < 80; ++i) c.update(state, 100, i < 40 ? 90 : 130);
    }
    for (const std::size_t state : {std::size_t{0}, std::size_t{4}}) {
        EXPECT_GE(c.expected(state), 0.3 * c.of(state).factor()) << state;  // not 0, infinite, or no number
        EXPECT_LE(c.expected(state), 3 * c.of(state).factor()) << state;
    }
}

TEST(Overshoot, IsTheUpperTwentiethOfRecentFrames) {
    Overshoot o;
    EXPECT_EQ(o.margin_us(), 0);
    for (int i = 0; i < 200; ++i) o.update(-500);
    EXPECT_EQ(o.margin_us(), 0) << "frames that end before their forecast give nothing back";
    for (int i = 0; i < 200; ++i) o.update(i % 10 == 0 ? 2000 : 100);
    EXPECT_EQ(o.margin_us(), 2000);
    for (int i = 0; i < 192; ++i) o.update(i % 64 == 0 ? 9000 : 100);
    EXPECT_EQ(o.margin_us(), 100) << "one frame in 64 is an outlier";
    o.update(std::numeric_limits<double>::quiet_NaN());
    o.update(std::numeric_limits<double>::infinity());
    EXPECT_EQ(o.margin_us(), 100);
}

double random_share(std::uint32_t& seed) {
    seed = seed * 1664525U + 1013904223U;
    return static_cast<double>(seed >> 8U) / static_cast<double>(1U << 24U);
}

/// Frames of 20 ms predicted, with any mix of full and coarse forms.
FormCorrection learnt(double full, double coarse, int frames, int outlier_every) {
    FormCorrection forms;
    std::uint32_t seed = 7;
    for (int i = 0; i < frames; ++i) {
        const double full_us = 20000 * random_share(seed), coarse_us = 20000 - full_us;
        const double actual_us = 500 + (full * full_us + coarse * coarse_us) * (0.95 + 0.1 * random_share(seed));
        forms.update(full_us, coarse_us, 500, outlier_every > 0 && i % outlier_every == 0 ? 5 * actual_us : actual_us);
    }
    return forms;
}

TEST(FormCorrection, FindsWhichKindOfFormIsPredictedWrong) {
    EXPECT_NEAR(learnt(0.7, 1.4, 200, 0).ratio(), 0.5, 0.05);
    EXPECT_NEAR(learnt(1.2, 0.8, 200, 0).ratio(), 1.5, 0.15);
    EXPECT_NEAR(learnt(1.0, 1.0, 200, 0).ratio(), 1.0, 0.05);
    EXPECT_NEAR(learnt(2.0, 2.0, 200, 0).ratio(), 1.0, 0.05) << "a slower machine is slower for both";
    EXPECT_EQ(learnt(0.5, 5.0, 600, 0).ratio(), 1 / FormCorrection::max_ratio);
}

TEST(FormCorrection, ForgivesOutliersAndFramesOfOneKind) {
    EXPECT_NEAR(learnt(0.7, 1.4, 400, 10).ratio(), 0.5, 0.12);
    FormCorrection same;
    for (int i = 0; i < 500; ++i) same.update(10000, 10000, 500, 30000);
    EXPECT_NEAR(same.ratio(), 1.0, 0.05) << "one mix says nothing about either";
    FormCorrection one_kind;
    for (int i = 0; i < 100000; ++i) one_kind.update(20000, 0, 500, 20500);
    one_kind.update(19800, 200, 500, 24000);
    EXPECT_NEAR(one_kind.ratio(), 1.0, 0.2) << "a hundredth of a frame decides nothing";
    const double before = same.ratio();
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        same.update(bad, 1, 0, 100);
        same.update(1, bad, 0, 100);
        same.update(1, 1, 0, bad);
    }
    same.update(0, 0, 0, 100);
    EXPECT_EQ(same.ratio(), before);
}

}  // namespace
}  // namespace surefoot::rt
