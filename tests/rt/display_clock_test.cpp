// A grid that a display moves: each picture is shown by its own refresh, for as long as one likes, whatever the display's clock.
#include "rt/clock/display_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/random.hpp"
#include "rt/exchange/spsc_ring.hpp"
#include "rt/frame/loop.hpp"
#include "tests/rt/paced_display.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

constexpr std::int64_t refresh_60_ns = 16'666'667;

/// Frames that take a third of their slot, shown by the display. Remembers by which refresh.
class FlippedStages final : public FrameStages {
public:
    FlippedStages(VirtualClock& c, test::PacedDisplay d) : clock(c), display(d) {}
    VirtualClock& clock;
    test::PacedDisplay display;
    std::vector<std::int64_t> refreshes;
    std::uint64_t late_frame = ~0ULL, missed_frame = ~0ULL;
    std::int64_t works_ns = 5 * ms;
    std::int64_t queues_ns = 0;  ///< presenting takes so long until the display has the picture
    bool reports_queued = true;

    void sample(FrameRecord&) override {}
    void select(FrameRecord&) override { clock.advance(ms / 2); }
    void submit(FrameRecord& r) override { clock.advance(r.frame == late_frame ? 60 * ms : works_ns); }
    void finish(FrameRecord&) override {}
    void account(FrameRecord&) override {}
    Shown present(FrameRecord& r) override {
        clock.advance(queues_ns);
        const std::int64_t queued_ns = r.handed_ns + queues_ns;
        refreshes.push_back(display.shows(queued_ns) + (r.frame == missed_frame ? 1 : 0));
        const std::int64_t shown_ns = display.at_ns(refreshes.back());
        clock.wait(shown_ns + 60'000 - clock.now_ns());  // until the event of the refresh has been read
        return {ShownBy::display, shown_ns, reports_queued ? queued_ns : 0};
    }
};

struct FlippedWalk {
    FlippedWalk(double rate_hz, double off_ppm, std::uint64_t frames) {
        refreshes.one_ns = 7 * ms;
        test::PacedDisplay display;
        display.refresh_ns = static_cast<double>(refresh_60_ns) * (1 + off_ppm * 1e-6);
        display.first_ns = static_cast<double>(refreshes.one_ns);
        per_slot = *refreshes_per_slot(refreshes, rate_hz);
        follower = std::make_unique<DisplayClock>(refreshes, per_slot);
        stages = std::make_unique<FlippedStages>(clock, display);
        const Grid grid = follower->grid_from(100 * ms);
        options.shows = true;
        options.display = follower.get();
        options.t0_ns = grid.t0_ns;
        options.period_ns = grid.period_ns;
        options.frames = frames;
        options.wait_for_ring = false;
    }
    std::vector<FrameRecord> run() {
        SpscRing<FrameRecord> ring(1U << 17U);
        result = run_frame_loop(options, clock, *stages, ring);
        std::vector<FrameRecord> records;
        FrameRecord r;
        while (ring.try_pop(r)) records.push_back(r);
        return records;
    }
    VirtualClock clock;
    Refreshes refreshes{refresh_60_ns, 0};
    std::uint32_t per_slot = 0;
    std::unique_ptr<DisplayClock> follower;
    std::unique_ptr<FlippedStages> stages;
    FrameLoopOptions options;
    FrameLoopResult result;
};

TEST(DisplayClock, TenMinutesOfADisplayThatIsFiftyPartsInAMillionOffMissNoRefresh) {
    for (const double rate_hz : {60.0, 30.0, 20.0}) {
        for (const double off_ppm : {50.0, -50.0, 400.0}) {
            FlippedWalk walk(rate_hz, off_ppm, static_cast<std::uint64_t>(600 * rate_hz));
            const auto records = walk.run();
            ASSERT_EQ(records.size(), walk.options.frames);
            EXPECT_EQ(walk.result.skipped, 0U) << rate_hz << " Hz, " << off_ppm;
            const std::int64_t first = walk.stages->refreshes[8];
            for (const FrameRecord& r : records) {
                if (r.frame < 8) continue;
                ASSERT_EQ(walk.stages->refreshes[r.frame], first + static_cast<std::int64_t>(walk.per_slot * (r.frame - 8)))
                    << rate_hz << " Hz, frame " << r.frame;
                ASSERT_FALSE(r.missed) << r.frame;
            }
            // No drift: the grid's last point is a refresh, and its period the display's.
            EXPECT_NEAR(static_cast<double>(records.back().shown_ns - records.back().show_ns), 0, 100);
            EXPECT_NEAR(walk.follower->refresh_ns(), walk.stages->display.refresh_ns, 2);
        }
    }
}

TEST(DisplayClock, WithoutFollowingPicturesMissTheirRefreshesSoonerOrLater) {
    FlippedWalk walk(60, 400, 36'000);
    walk.options.display = nullptr;
    EXPECT_GT(walk.run().size(), 0U);
    EXPECT_GT(walk.result.skipped, 0U) << "so the test above can fail";
}

TEST(DisplayClock, ALateFrameIsShownByALaterRefreshAndTheGridStays) {
    FlippedWalk walk(30, 50, 200);
    walk.stages->late_frame = 100;
    const auto records = walk.run();
    EXPECT_EQ(walk.result.skipped, 1U) << "66 ms of two slots";
    for (const FrameRecord& r : records) EXPECT_EQ(r.missed, r.frame == 100) << r.frame;
    const auto& at = walk.stages->refreshes;
    EXPECT_EQ(at[100] - at[99], 2 * walk.per_slot) << "one slot later, on the grid";
    EXPECT_EQ(at[101] - at[100], walk.per_slot);
    EXPECT_EQ((at[199] - at[50]) % walk.per_slot, 0) << "the same phase of the display";
}

TEST(DisplayClock, APictureIsHandedOverEarlyByWhatItTakesUntilTheDisplayHasIt) {
    const auto misses_after_a_second = [](bool reports) {
        FlippedWalk walk(60, 50, 600);
        walk.stages->queues_ns = 3 * ms;  // and 0.4 before the refresh: more than the margin may grow to
        walk.stages->reports_queued = reports;
        const auto records = walk.run();
        return std::count_if(records.begin(), records.end(), [](const FrameRecord& r) { return r.frame >= 60 && r.missed; });
    };
    EXPECT_EQ(misses_after_a_second(true), 0);
    EXPECT_GT(misses_after_a_second(false), 500) << "so the line above can fail";
}

TEST(DisplayClock, APictureThatMissesItsRefreshCostsOneSlotAtAnyRate) {
    for (const double rate_hz : {60.0, 30.0}) {
        FlippedWalk walk(rate_hz, 50, 100);
        walk.stages->missed_frame = 50;
        const auto records = walk.run();
        EXPECT_EQ(walk.result.skipped, 1U) << rate_hz;
        for (const FrameRecord& r : records) {
            EXPECT_EQ(r.missed, r.frame == 50) << r.frame;
            EXPECT_EQ(r.cause, r.frame == 50 ? Cause::present : Cause::none) << cause_of(r);
        }
    }
}

TEST(DisplayClock, StampsThatTrembleMoveTheGridByAPartOfThat) {
    const Refreshes display{refresh_60_ns, 0};
    DisplayClock clock(display, 1);
    Grid grid = clock.grid_from(0);
    Random random(3);
    double largest_ns = 0;
    for (std::uint64_t k = 1; k < 20'000; ++k) {
        const double true_ns = static_cast<double>(k) * refresh_60_ns;
        grid = clock.follow(grid, static_cast<std::int64_t>(true_ns + random.range(-20'000, 20'000)), k);
        if (k > 200) largest_ns = std::max(largest_ns, std::abs(static_cast<double>(grid.due_ns(k)) - true_ns));
    }
    EXPECT_LT(largest_ns, 20'000);
    EXPECT_NEAR(clock.refresh_ns(), refresh_60_ns, 5'000);
}

TEST(DisplayClock, WildStampsLeaveThePeriodNearTheModes) {
    DisplayClock clock({refresh_60_ns, 0}, 2);
    Grid grid = clock.grid_from(0);
    Random random(5);
    for (std::uint64_t k = 1; k < 5000; ++k) {
        grid = clock.follow(grid, static_cast<std::int64_t>(random.range(-1e15, 1e15)), k);
        ASSERT_NEAR(clock.refresh_ns(), refresh_60_ns, 2.1e-3 * refresh_60_ns);
        ASSERT_GT(grid.period_ns, 0);
        ASSERT_EQ(grid.slot0, k);
    }
}

TEST(DisplayClock, TheFirstPointIsARefreshThatIsNotBefore) {
    const Refreshes display{refresh_60_ns, 5 * ms};
    const DisplayClock clock(display, 3);
    for (const std::int64_t earliest_ns : {-100 * ms, std::int64_t{0}, 5 * ms, 5 * ms + 1, 987 * ms}) {
        const Grid grid = clock.grid_from(earliest_ns);
        EXPECT_GE(grid.t0_ns, earliest_ns);
        EXPECT_LT(grid.t0_ns, earliest_ns + refresh_60_ns);
        EXPECT_EQ((grid.t0_ns - display.one_ns) % refresh_60_ns, 0);
        EXPECT_EQ(grid.period_ns, 3 * refresh_60_ns);
    }
}

TEST(DisplayClock, ARateThatDoesNotDivideTheDisplaysIsRefusedWithThoseThatDo) {
    const Refreshes display{refresh_60_ns, 0};
    for (const auto& [rate_hz, refreshes] : {std::pair{60.0, 1U}, {59.94, 1U}, {30.0, 2U}, {20.0, 3U}, {1.0, 60U}})
        EXPECT_EQ(*refreshes_per_slot(display, rate_hz), refreshes) << rate_hz;
    for (const double rate_hz : {25.0, 50.0, 120.0, 0.0, -30.0}) {
        const auto refused = refreshes_per_slot(display, rate_hz);
        ASSERT_FALSE(refused.ok()) << rate_hz;
        EXPECT_NE(refused.error().text().find("60, 30, 20 or 15 Hz"), std::string::npos) << refused.error().text();
    }
}

}  // namespace
}  // namespace surefoot::rt
