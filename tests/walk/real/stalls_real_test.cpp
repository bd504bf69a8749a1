// Nothing hidden, live: stalls injected into the frame thread of a walk on the machine's own clock, and what the figures say of
// them.
#include <gtest/gtest.h>

#include <time.h>

#include <memory>

#include "rt/monitor/telemetry.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

TEST(MonitoredWalk, TwentyInjectedStallsOfFiftyMillisecondsAreThereInFull) {
    constexpr std::uint64_t stalls = 20;
    constexpr std::int64_t stall_ns = 50'000'000;
    walk::WalkRequest request = test::Forest::get().virtual_request(300);
    request.clock = rt::ClockKind::real;
    request.rate_hz = 60;

    const auto telemetry = std::make_unique<rt::Telemetry>();
    telemetry->begin({*rt::period_of_rate_ns(request.rate_hz), rt::LatePolicy::lock, 1});
    std::uint64_t injected = 0, skipped_after = 0, first_slot = 0, last_slot = 0, late_in_full = 0;
    bool stalled = false;
    walk::WalkObserver observer;
    observer.inject = [&](walk::FramePhase phase, const rt::FrameRecord& frame) {
        if (phase == walk::FramePhase::select && frame.frame >= 30 && frame.frame % 12 == 0 && injected < stalls) {
            const timespec stall{0, stall_ns};
            (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &stall, nullptr);  // the stall that is injected
            ++injected;
        }
        return walk::Fault::none;
    };
    observer.on_record = [&](const rt::FrameRecord& frame) {
        if (frame.frame == 0) first_slot = frame.slot;
        last_slot = frame.slot;
        skipped_after += stalled ? frame.skipped_before : 0;
        stalled = frame.selected_ns - frame.woken_ns >= stall_ns;
        late_in_full += stalled && frame.complete_ns - frame.due_ns >= stall_ns ? 1 : 0;
        telemetry->add(frame);
    };
    const auto outcome = walk::run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();

    const rt::Figures& f = telemetry->figures();
    const rt::Histogram& select = f.of(rt::Series::select).fine;
    ASSERT_EQ(injected, stalls);
    EXPECT_GE(select.count() - select.count_at_most(stall_ns * 9 / 10), stalls) << "each in its phase's histogram, at its length";
    EXPECT_GE(late_in_full, stalls) << "no frame is said to be shorter than its stall";
    EXPECT_GE(skipped_after, 2 * stalls) << "50 ms at 60 Hz run over two slots at the least";
    EXPECT_GE(f.all_misses(), stalls);
    // And the accounts close: every slot is in one place, and it is the walk's own count.
    EXPECT_EQ(f.frames, 300U);
    EXPECT_EQ(f.lost_slots, 0U);
    EXPECT_EQ(f.skipped_slots, outcome->summary.skipped);
    EXPECT_EQ(f.all_misses(), outcome->summary.misses);
    EXPECT_EQ(f.frames + f.skipped_slots, last_slot - first_slot + 1);
    EXPECT_EQ(f.of(rt::Series::slack).fine.count() + f.of(rt::Series::lateness).fine.count(), f.slots());
    EXPECT_EQ(f.of(rt::Series::lateness).fine.count(), f.all_misses() + f.skipped_slots);
}

}  // namespace
}  // namespace surefoot
