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
    constexpr std::uint64_t waits = 50;
    const auto plain = walk::run_walk(real_request(660), {}, {});
    ASSERT_TRUE(plain.ok()) << plain.error().text();
    std::set<std::uint64_t> waited;
    walk::WalkObserver observer;
    observer.inject = [&](walk::FramePhase phase, const rt::FrameRecord& frame) {
        if (phase != walk::FramePhase::present || frame.frame % 12 != 6 || waited.size() == waits) return walk::Fault::none;
        const timespec wait{0, 10'000'000};
        (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &wait, nullptr);  // the display that is injected
        waited.insert(frame.frame);
        return walk::Fault::none;
    };
    const auto waiting = walk::run_walk(real_request(600), {}, observer);
    ASSERT_TRUE(waiting.ok()) << waiting.error().text();
    ASSERT_EQ(waited.size(), waits);
    std::uint64_t named = 0;
    for (const rt::FrameRecord& r : waiting->records)
        named += waited.contains(r.frame) && r.missed && r.cause == rt::Cause::present ? 1 : 0;
    EXPECT_EQ(named, waits);
    // Slot by slot, so at the same poses.
    std::map<std::uint64_t, const rt::FrameRecord*> at_slot;
    for (const rt::FrameRecord& r : plain->records) at_slot[r.slot] = &r;
    double corrections = 0, plain_corrections = 0, triangles = 0, plain_triangles = 0;
    for (const rt::FrameRecord& r : waiting->records) {
        if (!at_slot.contains(r.slot)) continue;
        corrections += double{r.correction}, plain_corrections += double{at_slot[r.slot]->correction};
        triangles += static_cast<double>(r.triangles), plain_triangles += static_cast<double>(at_slot[r.slot]->triangles);
    }
    EXPECT_GT(corrections / static_cast<double>(waiting->records.size()), 0.26) << "not at the bound, where it could not change";
    EXPECT_NEAR(corrections / plain_corrections, 1, 0.02);
    EXPECT_NEAR(triangles / plain_triangles, 1, 0.02);
}

}  // namespace
}  // namespace surefoot
