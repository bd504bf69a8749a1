// A recorded visitor on the machine's own clock: the input thread in its place, ten thousand reports none lost, and their age.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/placement.hpp"
#include "tests/walk/steered_fixture.hpp"

namespace surefoot {
namespace {

using test::GamepadSession;

constexpr std::int64_t period_ns = 33'333'333;

const rt::CensusRow* row(const report::WalkSummary& s, const std::string& name) {
    const auto found = std::find_if(s.threads.begin(), s.threads.end(), [&](const auto& t) { return t.name == name; });
    return found == s.threads.end() ? nullptr : &*found;
}

/// Frames whose pose lacks a report that was due two milliseconds before they woke.
std::size_t frames_behind(const walk::WalkOutcome& outcome) {
    static const GamepadSession session = test::ten_thousand_events();
    const auto& reports = session.recording().reports;
    const std::int64_t start_ns =
        outcome.records.front().due_ns - static_cast<std::int64_t>(outcome.records.front().slot) * period_ns;
    std::size_t behind = 0;
    for (const rt::FrameRecord& r : outcome.records) {
        const auto due = std::count_if(reports.begin(), reports.end(),
                                       [&](const auto& e) { return start_ns + e.time_us * 1000 < r.woken_ns - 2'000'000; });
        behind += r.input_reports < static_cast<std::uint64_t>(due) ? 1 : 0;
    }
    return behind;
}

/// By its own account (/proc/stat), more than a hundredth of the walk's time.
bool host_stole(const walk::WalkOutcome& outcome) {
    return outcome.summary.steal_ms * 1e6 > 0.01 * static_cast<double>(outcome.records.size()) * static_cast<double>(period_ns);
}

/// Ten thousand reports, each shown once and none before it came, whatever the host did meanwhile.
void expect_lossless(const walk::WalkOutcome& outcome) {
    const report::InputSummary& in = outcome.summary.input;
    EXPECT_EQ(in.reports + in.refused, 10'000U) << "read once each";
    EXPECT_EQ(in.refused, 0U);
    EXPECT_EQ(in.reports_shown, 10'000U);
    std::uint64_t before = 0;
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_GE(r.input_reports, before);
        EXPECT_LE(r.input_stamp_ns, r.submitted_ns);
        before = r.input_reports;
    }
    EXPECT_EQ(outcome.summary.guard_violations, 0U);
    EXPECT_EQ(in.guard_violations, 0U);
    EXPECT_TRUE(in.walked);
}

TEST(SteeredRealWalk, TenThousandReportsReachTheirFramesInTimeThroughTheInputThread) {
    if (!rt::guard_active()) GTEST_SKIP() << "a sanitizer build: times are not its own, and allocations are not guarded";
    if (rt::probe_capabilities(80).fifo_priority < 80)
        GTEST_SKIP() << "SCHED_FIFO 80 is refused here: run as root or with RLIMIT_RTPRIO";
    walk::WalkRequest request = test::steered_request(test::ten_thousand_events(), "real-events");
    request.clock = rt::ClockKind::real;
    request.walking = rt::WalkingMode::automatic;  // on foot: walls and floors are asked at each step
    walk::WalkOutcome outcome = test::walk(request);
    expect_lossless(outcome);
    // A host that steals from the input thread delays reports too: then it is walked again, up to twice.
    for (int again = 0; again < 2 && frames_behind(outcome) > outcome.records.size() / 50 && host_stole(outcome); ++again) {
        std::printf("%zu frames behind, and the host stole %.0f ms: once more\n", frames_behind(outcome),
                    outcome.summary.steal_ms);
        outcome = test::walk(request);
        expect_lossless(outcome);
    }
    const report::WalkSummary& s = outcome.summary;
    const report::InputSummary& in = s.input;
    EXPECT_LE(frames_behind(outcome), outcome.records.size() / 50) << "of " << outcome.records.size() << " frames";
    EXPECT_TRUE(s.census_problems.empty()) << s.census_problems.front();
    const rt::CensusRow *input = row(s, "sf-input"), *frame = row(s, "sf-frame");
    ASSERT_TRUE(input != nullptr && frame != nullptr) << "the census has no such thread";
    EXPECT_EQ(input->policy, rt::Policy::fifo);
    EXPECT_LT(input->priority, frame->priority);

    // What the host steals from the frame thread's wake-ups shows in the reports' ages too: that much is allowed for.
    const double period_ms = 1000.0 / 30, wake_ms = s.wake_us.p99 * 1e-3;
    std::printf("report to submit: p50 %.1f ms, p99 %.1f, at most %.1f; wake-up p99 %.2f ms\n", in.age_ms.p50, in.age_ms.p99,
                in.age_ms.max, wake_ms);
    EXPECT_LE(in.age_ms.p50, 1.5 * period_ms);
    EXPECT_LE(in.age_ms.p99, 2 * period_ms + wake_ms);
    std::printf("report to picture shown: p50 %.1f ms, p99 %.1f, at most %.1f\n", in.to_shown_ms.p50, in.to_shown_ms.p99,
                in.to_shown_ms.max);
    EXPECT_LE(in.to_shown_ms.p50, 2 * period_ms);
    EXPECT_LE(in.to_shown_ms.p99, 100);
}

TEST(SteeredRealWalk, ReportsAreShownWithinTwoPeriodsAtSixtyHertz) {
    if (!rt::guard_active()) GTEST_SKIP() << "a sanitizer build: times are not its own";
    if (rt::probe_capabilities(80).fifo_priority < 80)
        GTEST_SKIP() << "SCHED_FIFO 80 is refused here: run as root or with RLIMIT_RTPRIO";
    walk::WalkRequest request = test::steered_request(test::ten_thousand_events(), "real-events-60");
    request.clock = rt::ClockKind::real;
    request.rate_hz = 60;
    const report::InputSummary in = test::walk(request).summary.input;
    std::printf("report to picture shown at 60 Hz: p50 %.1f ms, p99 %.1f, at most %.1f\n", in.to_shown_ms.p50, in.to_shown_ms.p99,
                in.to_shown_ms.max);
    EXPECT_GT(in.reports_shown, 9'000U);
    EXPECT_LE(in.to_shown_ms.p50, 2 * 1000.0 / 60);
    EXPECT_LE(in.to_shown_ms.p99, 100);
}

TEST(SteeredRealWalk, AViewpointIsPreparedBeforeItIsShown) {
    if (!rt::guard_active()) GTEST_SKIP() << "a sanitizer build: times are not its own";
    if (rt::probe_capabilities(80).fifo_priority < 80)
        GTEST_SKIP() << "SCHED_FIFO 80 is refused here: run as root or with RLIMIT_RTPRIO";
    constexpr int presses = 16;
    GamepadSession session;
    session.report({});
    for (int i = 0; i < presses; ++i) session.press(GamepadSession::next_viewpoint).hold({}, 0.007 * i);
    walk::WalkRequest request = test::steered_request(session, "real-viewpoints");
    request.clock = rt::ClockKind::real;
    const walk::WalkOutcome outcome = test::walk(request);
    EXPECT_EQ(outcome.summary.input.jumps, static_cast<std::uint64_t>(presses));
    int coarse = 0;
    for (const rt::FrameRecord& r : outcome.records) coarse += r.candidates == 0 ? 1 : 0;
    // A press just before a frame begins comes too late for it; the others do not.
    EXPECT_LE(coarse, presses / 2);
    std::printf("drawn coarse: %d frames of %zu, %d presses\n", coarse, outcome.records.size(), presses);
}

}  // namespace
}  // namespace surefoot
