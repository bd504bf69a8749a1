// The frame loop on injected time: what was lost is told from what was spent, and each loss is named.
#include "rt/frame/loop.hpp"
#include "rt/frame/frame_account.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <utility>
#include <vector>

#include "rt/threads/guard.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

constexpr std::uint64_t disturbed_frame = 3;

/// Ordinary frames of 0.5 + 3 + 3 ms in a period of 10; one frame is disturbed in one stage.
class Stages final : public FrameStages {
public:
    VirtualClock& clock;
    std::function<void()> in_select, in_submit, in_finish, in_account;
    std::uint32_t prepared_age = 1;
    std::int64_t upload_ns = 0;

    explicit Stages(VirtualClock& c) : clock(c) {}
    void sample(FrameRecord& r) override { r.prepared_age = r.frame == disturbed_frame ? prepared_age : 1; }
    void select(FrameRecord& r) override {
        disturb(in_select, r);
        clock.advance(ms / 2);
    }
    void submit(FrameRecord& r) override {
        clock.advance(3 * ms);
        disturb(in_submit, r);
        if (r.frame == disturbed_frame) r.upload_ns = upload_ns;
    }
    void finish(FrameRecord& r) override {
        clock.advance(3 * ms);
        disturb(in_finish, r);
        r.rastered_ns = clock.now_ns();
    }
    void account(FrameRecord& r) override { disturb(in_account, r); }

private:
    static void disturb(const std::function<void()>& what, const FrameRecord& r) {
        if (what && r.frame == disturbed_frame) what();
    }
};

struct Walk {
    VirtualClock clock;
    Stages stages{clock};
    FrameLoopOptions options;
    FrameLoopResult result;

    std::vector<FrameRecord> run() {
        SpscRing<FrameRecord> ring(64);
        options.period_ns = options.t0_ns = 10 * ms;
        options.frames = 8;
        result = run_frame_loop(options, clock, stages, ring);
        EXPECT_EQ(result.run + result.skipped, result.elapsed);
        std::vector<FrameRecord> records;
        FrameRecord r;
        while (ring.try_pop(r)) records.push_back(r);
        EXPECT_EQ(records.size(), 8U);
        return records;
    }
    /// The disturbed frame is the only miss, with this cause.
    void expect_miss(Cause cause, bool own) {
        for (const FrameRecord& r : run()) {
            const bool here = r.frame == disturbed_frame;
            EXPECT_EQ(r.missed, here) << r.frame;
            EXPECT_EQ(r.cause, here ? cause : Cause::none) << cause_of(r);
            EXPECT_EQ(r.own_miss, here && own);
            EXPECT_EQ(r.skipped_before > 0, r.frame == disturbed_frame + 1);
        }
    }
};

TEST(LoopBlame, ACoreTakenInOwnCodeIsStolenAndNotOurs) {
    Walk walk;
    walk.stages.in_select = [&] { walk.clock.steal(20 * ms); };
    walk.expect_miss(Cause::stolen, false);
}

TEST(LoopBlame, ACoreTakenInADriverCallThatNeverSleptIsStolen) {
    Walk walk;
    walk.stages.in_submit = [&] { walk.clock.steal(20 * ms); };
    walk.expect_miss(Cause::stolen, false);
}

TEST(LoopBlame, ALongFenceIsTheRasterisersAndOurs) {
    Walk walk;
    walk.stages.in_finish = [&] { walk.clock.wait(20 * ms); };
    walk.expect_miss(Cause::raster, true);
}

TEST(LoopBlame, AnInvoluntarySwitchIsAPreemptionAndOurs) {
    Walk walk;
    walk.stages.in_select = [&] { walk.clock.preempt(20 * ms); };
    walk.expect_miss(Cause::preempted, true);
}

TEST(LoopBlame, WorkIsNeverCalledStolen) {
    Walk select, submit, raster;
    select.stages.in_select = [&] { select.clock.advance(20 * ms); };
    select.expect_miss(Cause::select, true);
    submit.stages.in_submit = [&] { submit.clock.advance(20 * ms); };
    submit.expect_miss(Cause::submit, true);
    raster.stages.in_finish = [&] { raster.clock.advance(20 * ms); };
    raster.expect_miss(Cause::raster, true);
}

TEST(LoopBlame, AThiefOfHalfAMillisecondDoesNotExcuseTwentyOfWork) {
    Walk walk;
    walk.stages.in_select = [&] { walk.clock.steal(ms / 2), walk.clock.advance(20 * ms); };
    walk.expect_miss(Cause::select, true);
}

TEST(LoopBlame, AnUploadIsSeparatedFromTheSubmissionAroundIt) {
    Walk walk;
    walk.stages.in_submit = [&] { walk.clock.advance(20 * ms); };
    walk.stages.upload_ns = 20 * ms;
    walk.expect_miss(Cause::upload, true);
}

TEST(LoopBlame, DrawingWhatNobodyChoseForThisFrameIsTheOldSetsDoing) {
    Walk walk;
    walk.stages.in_submit = [&] { walk.clock.advance(20 * ms); };
    walk.stages.prepared_age = 6;
    walk.expect_miss(Cause::prepared_too_old, true);
}

TEST(LoopBlame, AMajorFaultIsNamedThoughItLooksLikeAGap) {
    Walk walk;
    walk.stages.in_select = [&] { walk.clock.steal(20 * ms), walk.clock.fault(0, 1); };
    walk.expect_miss(Cause::page_fault, false);
}

TEST(LoopBlame, AStopAndContinueIsNeitherTheHostsNorOurs) {
    Walk walk;
    std::atomic<std::uint32_t> continued{7};
    walk.options.continued = &continued;
    walk.stages.in_select = [&] { walk.clock.steal(500 * ms), ++continued; };
    walk.expect_miss(Cause::stopped, false);
    EXPECT_EQ(walk.result.skipped, 50U);
}

/// The process is stopped for half a second where this clock is read: once, as soon as it is armed.
class StoppedWhileRead final : public Clock {
public:
    enum class Where : std::uint8_t { after_the_time, at_the_usage };
    StoppedWhileRead(VirtualClock& time, Where where) : time_(time), where_(where) {}

    [[nodiscard]] std::int64_t now_ns() const override {
        const std::int64_t now = time_.now_ns();
        if (where_ == Where::after_the_time) stop();
        return now;
    }
    [[nodiscard]] ThreadUsage usage() const override {
        if (where_ == Where::at_the_usage) stop();
        return time_.usage();
    }
    void sleep_until_ns(std::int64_t time_ns) override { time_.sleep_until_ns(time_ns); }
    void burn_ns(std::int64_t cpu_ns) override { time_.burn_ns(cpu_ns); }

    bool armed = false;
    mutable std::atomic<std::uint32_t> continued{0};

private:
    void stop() const {
        if (!armed || continued > 0) return;
        time_.steal(500 * ms);
        ++continued;
    }
    VirtualClock& time_;
    Where where_;
};

TEST(LoopBlame, AStopIsCountedInTheFrameThatItMakesLateWhereverItFalls) {
    using Where = StoppedWhileRead::Where;
    for (const Where where : {Where::after_the_time, Where::at_the_usage}) {
        VirtualClock time;
        StoppedWhileRead clock(time, where);
        Stages stages(time);
        stages.in_finish = [&] { clock.armed = true; };  // next the loop reads when the frame was presented, then the usage
        FrameLoopOptions options;
        options.period_ns = options.t0_ns = 10 * ms;
        options.frames = 8;
        options.continued = &clock.continued;
        SpscRing<FrameRecord> ring(64);
        run_frame_loop(options, clock, stages, ring);
        const std::uint64_t late = where == Where::after_the_time ? disturbed_frame : disturbed_frame + 1;
        FrameRecord r;
        while (ring.try_pop(r)) {
            EXPECT_EQ(r.missed, r.frame == late) << r.frame;
            EXPECT_EQ(r.continued, r.frame == late ? 1U : 0U) << r.frame;
            EXPECT_EQ(r.cause, r.frame == late ? Cause::stopped : Cause::none) << cause_of(r);
            EXPECT_FALSE(r.own_miss) << r.frame;
        }
    }
}

TEST(LoopBlame, ALateWakeUpIsOursOnlyWithoutFifo) {
    for (const bool fifo : {true, false}) {
        Walk walk;
        walk.options.limits.fifo = fifo;
        walk.clock.set_wake_lateness(6 * ms);
        for (const FrameRecord& r : walk.run()) {
            EXPECT_TRUE(r.missed);
            EXPECT_EQ(r.cause, Cause::woken_late);
            EXPECT_EQ(r.own_miss, !fifo);
        }
    }
}

TEST(Loop, FloatStartsAtOnceAfterALateFrameAndIsNotCalledWokenLate) {
    Walk walk;
    walk.options.late = LatePolicy::floating;
    walk.stages.in_submit = [&] { walk.clock.advance(5 * ms); };
    const auto records = walk.run();
    EXPECT_EQ(walk.result.skipped, 0U);
    EXPECT_EQ(records[4].slot, 4U);
    EXPECT_EQ(records[4].ready_ns, records[3].complete_ns);
    EXPECT_EQ(records[4].woken_ns, records[4].ready_ns);
    EXPECT_FALSE(records[4].missed) << "11.5 - 10 + 6.5 ms fit";
}

TEST(Loop, FaultsAndAllocationsOfTheAccountingStageAreOwnToo) {
    Walk walk;
    walk.stages.in_account = [&] {
        walk.clock.fault(5, 0);
        void* volatile memory = std::malloc(100);  // NOLINT: the violation under test
        std::free(memory);                         // NOLINT
    };
    const auto records = walk.run();
    EXPECT_EQ(records[4].minor_faults, 5U) << "faults between frames belong to the next";
    if (!guard_active()) GTEST_SKIP() << "allocations are not counted in sanitizer builds";
    EXPECT_EQ(records[3].guard_violations, 2U);
    for (const FrameRecord& r : records) {
        EXPECT_EQ(r.guard_violations, r.frame == 3 ? 2U : 0U) << r.frame;
    }
}

TEST(Loop, TheDriversFaultsAndAllocationsAreCountedApart) {
    Walk walk;
    walk.stages.in_finish = [&] {
        walk.clock.fault(160, 0);
        void* volatile memory = std::malloc(100);  // NOLINT: as a driver would
        std::free(memory);                         // NOLINT
    };
    const auto records = walk.run();
    EXPECT_EQ(records[3].driver_faults, 160U);
    EXPECT_EQ(records[3].minor_faults, 0U);
    if (!guard_active()) GTEST_SKIP() << "allocations are not counted in sanitizer builds";
    EXPECT_EQ(records[3].driver_allocations, 1U);
    EXPECT_EQ(records[3].guard_violations, 0U);
}

TEST(Loop, StopsOnRequestAndDropsRatherThanWaits) {
    VirtualClock clock;
    Stages stages(clock);
    std::atomic<bool> stop{false};
    stages.in_account = [&] { stop = true; };
    SpscRing<FrameRecord> ring(2);
    FrameLoopOptions options;
    options.period_ns = 10 * ms;
    options.stop = &stop;
    EXPECT_EQ(run_frame_loop(options, clock, stages, ring).run, 4U);
    EXPECT_EQ(ring.dropped(), 2U);
}

TEST(Loop, EndsWhenTheVisitorLeavesAndGoesOnWhereHeSteers) {
    VirtualClock clock;
    Stages stages(clock);
    SpscRing<FrameRecord> ring(64);
    FrameLoopOptions options;
    options.period_ns = 10 * ms;
    options.frames = 6;
    options.prolonged_frames = 9;
    std::atomic<bool> prolonged{false}, left{false};
    options.prolonged = &prolonged;
    options.left = &left;
    EXPECT_EQ(run_frame_loop(options, clock, stages, ring).run, 6U) << "nobody steered";
    prolonged = true;
    EXPECT_EQ(run_frame_loop(options, clock, stages, ring).run, 9U);
    stages.in_account = [&] { left = true; };
    EXPECT_EQ(run_frame_loop(options, clock, stages, ring).run, 4U);
}

TEST(WaitEstimate, AnOrdinaryWaitIsKnownAndATheftFromTheRasterisersIsNot) {
    WaitEstimate estimate;
    const ThreadClocks::Spent spent{8 * ms, 5 * ms};
    EXPECT_EQ(estimate.known_ns(6 * ms, spent, true), 6 * ms) << "unlearned: up to the sum";
    for (int i = 0; i < 15; ++i) estimate.update(6 * ms, spent);
    EXPECT_EQ(estimate.known_ns(6 * ms, spent, true), 6 * ms);
    EXPECT_EQ(estimate.known_ns(56 * ms, spent, true), 6 * ms);
    for (int i = 0; i < 3; ++i) estimate.update(56 * ms, spent);
    EXPECT_EQ(estimate.known_ns(56 * ms, spent, true), 6 * ms) << "three disturbed frames in fifteen teach nothing";
    EXPECT_EQ(estimate.known_ns(12 * ms, {16 * ms, 10 * ms}, true), 12 * ms) << "twice the work may take twice the wait";
    for (int i = 0; i < 15; ++i) estimate.update(50 * ms, spent);
    EXPECT_EQ(estimate.known_ns(50 * ms, spent, true), 8 * ms) << "never more than all rasterisers together worked";
}

TEST(WaitEstimate, WithoutRasterisersOnlySleepingIsAWait) {
    const WaitEstimate estimate;
    EXPECT_EQ(estimate.known_ns(6 * ms, {}, true), 6 * ms);
    EXPECT_EQ(estimate.known_ns(6 * ms, {}, false), 0);
    EXPECT_EQ(estimate.known_ns(-5, {}, true), 0);
}

}  // namespace
}  // namespace surefoot::rt
