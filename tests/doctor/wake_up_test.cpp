// The wake-up run on a clock that is told what happens: no late slot is lost. And cyclictest's words.
#include "tools/doctor/wake_up.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "tests/time_units.hpp"
#include "tools/doctor/check.hpp"

namespace surefoot::doctor {
namespace {

/// Wakes 10 us late, and stalls for 50 ms at every `every`-th wake-up.
class StallingClock final : public rt::Clock {
public:
    explicit StallingClock(int every) : every_(every) {}
    [[nodiscard]] std::int64_t now_ns() const override { return now_; }
    void sleep_until_ns(std::int64_t time_ns) override {
        now_ = std::max(now_, time_ns) + 10'000;
        if (every_ > 0 && ++slept_ % every_ == 0) now_ += 50 * ms, ++stalls_;
    }
    [[nodiscard]] rt::ThreadUsage usage() const override { return {}; }
    void burn_ns(std::int64_t) override {}
    [[nodiscard]] int stalls() const { return stalls_; }

private:
    std::int64_t now_ = 7;
    int every_, slept_ = 0, stalls_ = 0;
};

TEST(WakeUp, EverySlotHasItsPlaceInTheHistogram) {
    StallingClock clock(0);
    WakeCount count;
    count_wakes(clock, ms, 5000, nullptr, count);
    EXPECT_EQ(count.run, 5000U);
    EXPECT_EQ(count.skipped, 0U);
    EXPECT_EQ(count.late.count(), 5000U);
    EXPECT_EQ(count.late.max(), 10'000);
}

TEST(WakeUp, AStallCountsEverySlotThatItRanOver) {
    StallingClock clock(200);
    WakeCount count;
    count_wakes(clock, ms, 5000, nullptr, count);
    ASSERT_GE(clock.stalls(), 19);
    EXPECT_EQ(count.run + count.skipped, count.elapsed);
    EXPECT_EQ(count.late.count(), count.elapsed);
    EXPECT_EQ(count.skipped, static_cast<std::uint64_t>(clock.stalls()) * 50);
    EXPECT_EQ(count.late.max(), 50 * ms + 10'000);
    // Lateness of the slots run over falls by a period each: half of a stall's slots are more than 25 ms late.
    EXPECT_NEAR(static_cast<double>(count.late.count() - count.late.count_at_most(25 * ms)), 25.0 * clock.stalls(),
                2.0 * clock.stalls());
}

TEST(WakeUp, StopsOnRequest) {
    StallingClock clock(0);
    const std::atomic<bool> stop{true};
    WakeCount count;
    count_wakes(clock, ms, 5000, &stop, count);
    EXPECT_EQ(count.elapsed, 0U);
}

TEST(WakeUp, RunsOnTheMachineAndSumsUp) {
    const WakeFigures f = run_wake_up({.seconds = 0.2, .core = rt::allowed_cpus().cpus().back()}, {});
    EXPECT_GE(f.slots, 200U);  // more only where a stall ran over the end
    EXPECT_GT(f.max_us, 0);
    EXPECT_LE(f.p50_us, f.p99_us);
    EXPECT_LE(f.p99_us, f.max_us);
    EXPECT_EQ(f.source, "surefoot");
}

TEST(Cyclictest, ItsHistogramIsReadWhole) {
    const auto f = read_cyclictest(
        "# /dev/cpu_dma_latency set to 0us\n# Histogram\n000000 000000\n000010 000090\n000020\t000009\n# Total: 000000099\n# Min "
        "Latencies: 00010\n"
        "# Avg Latencies: 00011\n# Max Latencies: 52000\n# Histogram Overflows: 00001\n# Histogram Overflow at cycle number:\n# "
        "Thread 0: 00043\n");
    ASSERT_TRUE(f.ok()) << f.error().text();
    EXPECT_EQ(f->slots, 100U);
    EXPECT_NEAR(f->p50_us, 10, 0.5);
    EXPECT_NEAR(f->p99_us, 20, 1);
    EXPECT_NEAR(f->max_us, 52000, 0.001);
}

TEST(Cyclictest, WhatIsNoHistogramIsRefused) {
    for (const auto* text : {"", "nonsense\n", "# Total: 000000000\n", "000010 000000\n", "000010 -5\n", "99999999999 1\n",
                             "a b\n", "# Histogram Overflows: 00002\n# Max Latencies: 99999999999\n"}) {
        const auto f = read_cyclictest(text);
        EXPECT_FALSE(f.ok()) << text;
        if (!f) {
            EXPECT_FALSE(f.error().remedy.empty());
        }
    }
}

TEST(Cyclictest, AProgramThatFailsOrPrintsNothingIsAnError) {
    EXPECT_FALSE(run_cyclictest("/bin/false", {.seconds = 1}, {}).ok());
    EXPECT_FALSE(run_cyclictest("/bin/true", {.seconds = 1}, {}).ok());
    EXPECT_FALSE(run_cyclictest("/nonexistent/cyclictest", {.seconds = 1}, {}).ok());
    EXPECT_FALSE(find_program("no-such-program-anywhere").has_value());
    EXPECT_TRUE(find_program("sh").has_value());
}

TEST(Table, NamesWhatFailsWithItsRemedyAndIsPlainWithoutColour) {
    const Machine machine("/nonexistent", {}, {});
    const std::vector<Examined> examined = {
        {{"a.one", "should be so", nullptr}, pass("it is so")},
        {{"a.two", "should be so", nullptr}, fail("it is not, and this is a long story that goes on", "do this and that")},
        {{"b.three", "should be so", nullptr}, unknown("not seen", "look there")}};
    const std::string plain = table(machine, examined, {});
    EXPECT_NE(plain.find("a\n  + one"), std::string::npos) << plain;
    EXPECT_NE(plain.find("x two"), std::string::npos);
    EXPECT_NE(plain.find("    -> do this and that\n"), std::string::npos);
    EXPECT_NE(plain.find("1 pass, 1 fail, 1 unknown"), std::string::npos);
    EXPECT_NE(plain.find("not fit"), std::string::npos);
    EXPECT_TRUE(std::all_of(plain.begin(), plain.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); })) << plain;
    const std::string coloured = table(machine, examined, {.colour = true, .unicode = true});
    EXPECT_NE(coloured.find("\033[1;31m✗\033[0m"), std::string::npos);
    const std::vector<Examined> well(examined.begin(), examined.begin() + 1);
    EXPECT_NE(table(machine, well, {}).find(": fit\n"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::doctor
