// A walk on the machine's own clock before a display with a clock of its own, 50 parts in a million off: each picture is shown by
// its own refresh. SUREFOOT_DISPLAY_SECONDS sets how long each rate is walked.
#include <gtest/gtest.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"
#include "tests/rt/paced_display.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

constexpr std::int64_t refresh_60_ns = 16'666'667;

double seconds_a_rate() {
    const char* const wanted = std::getenv("SUREFOOT_DISPLAY_SECONDS");
    return wanted != nullptr ? std::atof(wanted) : 20;
}

class PacedDisplayWalk : public ::testing::TestWithParam<double> {};

TEST_P(PacedDisplayWalk, ShowsEachPictureByItsOwnRefresh) {
    const double rate_hz = GetParam();
    const auto frames = static_cast<std::uint64_t>(rate_hz * seconds_a_rate());
    walk::WalkRequest request = test::Forest::get().virtual_request(frames);
    request.clock = rt::ClockKind::real;
    request.rate_hz = rate_hz;

    const rt::RealClock clock;
    test::PacedDisplay paced;
    paced.refresh_ns = static_cast<double>(refresh_60_ns) * (1 + 50e-6);
    paced.first_ns = static_cast<double>(clock.now_ns());
    std::vector<std::int64_t> shown_at;
    shown_at.reserve(frames);
    walk::TestDisplay display;
    display.refreshes = {refresh_60_ns, static_cast<std::int64_t>(paced.first_ns)};
    display.present = [&](const rt::FrameRecord& r) {
        shown_at.push_back(paced.shows(r.handed_ns));
        const std::int64_t shown_ns = paced.at_ns(shown_at.back());
        const timespec until{shown_ns / 1'000'000'000, shown_ns % 1'000'000'000};
        (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        return rt::Shown{rt::ShownBy::display, shown_ns};
    };
    walk::WalkObserver observer;
    observer.display = &display;
    const auto outcome = walk::run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    ASSERT_EQ(outcome->records.size(), frames);

    // Picture k by refresh n k + c, of its slot; a late one by a later refresh. c is that of most pictures.
    const auto per_slot = static_cast<std::int64_t>(60 / rate_hz + 0.5);
    std::map<std::int64_t, std::uint64_t> phases;
    for (const rt::FrameRecord& r : outcome->records) ++phases[shown_at[r.frame] - per_slot * static_cast<std::int64_t>(r.slot)];
    const std::int64_t phase =
        std::max_element(phases.begin(), phases.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
    std::uint64_t late = 0, own = 0;
    for (const rt::FrameRecord& r : outcome->records) {
        const std::int64_t off = shown_at[r.frame] - phase - per_slot * static_cast<std::int64_t>(r.slot);
        late += off != 0 ? 1 : 0;
        own += r.own_miss ? 1 : 0;
        EXPECT_TRUE(off == 0 || (off > 0 && r.missed)) << "frame " << r.frame << " is " << off << " refreshes late, and no miss";
        EXPECT_EQ(r.shown_by, rt::ShownBy::display);
    }
    RecordProperty("late", std::to_string(late));
    std::printf("%.0f Hz: %llu of %llu pictures by another refresh than planned, %llu own; off the grid p99 %.1f us\n", rate_hz,
                static_cast<unsigned long long>(late), static_cast<unsigned long long>(frames),
                static_cast<unsigned long long>(own), outcome->summary.shown.error_us.p99);
    EXPECT_LE(own, 2 + frames / 900) << "two of 1800, and two for a walk as short as this";
    EXPECT_LE(late * 100, frames);
    EXPECT_EQ(outcome->summary.shown.by, rt::ShownBy::display);
    // No drift: the last pictures are as near to the grid as the first ones.
    const auto off_us = [&](std::size_t from, std::size_t count) {
        std::vector<double> all;
        for (std::size_t i = from; i < from + count; ++i)
            all.push_back(std::abs(static_cast<double>(outcome->records[i].shown_ns - outcome->records[i].show_ns)) * 1e-3);
        return quantiles(all).p50;
    };
    EXPECT_LT(off_us(frames / 10, 100), 50);
    EXPECT_LT(off_us(frames - 100, 100), 50);
}

INSTANTIATE_TEST_SUITE_P(At, PacedDisplayWalk, ::testing::Values(60.0, 30.0, 20.0));

TEST(PacedDisplayWalks, ARateThatDoesNotDivideTheDisplaysIsRefused) {
    walk::WalkRequest request = test::Forest::get().virtual_request(10);
    request.clock = rt::ClockKind::real;
    request.rate_hz = 25;
    walk::TestDisplay display;
    display.refreshes = {refresh_60_ns, 0};
    walk::WalkObserver observer;
    observer.display = &display;
    const auto refused = walk::run_walk(request, {}, observer);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().text().find("60, 30, 20 or 15 Hz"), std::string::npos) << refused.error().text();
}

}  // namespace
}  // namespace surefoot
