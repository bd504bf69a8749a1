// Live figures: nothing of a stall is lost, slots add up, intervals and animation error follow their formulas, copies are whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/monitor/telemetry.hpp"

namespace surefoot::rt {
namespace {

constexpr std::int64_t one_ms = 1'000'000, t60_ns = 16'666'667;

/// A walk on paper: each frame takes what it is given, the grid does the rest.
class PaperWalk {
public:
    explicit PaperWalk(std::int64_t period_ns = t60_ns, LatePolicy late = LatePolicy::lock)
        : grid_{1'000'000'000, period_ns}, late_(late) {}
    FrameRecord frame(std::int64_t takes_ns) {
        FrameRecord r;
        r.slot = next_.slot;
        r.frame = frames_++;
        r.skipped_before = next_.skipped;
        r.due_ns = grid_.due_ns(r.slot);
        r.deadline_ns = grid_.deadline_ns(r.slot);
        const std::int64_t begins = std::max(r.due_ns, next_.start_ns);
        r.woken_ns = begins + 10'000;
        r.selected_ns = r.woken_ns + 100'000;
        r.submitted_ns = r.selected_ns + 200'000;
        r.complete_ns = std::max(begins + takes_ns, r.submitted_ns);
        r.rastered_ns = r.complete_ns;
        r.missed = r.complete_ns > r.deadline_ns;
        r.cause = r.missed ? Cause::raster : Cause::none;
        r.accuracy = 100;
        next_ = next_slot(grid_, late_, r.slot, r.complete_ns);
        r.show_ns = r.handed_ns = r.presented_ns = r.shown_ns = next_.shown_ns;
        r.shown_by = ShownBy::hand_over;
        return r;
    }

private:
    Grid grid_;
    LatePolicy late_;
    NextSlot next_;
    std::uint64_t frames_ = 0;
};

std::uint64_t all_of(const Distribution& d) { return std::accumulate(d.up_to.begin(), d.up_to.end(), std::uint64_t{0}); }

TEST(Telemetry, TwentyStallsOfFiftyMillisecondsAppearInFull) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({t60_ns, LatePolicy::lock, 1});
    PaperWalk walk;
    std::uint64_t skipped = 0;
    for (int i = 0; i < 2000; ++i) {
        const FrameRecord r = walk.frame(i % 100 == 50 ? 50 * one_ms : 8 * one_ms);
        skipped += r.skipped_before;
        telemetry->add(r);
    }
    const Figures& f = telemetry->figures();
    // 50 ms at 60 Hz: the late frame ends in its third slot; the two after its own are skipped.
    EXPECT_EQ(skipped, 40U);
    EXPECT_EQ(f.skipped_slots, 40U);
    EXPECT_EQ(f.misses[static_cast<std::size_t>(Cause::raster)], 20U);
    EXPECT_EQ(f.of(Series::lateness).fine.count(), 60U) << "every late frame, and every skipped slot";
    EXPECT_EQ(f.of(Series::slack).fine.count() + f.of(Series::lateness).fine.count(), f.frames + f.skipped_slots);
    EXPECT_EQ(f.slots(), 2040U);
    const Histogram& frame = f.of(Series::frame).fine;
    EXPECT_EQ(frame.max(), 50 * one_ms);
    EXPECT_EQ(frame.count() - frame.count_at_most(40 * one_ms), 20U);
    // Shown to shown: the pictures of the stall's slots are missing, in full.
    EXPECT_EQ(f.of(Series::shown_interval).fine.max(), 3 * t60_ns);
}

TEST(Telemetry, EveryValueIsInOneBinAndEdgesAreExact) {
    const Edges edges(t60_ns);
    for (const std::int64_t of_period : {t60_ns / 4, t60_ns / 2, t60_ns, 2 * t60_ns})
        EXPECT_TRUE(std::binary_search(edges.ns().begin(), edges.ns().end(), of_period)) << of_period;
    std::mt19937_64 random(1);
    Distribution d;
    std::vector<std::int64_t> values;
    for (int i = 0; i < 20000; ++i) {
        const auto value = static_cast<std::int64_t>(random() >> (random() % 63 + 1));
        values.push_back(value);
        d.add(edges, value);
    }
    d.add(edges, t60_ns);  // on an edge: at most it
    values.push_back(t60_ns);
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < edges.ns().size(); ++i) {
        below += d.up_to[i];
        EXPECT_EQ(below, std::count_if(values.begin(), values.end(), [&](auto v) { return v <= edges.ns()[i]; })) << i;
    }
    EXPECT_EQ(all_of(d), values.size());
    EXPECT_EQ(d.fine.count(), values.size());
    std::sort(values.begin(), values.end());
    for (const double q : {0.5, 0.99, 0.999}) {
        const std::int64_t exact = values[static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size()))) - 1];
        EXPECT_EQ(Histogram::bin_of(d.fine.quantile(q)), Histogram::bin_of(exact)) << q;
    }
}

TEST(Telemetry, EdgesAreFineWhereAFrameIsAboutToBeLate) {
    for (const std::int64_t period_ns : {t60_ns, 2 * t60_ns, std::int64_t{33'333'333}, 40 * one_ms, 8 * one_ms}) {
        const Edges edges(period_ns);
        const auto between = [&](std::int64_t above, std::int64_t below) {
            return std::count_if(edges.ns().begin(), edges.ns().end(), [&](auto e) { return e > above && e < below; });
        };
        EXPECT_GE(between(period_ns * 3 / 5, period_ns), 3) << period_ns;
        EXPECT_GE(between(period_ns, 2 * period_ns), 1) << period_ns;
    }
}

TEST(Telemetry, EdgesOfARoundPeriodAreNotDoubled) {
    const Edges edges(10 * one_ms);
    EXPECT_EQ(std::adjacent_find(edges.ns().begin(), edges.ns().end()), edges.ns().end());
    EXPECT_LT(edges.ns().size(), Edges::max_edges);
    Distribution d;
    for (const std::int64_t v : {std::int64_t{0}, 5 * one_ms, 100'000 * one_ms}) d.add(edges, v);
    EXPECT_EQ(all_of(d), 3U);
    EXPECT_EQ(d.up_to[Edges::max_edges], 1U);
}

TEST(Telemetry, AProgressionIsTheSameAsItsValues) {
    const Edges edges(t60_ns);
    for (const std::uint64_t times : {1U, 2U, 3U, 40U, 5000U}) {
        Distribution at_once, one_by_one;
        at_once.add_progression(edges, 3 * one_ms, t60_ns, times);
        for (std::uint64_t i = 0; i < times; ++i) one_by_one.add(edges, 3 * one_ms + static_cast<std::int64_t>(i) * t60_ns);
        EXPECT_EQ(at_once.up_to, one_by_one.up_to) << times;
        EXPECT_EQ(at_once.fine.count(), times);
        EXPECT_EQ(at_once.fine.min(), one_by_one.fine.min());
        EXPECT_EQ(at_once.fine.max(), one_by_one.fine.max());
        EXPECT_NEAR(at_once.fine.sum(), one_by_one.fine.sum(), 1e-9 * one_by_one.fine.sum());
        for (std::size_t b = 0; b < Histogram::bins; ++b) ASSERT_EQ(at_once.fine.bin_count(b), one_by_one.fine.bin_count(b)) << b;
    }
}

TEST(Telemetry, AStopOfMonthsIsOneCallAndStillInFull) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({t60_ns, LatePolicy::lock, 1});
    PaperWalk walk;
    telemetry->add(walk.frame(one_ms));
    telemetry->add(walk.frame(90LL * 86400 * 1000 * one_ms));
    telemetry->add(walk.frame(one_ms));
    const Figures& f = telemetry->figures();
    EXPECT_GT(f.skipped_slots, 400'000'000U);
    EXPECT_EQ(f.of(Series::slack).fine.count() + f.of(Series::lateness).fine.count(), f.frames + f.skipped_slots);
    EXPECT_EQ(all_of(f.of(Series::lateness)), f.of(Series::lateness).fine.count());
}

TEST(Telemetry, AnimationErrorIsShownLessDue) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({10 * one_ms, LatePolicy::floating, 1});
    PaperWalk walk(10 * one_ms, LatePolicy::floating);
    telemetry->add(walk.frame(4 * one_ms));  // shown at 4
    telemetry->add(walk.frame(7 * one_ms));  // due at 10, shown at 17: 13 between the pictures, 10 between what they show
    telemetry->add(walk.frame(4 * one_ms));  // due at 20, shown at 24: 7
    const Figures& f = telemetry->figures();
    EXPECT_EQ(f.of(Series::animation_error).fine.count(), 2U);
    EXPECT_EQ(f.of(Series::animation_error).fine.sum(), 2.0 * 3 * one_ms);
    EXPECT_EQ(f.of(Series::shown_interval).fine.min(), 7 * one_ms);
    EXPECT_EQ(f.of(Series::shown_interval).fine.max(), 13 * one_ms);
    EXPECT_NEAR(f.one_percent_low_hz(), 1e9 / (13 * one_ms), 1e-9);
}

TEST(Telemetry, BareFramesOfTheControlAreNobodysFigures) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({t60_ns, LatePolicy::lock, 1});
    PaperWalk walk;
    telemetry->add(walk.frame(one_ms));
    FrameRecord bare = walk.frame(20 * one_ms);
    bare.control = true;
    telemetry->add(bare);
    telemetry->add(walk.frame(one_ms));
    const Figures& f = telemetry->figures();
    EXPECT_EQ(f.frames, 2U);
    EXPECT_EQ(f.bare_frames, 1U);
    EXPECT_EQ(f.all_misses(), 0U);
    EXPECT_EQ(f.of(Series::shown_interval).fine.count(), 0U) << "there was a bare frame between the two";
}

TEST(Telemetry, RecordsThatWereLostOnTheWayAreMissedSlots) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({t60_ns, LatePolicy::lock, 1});
    PaperWalk walk;
    for (int i = 0; i < 100; ++i) {
        const FrameRecord r = walk.frame(i == 40 ? 50 * one_ms : one_ms);
        if (i < 30 || i >= 50) telemetry->add(r);
    }
    const Figures& f = telemetry->figures();
    EXPECT_EQ(f.frames, 80U);
    EXPECT_EQ(f.lost_slots, 22U) << "20 frames, and the two slots that one of them ran over";
    EXPECT_EQ(f.slots(), 102U);
}

TEST(Telemetry, CountsGoOnFromWalkToWalkButNotToAnotherRate) {
    auto telemetry = std::make_unique<Telemetry>();
    for (int n = 1; n <= 2; ++n) {
        telemetry->begin({t60_ns, LatePolicy::lock, 1});
        PaperWalk walk;
        for (int i = 0; i < 10; ++i) {
            FrameRecord r = walk.frame(one_ms);
            r.input_reports = static_cast<std::uint64_t>(i);
            telemetry->add(r);
        }
        EXPECT_EQ(telemetry->figures().frames, 10U * static_cast<unsigned>(n));
        EXPECT_EQ(telemetry->figures().input_reports, 9U * static_cast<unsigned>(n));
        EXPECT_EQ(telemetry->figures().lost_slots, 0U);
    }
    telemetry->begin({10 * one_ms, LatePolicy::lock, 1});
    EXPECT_EQ(telemetry->figures().frames, 0U);
    EXPECT_TRUE(std::ranges::binary_search(telemetry->figures().edges.ns(), 2'500'000));
}

TEST(Telemetry, AReaderSeesWholeCopiesAndNeverHoldsTheWriterUp) {
    auto telemetry = std::make_unique<Telemetry>();
    telemetry->begin({t60_ns, LatePolicy::lock, 1});
    std::atomic<bool> done{false};
    std::thread writer([&] {
        PaperWalk walk;
        for (int i = 0; i < 200'000; ++i) telemetry->add(walk.frame(i % 64 == 0 ? 40 * one_ms : 5 * one_ms));
        telemetry->publish();
        done.store(true);
    });
    std::uint64_t last = 0, looks = 0;
    bool was_done = false;
    while (!was_done) {
        was_done = done.load();
        const Figures& f = telemetry->newest();
        ASSERT_GE(f.frames, last);
        ASSERT_EQ(f.of(Series::frame).fine.count(), f.frames);
        ASSERT_EQ(f.of(Series::slack).fine.count() + f.of(Series::lateness).fine.count(), f.frames + f.skipped_slots);
        ASSERT_EQ(f.recent_count, f.frames);
        last = f.frames;
        ++looks;
    }
    writer.join();
    EXPECT_EQ(last, 200'000U);
    EXPECT_GT(looks, 1U);
}

}  // namespace
}  // namespace surefoot::rt
