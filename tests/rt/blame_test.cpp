// Blame from evidence, the deadline rule, the lossless histogram.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"
#include "rt/frame/blame.hpp"
#include "rt/frame/control.hpp"
#include "rt/monitor/histogram.hpp"

namespace surefoot::rt {
namespace {

constexpr std::int64_t period = 33'333'333;

/// An ordinary frame that ends at 0.8 of its period, with noise.
FrameRecord ordinary(Random& random) {
    FrameRecord r;
    r.due_ns = r.ready_ns = 1'000'000'000;
    r.deadline_ns = r.due_ns + period;
    const auto share = [&](double s) {
        return static_cast<std::int64_t>(s * random.range(0.8, 1.2) * static_cast<double>(period));
    };
    r.woken_ns = r.due_ns + share(0.002);
    r.selected_ns = r.woken_ns + share(0.02);
    r.submitted_ns = r.selected_ns + share(0.35);
    r.rastered_ns = r.submitted_ns + share(0.35);
    r.complete_ns = r.rastered_ns + share(0.02);
    r.prepared_age = 1;
    return r;
}

void delay_from(FrameRecord& r, int phase, std::int64_t ns) {
    if (phase <= 0) r.woken_ns += ns;
    if (phase <= 1) r.selected_ns += ns;
    if (phase <= 2) r.submitted_ns += ns;
    if (phase <= 3) r.rastered_ns += ns;
    r.complete_ns += ns;
    r.missed = r.complete_ns > r.deadline_ns;
}

TEST(OldestPrepared, IsThreeFramesAndAtLeastFiftyMilliseconds) {
    const auto at = [](double rate_hz) { return oldest_prepared(static_cast<std::int64_t>(1e9 / rate_hz)); };
    EXPECT_EQ(at(1), 3U);
    EXPECT_EQ(at(30), 3U);
    EXPECT_EQ(at(60), 3U);
    EXPECT_EQ(at(120), 6U);
    EXPECT_EQ(at(240), 12U);
    EXPECT_EQ(oldest_prepared(0), 64U) << "no period";
}

TEST(Blame, NamesTheInjectedCauseInNineteenOfTwenty) {
    Random random(11);
    const BlameLimits limits;
    const Cause causes[] = {Cause::woken_late, Cause::stolen,     Cause::preempted, Cause::select,  Cause::submit,
                            Cause::raster,     Cause::page_fault, Cause::present,   Cause::stopped, Cause::upload};
    int right = 0, all = 0;
    for (const Cause cause : causes) {
        for (int i = 0; i < 50; ++i) {
            FrameRecord r = ordinary(random);
            const auto ns = static_cast<std::int64_t>(random.range(0.7, 2.0) * static_cast<double>(period));
            switch (cause) {
                case Cause::woken_late:
                    delay_from(r, 0, ns);
                    break;
                case Cause::stolen:
                    delay_from(r, 2, ns), r.stolen_ns = ns;
                    break;
                case Cause::preempted:
                    delay_from(r, 2, ns), r.preempted_ns = ns, r.involuntary = 2;
                    break;
                case Cause::select:
                    delay_from(r, 1, ns);
                    break;
                case Cause::submit:
                    delay_from(r, 2, ns);
                    break;
                case Cause::raster:
                    delay_from(r, 3, ns);
                    break;
                case Cause::page_fault:
                    delay_from(r, 2, ns), r.major_faults = 4, r.minor_faults = 100000;
                    break;
                case Cause::present:
                    delay_from(r, 4, ns);
                    break;
                case Cause::stopped:
                    delay_from(r, 2, ns), r.continued = 1;
                    break;
                default:
                    delay_from(r, 2, ns), r.upload_ns = ns;
                    break;
            }
            ASSERT_TRUE(r.missed);
            right += blame(r, limits) == cause ? 1 : 0;
            ++all;
        }
    }
    EXPECT_GE(right, all * 95 / 100) << right << " of " << all;
    FrameRecord fine = ordinary(random);
    EXPECT_EQ(blame(fine, limits), Cause::none);
}

TEST(Blame, AMissIsOwnWhenTheStolenTimeDoesNotExplainIt) {
    Random random(2);
    BlameLimits limits;
    limits.period_ns = period;
    FrameRecord r = ordinary(random);
    delay_from(r, 2, period);
    EXPECT_TRUE(is_own_miss(r, limits));
    r.stolen_ns = period;
    EXPECT_FALSE(is_own_miss(r, limits));
    r.stolen_ns = period / 10;
    EXPECT_TRUE(is_own_miss(r, limits));
}

TEST(Blame, AStopIsNotOwnThoughTheThreadWasAlsoSwitchedOut) {
    Random random(3);
    BlameLimits limits;
    limits.period_ns = period;
    FrameRecord r = ordinary(random);
    delay_from(r, 2, period);
    r.preempted_ns = period, r.involuntary = 1;
    EXPECT_TRUE(is_own_miss(r, limits)) << "a thread that another one preempts has too low a priority";
    r.continued = 1;
    EXPECT_FALSE(is_own_miss(r, limits));
    r.preempted_ns = period / 10;
    EXPECT_TRUE(is_own_miss(r, limits)) << "a stop excuses no longer than it took";
}

TEST(Control, TheDeadlineRuleWantsAllOfItsParts) {
    std::vector<BlockTally> blocks;
    for (std::uint32_t b = 0; b < 180; ++b) {
        BlockTally tally;
        tally.block = b;
        tally.walk = ControlSchedule::is_walk(b);
        tally.frames = 60;
        blocks.push_back(tally);
    }
    EXPECT_TRUE(judge(blocks, 0.5).holds);
    EXPECT_FALSE(judge(blocks, 0.1).holds) << "a load that ordinary scheduling stands is no load";
    EXPECT_FALSE(judge(std::span(blocks).first(100), 0.5).holds) << "50 pairs are too few";
    std::vector<BlockTally> own = blocks;
    own[0].own_misses = own[0].misses = 7;  // 5400 walk frames allow 6
    EXPECT_FALSE(judge(own, 0.5).holds);
    std::vector<BlockTally> worse = blocks;
    for (BlockTally& b : worse) b.misses = b.walk ? 1 : 0;
    EXPECT_FALSE(judge(worse, 0.5).control_holds);
    for (BlockTally& b : worse) b.misses = b.walk ? 1 : 2;
    EXPECT_TRUE(judge(worse, 0.5).control_holds);
}

TEST(Histogram, AssignedIsEqualInEveryBinWhateverStoodThere) {
    Random random(31);
    const auto value = [&] {
        const auto shift = random.below(64);
        const auto v = static_cast<std::int64_t>(random.next() >> shift) & std::numeric_limits<std::int64_t>::max();
        return random.below(20) == 0 ? -1 : v;
    };
    const auto any = [&] {
        Histogram h;
        for (std::uint32_t n = random.below(40); n > 0; --n) {
            const auto times = random.below(30) == 0 ? std::numeric_limits<std::uint64_t>::max() : 1 + random.below(3);
            h.add(value(), times);
        }
        const std::int64_t first = random.below(1000), step = 1 + random.below(1'000'000);
        if (random.below(3) == 0) h.add_progression(first, step, random.below(200));
        return h;
    };
    Histogram to;
    for (int i = 0; i < 2000; ++i) {
        Histogram from = any();
        if (random.below(4) == 0) from.merge(any());
        to = from;
        const Histogram& itself = to;
        to = itself;
        std::uint64_t different = 0;
        for (std::size_t b = 0; b < Histogram::bins; ++b) different += to.bin_count(b) == from.bin_count(b) ? 0 : 1;
        ASSERT_EQ(different, 0U) << i;
        ASSERT_EQ(to.count(), from.count());
        ASSERT_EQ(to.min(), from.min());
        ASSERT_EQ(to.max(), from.max());
        ASSERT_EQ(to.sum(), from.sum());
    }
}

TEST(Histogram, ClipsNothingAndItsQuantilesAreWithinABin) {
    Histogram h;
    std::vector<std::int64_t> values;
    Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const auto v = static_cast<std::int64_t>(std::exp(random.range(0, 43)));
        values.push_back(v);
        h.add(v);
    }
    h.add(std::numeric_limits<std::int64_t>::max());
    h.add(-7);
    values.push_back(std::numeric_limits<std::int64_t>::max());
    values.push_back(-7);
    std::sort(values.begin(), values.end());
    std::uint64_t sum = 0;
    for (std::size_t b = 0; b < Histogram::bins; ++b) sum += h.bin_count(b);
    EXPECT_EQ(sum, values.size());
    EXPECT_EQ(h.count(), values.size());
    for (const double q : {0.01, 0.5, 0.9, 0.99, 0.999}) {
        const std::int64_t exact = values[static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size()))) - 1];
        EXPECT_EQ(Histogram::bin_of(h.quantile(q)), Histogram::bin_of(exact)) << q;
    }
    EXPECT_EQ(h.max(), values.back());
    EXPECT_EQ(h.min(), -7);
    for (std::size_t b = 1; b + 1 < Histogram::bins; ++b) ASSERT_EQ(Histogram::bin_high(b) + 1, Histogram::bin_low(b + 1)) << b;
}

}  // namespace
}  // namespace surefoot::rt
