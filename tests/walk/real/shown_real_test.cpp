// When pictures are shown, on the machine's own clock and without a display: against a bare loop's wake-ups in the same walk, and
// with a display that makes 50 frames wait.
#include <gtest/gtest.h>

#include <time.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "rt/base/statistics.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

walk::WalkRequest real_request(std::uint64_t frames) {
    walk::WalkRequest request = test::Forest::get().virtual_request(frames);
    request.clock = rt::ClockKind::real;
    request.rate_hz = 30;
    request.backend = "egl";  // real costs, so that corrections are of something
    request.width = 480;
    request.height = 270;
    return request;
}

double off_grid_us(const rt::FrameRecord& r) { return std::abs(static_cast<double>(r.handed_ns - r.show_ns)) * 1e-3; }

TEST(ShownPictures, AreAsNearToTheGridAsABareLoopsWakeUps) {
    walk::WalkRequest request = real_request(0);
    request.control = true;
    request.control_pairs = 10;  // of two seconds: 600 frames of each
    const auto outcome = walk::run_walk(request, {}, {});
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    std::vector<double> walk_us, bare_us;
    std::set<std::int64_t> intervals;
    const rt::FrameRecord* before = nullptr;
    for (const rt::FrameRecord& r : outcome->records) {
        (r.control ? bare_us : walk_us).push_back(off_grid_us(r));
        EXPECT_EQ(r.shown_by, r.control ? rt::ShownBy::nothing : rt::ShownBy::hand_over);
        EXPECT_GE(r.handed_ns, r.show_ns) << "no picture is early: presenting takes no time here";
        if (before != nullptr && !before->control && !r.control && r.slot == before->slot + 1)
            intervals.insert(r.shown_ns - before->shown_ns);
        before = &r;
    }
    EXPECT_GT(walk_us.size(), 500U);
    const Quantiles shown = quantiles(walk_us), woken = quantiles(bare_us);
    RecordProperty("shown_p99_us", std::to_string(shown.p99));
    RecordProperty("bare_p99_us", std::to_string(woken.p99));
    EXPECT_LE(shown.p99, woken.p99 + 100) << "p50 " << shown.p50 << " against " << woken.p50 << " us";
    EXPECT_GT(intervals.size(), 100U) << "what is measured is not all equal";
    // The summary says the same.
    EXPECT_EQ(outcome->summary.shown.by, rt::ShownBy::hand_over);
    EXPECT_NEAR(outcome->summary.shown.error_us.p50, shown.p50, 20);
    EXPECT_NEAR(outcome->summary.shown.interval_ms.p50, 1000.0 / 30, 0.2);
}

TEST(ShownPictures, ADisplayThatWaitsIsTheCauseAndThePictureStaysAsFine) {
    constexpr std::uint64_t apart = 12;
    const auto waits_in = [](std::uint64_t frame) { return frame % apart == apart / 2; };
    const auto plain = walk::run_walk(real_request(660), {}, {});
    ASSERT_TRUE(plain.ok()) << plain.error().text();
    walk::WalkObserver observer;
    observer.inject = [&](walk::FramePhase phase, const rt::FrameRecord& frame) {
        if (phase != walk::FramePhase::present || !waits_in(frame.frame)) return walk::Fault::none;
        const timespec wait{0, 10'000'000};
        (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &wait, nullptr);  // the display that is injected
        return walk::Fault::none;
    };
    const auto waiting = walk::run_walk(real_request(600), {}, observer);
    ASSERT_TRUE(waiting.ok()) << waiting.error().text();

    std::map<std::uint64_t, const rt::FrameRecord*> at_slot;  // so at the same poses
    for (const rt::FrameRecord& r : plain->records) at_slot[r.slot] = &r;
    std::uint64_t named = 0;
    double triangles = 0, plain_triangles = 0, corrections = 0, plain_corrections = 0;
    std::vector<double> of_waiting, of_others;  // actual by predicted time, without correction
    for (const rt::FrameRecord& r : waiting->records) {
        named += waits_in(r.frame) && r.missed && r.cause == rt::Cause::present ? 1 : 0;
        const double ratio = double{r.actual_us} / (double{r.predicted_us} / double{r.correction});
        if (waits_in(r.frame)) of_waiting.push_back(ratio);
        if (waits_in(r.frame + 1) || waits_in(r.frame + 2)) of_others.push_back(ratio);
        if (!at_slot.contains(r.slot)) continue;
        triangles += static_cast<double>(r.triangles), plain_triangles += static_cast<double>(at_slot[r.slot]->triangles);
        corrections += double{r.correction}, plain_corrections += double{at_slot[r.slot]->correction};
    }
    EXPECT_EQ(named, 50U);
    EXPECT_EQ(of_waiting.size(), 50U);
    EXPECT_NEAR(triangles / plain_triangles, 1, 0.02);
    // The wait is no cost of its frame: it would double it. Single walks differ by 3 %, and the frame after an idle slot costs
    // more.
    EXPECT_NEAR(quantiles(of_waiting).p50 / quantiles(of_others).p50, 1, 0.1);
    std::printf("corrections %.3f of those without waits\n", corrections / plain_corrections);
    EXPECT_NEAR(corrections / plain_corrections, 1, 0.1);
}

}  // namespace
}  // namespace surefoot
