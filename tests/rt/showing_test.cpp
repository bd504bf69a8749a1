// The frame loop on injected time shows pictures: when they are handed over, when they count as late, and which cause that has.
#include "rt/frame/loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "rt/exchange/spsc_ring.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

constexpr std::uint64_t waiting_frame = 3;
constexpr std::int64_t slot_ns = 10 * ms;

/// Frames of 6 ms in a period of 10; presenting takes what it is told.
class ShownStages final : public FrameStages {
public:
    explicit ShownStages(VirtualClock& c) : clock(c) {}
    VirtualClock& clock;
    std::function<void(const FrameRecord&)> in_submit, in_account, in_present;
    std::vector<std::uint64_t> late;
    Shown shown{ShownBy::hand_over, 0};

    void sample(FrameRecord&) override {}
    void select(FrameRecord&) override { clock.advance(ms); }
    void submit(FrameRecord& r) override {
        clock.advance(5 * ms);
        if (in_submit) in_submit(r);
    }
    void finish(FrameRecord&) override {}
    void account(FrameRecord& r) override {
        if (in_account) in_account(r);
    }
    Shown present(FrameRecord& r) override {
        if (in_present) in_present(r);
        return shown;
    }
    void shown_late(const FrameRecord& r) override { late.push_back(r.frame); }
};

struct ShownWalk {
    VirtualClock clock;
    ShownStages stages{clock};
    FrameLoopOptions options;
    FrameLoopResult result;

    ShownWalk() {
        options.shows = true;
        options.period_ns = options.t0_ns = slot_ns;
        options.frames = 8;
    }
    std::vector<FrameRecord> run() {
        SpscRing<FrameRecord> ring(256);
        result = run_frame_loop(options, clock, stages, ring);
        EXPECT_EQ(result.run + result.skipped, result.elapsed);
        std::vector<FrameRecord> records;
        FrameRecord r;
        while (ring.try_pop(r)) records.push_back(r);
        EXPECT_EQ(records.size(), result.run);
        return records;
    }
    /// Only the waiting frame is late, for this cause; the slots that it runs over are skipped, and the next frame has a whole
    /// one.
    void expect_late(Cause cause, bool own) {
        for (const FrameRecord& r : run()) {
            const bool here = r.frame == waiting_frame;
            EXPECT_EQ(r.missed, here) << r.frame;
            EXPECT_EQ(r.cause, here ? cause : Cause::none) << r.frame << ": " << cause_of(r);
            EXPECT_EQ(r.own_miss, here && own) << r.frame;
            EXPECT_EQ(r.skipped_before, r.frame == waiting_frame + 1 ? 1U : 0U) << r.frame;
            EXPECT_EQ(r.complete_ns - r.due_ns, 6 * ms) << r.frame;
        }
        EXPECT_EQ(stages.late, std::vector<std::uint64_t>{waiting_frame}) << "it can be examined";
    }
};

auto in_waiting_frame(const std::function<void()>& what) {
    return [what](const FrameRecord& r) {
        if (r.frame == waiting_frame) what();
    };
}

TEST(Showing, LockHoldsAPictureUntilItsPointOfTheGrid) {
    ShownWalk walk;
    for (const FrameRecord& r : walk.run()) {
        EXPECT_EQ(r.complete_ns, r.due_ns + 6 * ms);
        EXPECT_EQ(r.show_ns, r.due_ns + slot_ns);
        EXPECT_EQ(r.handed_ns, r.show_ns);
        EXPECT_EQ(r.shown_ns, r.show_ns);
        EXPECT_EQ(r.shown_by, ShownBy::hand_over);
        EXPECT_FALSE(r.missed);
    }
}

TEST(Showing, FloatShowsAsSoonAsThePictureIsWhole) {
    ShownWalk walk;
    walk.options.late = LatePolicy::floating;
    for (const FrameRecord& r : walk.run()) {
        EXPECT_EQ(r.shown_ns, r.due_ns + 6 * ms);
        EXPECT_FALSE(r.missed);
    }
    EXPECT_EQ(walk.result.skipped, 0U);
}

TEST(Showing, FloatMayPresentUntilTheEndOfTheSlot) {
    ShownWalk walk;
    walk.options.late = LatePolicy::floating;
    walk.stages.in_present = [&](const FrameRecord& r) { walk.clock.wait(r.frame == waiting_frame ? 5 * ms : 3 * ms); };
    for (const FrameRecord& r : walk.run()) {
        if (r.frame > waiting_frame) continue;
        EXPECT_EQ(r.missed, r.frame == waiting_frame) << r.frame;
        EXPECT_EQ(r.shown_ns, r.due_ns + (r.frame == waiting_frame ? 11 : 9) * ms);
    }
}

TEST(Showing, ALatePictureIsShownOnTheNextPointOfTheGrid) {
    ShownWalk walk;
    walk.stages.in_submit = in_waiting_frame([&] { walk.clock.advance(7 * ms); });
    for (const FrameRecord& r : walk.run()) {
        const bool late = r.frame == waiting_frame;
        EXPECT_EQ(r.missed, late);
        EXPECT_EQ(r.shown_ns, r.due_ns + (late ? 2 : 1) * slot_ns) << r.frame;
        EXPECT_EQ(r.cause, late ? Cause::submit : Cause::none);
    }
    EXPECT_EQ(walk.result.skipped, 1U);
}

TEST(Showing, ADisplayThatWaitsIsTheCauseAndTakesNothingFromTheNextFrame) {
    ShownWalk walk;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.wait(4 * ms); });
    walk.expect_late(Cause::present, true);
}

TEST(Showing, WorkOfThePresentingDriverIsPresentToo) {
    ShownWalk walk;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.advance(4 * ms); });
    walk.expect_late(Cause::present, true);
}

TEST(Showing, ACoreTakenWhilePresentingIsStolenAndNotOurs) {
    ShownWalk walk;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.steal(4 * ms); });
    walk.expect_late(Cause::stolen, false);
}

TEST(Showing, AnotherThreadWhilePresentingIsAPreemptionAndOurs) {
    ShownWalk walk;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.preempt(4 * ms); });
    walk.expect_late(Cause::preempted, true);
}

TEST(Showing, ALateWakeUpForThePictureIsOursOnlyWithoutFifo) {
    for (const bool fifo : {true, false}) {
        ShownWalk walk;
        walk.options.limits.fifo = fifo;
        walk.stages.in_submit = in_waiting_frame([&] { walk.clock.set_wake_lateness(4 * ms); });
        walk.stages.in_present = [&](const FrameRecord&) { walk.clock.set_wake_lateness(0); };
        walk.expect_late(Cause::woken_late, !fifo);
    }
}

TEST(Showing, AStopOfTheProcessWhilePresentingIsNamed) {
    ShownWalk walk;
    std::atomic<std::uint32_t> continued{0};
    walk.options.continued = &continued;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.steal(4 * ms), ++continued; });
    walk.expect_late(Cause::stopped, false);
}

TEST(Showing, ATwentiethOfThePeriodIsTolerated) {
    ShownWalk walk;
    walk.stages.in_present = in_waiting_frame([&] { walk.clock.wait(ms / 2); });
    for (const FrameRecord& r : walk.run()) {
        EXPECT_FALSE(r.missed) << r.frame;
        EXPECT_EQ(r.shown_ns, r.show_ns + (r.frame == waiting_frame ? ms / 2 : 0));
        // The next frame begins when presenting is over, and is not called woken late for it.
        EXPECT_EQ(r.ready_ns, r.due_ns + (r.frame == waiting_frame + 1 ? ms / 2 : 0)) << r.frame;
        EXPECT_EQ(r.woken_ns, r.ready_ns);
    }
}

TEST(Showing, WhatPresentingUsuallyTakesIsHandedOverEarlier) {
    ShownWalk walk;
    walk.options.frames = 40;
    walk.stages.in_present = [&](const FrameRecord&) { walk.clock.advance(ms / 4); };
    const auto records = walk.run();
    EXPECT_EQ(records.front().shown_ns, records.front().due_ns + slot_ns + ms / 4) << "not known yet";
    for (const FrameRecord& r : records) {
        EXPECT_FALSE(r.missed) << r.frame;
        if (r.frame < 20) continue;
        EXPECT_EQ(r.deadline_ns, r.due_ns + slot_ns - ms / 4);
        EXPECT_EQ(r.handed_ns, r.deadline_ns);
        EXPECT_EQ(r.shown_ns, r.due_ns + slot_ns) << "on the grid";
        EXPECT_EQ(r.woken_ns, r.due_ns);
    }
}

TEST(Showing, ALeadIsAtMostAQuarterOfThePeriod) {
    ShownWalk walk;
    walk.options.frames = 40;
    walk.stages.in_present = [&](const FrameRecord&) { walk.clock.advance(4 * ms); };
    const FrameRecord last = walk.run().back();
    EXPECT_EQ(last.deadline_ns, last.due_ns + slot_ns - slot_ns / 4);
    EXPECT_EQ(last.cause, Cause::present);
}

/// Where presenting takes its usual time, what delays a picture is what came before.
TEST(Showing, UsualPresentingIsNotBlamedForWhatDelaysIt) {
    struct Case {
        Cause cause;
        bool own;
        std::function<void(ShownWalk&)> in_account, in_submit;
    };
    const std::vector<Case> cases = {
        {Cause::woken_late, false, {}, [](ShownWalk& w) { w.clock.set_wake_lateness(ms); }},
        {Cause::stolen, false, [](ShownWalk& w) { w.clock.steal(5 * ms); }, {}},
        {Cause::preempted, true, [](ShownWalk& w) { w.clock.preempt(5 * ms); }, {}},
        {Cause::present, true, [](ShownWalk& w) { w.clock.advance(5 * ms); }, {}},
    };
    constexpr std::uint64_t delayed = 30;
    for (const Case& c : cases) {
        ShownWalk walk;
        walk.options.frames = 40;
        walk.stages.in_present = [&](const FrameRecord&) {
            walk.clock.set_wake_lateness(0);
            walk.clock.advance(ms);
        };
        walk.stages.in_account = [&](const FrameRecord& r) {
            if (r.frame == delayed && c.in_account) c.in_account(walk);
        };
        walk.stages.in_submit = [&](const FrameRecord& r) {
            if (r.frame == delayed && c.in_submit) c.in_submit(walk);
        };
        for (const FrameRecord& r : walk.run()) {
            if (r.frame < 20) continue;  // the lead is learnt
            EXPECT_EQ(r.missed, r.frame == delayed) << r.frame;
            EXPECT_EQ(r.cause, r.frame == delayed ? c.cause : Cause::none) << cause_of(r);
            EXPECT_EQ(r.own_miss, r.frame == delayed && c.own) << cause_of(r);
        }
    }
}

TEST(Showing, WhatTheDisplayTellsIsKept) {
    ShownWalk walk;
    walk.stages.shown = {ShownBy::display, 12'345};
    for (const FrameRecord& r : walk.run()) {
        EXPECT_EQ(r.shown_by, ShownBy::display);
        EXPECT_EQ(r.shown_ns, 12'345);
    }
    walk.stages.shown = {};
    for (const FrameRecord& r : walk.run()) {
        EXPECT_EQ(r.shown_by, ShownBy::nothing);
        EXPECT_EQ(r.shown_ns, 0);
    }
}

TEST(Showing, BareFramesWaitForTheSamePointAndAreJudgedAlike) {
    ShownWalk walk;
    const ControlSchedule control{4, 2};
    walk.options.control = &control;
    walk.options.frames = 0;
    walk.clock.set_wake_lateness(2 * ms);
    std::uint64_t bare = 0, late = 0;
    for (const FrameRecord& r : walk.run()) {
        if (!r.control) continue;
        ++bare;
        late += r.missed ? 1 : 0;
        EXPECT_EQ(r.shown_by, ShownBy::nothing);
        EXPECT_EQ(r.handed_ns, r.show_ns + 2 * ms);
        EXPECT_EQ(r.cause, Cause::woken_late) << cause_of(r);
    }
    EXPECT_GT(bare, 2U);
    EXPECT_EQ(late, bare);
}

TEST(Showing, WhereNothingIsPresentedAFrameEndsWhenItIsWhole) {
    ShownWalk walk;
    walk.options.shows = false;
    walk.stages.in_present = [](const FrameRecord&) { FAIL() << "not called"; };
    for (const FrameRecord& r : walk.run()) {
        EXPECT_EQ(r.show_ns, 0);
        EXPECT_EQ(r.handed_ns, 0);
        EXPECT_EQ(r.shown_by, ShownBy::nothing);
        EXPECT_EQ(r.deadline_ns, r.due_ns + slot_ns);
    }
}

}  // namespace
}  // namespace surefoot::rt
