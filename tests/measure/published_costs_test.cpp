// Published formulas of a frame's cost: values worked out by hand, and the factor that is taught from other frames.
#include "render/measure/published_costs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace surefoot::measure {
namespace {

using Times = std::array<double, 3>;

TEST(PublishedCosts, ErrorsAreThoseWorkedOutByHand) {
    const CostErrors e = cost_errors(Times{90, 220, 150}, Times{100, 200, 300});
    EXPECT_NEAR(e.p50, 0.1, 1e-12);
    EXPECT_NEAR(e.p90, 0.5, 1e-12);
    EXPECT_NEAR(e.p99, 0.5, 1e-12);
    EXPECT_NEAR(e.bias, -0.1, 1e-12);
    // Sums of squares about the means 460/3 and 200: 25400/3 and 20000; of products: 6000.
    EXPECT_NEAR(e.r2, 6000.0 * 6000.0 / (25400.0 / 3.0 * 20000.0), 1e-12);
}

TEST(PublishedCosts, EqualTimesHaveNoCorrelationAndNoFramesNoErrors) {
    const CostErrors equal = cost_errors(Times{5, 5, 5}, Times{5, 5, 5});
    EXPECT_EQ(equal.p99, 0);
    EXPECT_EQ(equal.r2, 0);
    const CostErrors none = cost_errors(std::span<const double>{}, std::span<const double>{});
    EXPECT_EQ(none.p50, 0);
    EXPECT_EQ(none.bias, 0);
}

/// A frame of two items, (30, 10) and (20, 60) us, `scale` times as dear, that takes `actual_us`.
FrameSample frame(double scale, double actual_us) {
    return {55 * scale, 75 * scale, actual_us, {50 * scale, 70 * scale, 90 * scale}};
}

TEST(PublishedCosts, EachFormulaIsItsOwnAndOnlyTheRightOneIsExact) {
    const std::array<FrameSample, 3> sum_of_max{frame(10, 900), frame(20, 1800), frame(30, 2700)};
    const std::array<FrameSample, 3> max_of_sums{frame(10, 700), frame(20, 1400), frame(30, 2100)};
    const std::array<FrameSample, 3> sums{frame(10, 1200), frame(20, 2400), frame(30, 3600)};
    const auto error_of = [](std::span<const FrameSample> frames, std::string_view name) {
        for (const PublishedCost& cost : published_costs(frames, frames))
            if (cost.name == name) return cost.as_published.p99;
        return -1.0;
    };
    EXPECT_NEAR(error_of(sum_of_max, "sum_of_max"), 0, 1e-9);
    EXPECT_NEAR(error_of(sum_of_max, "max_of_sums"), 2.0 / 9.0, 1e-9);
    EXPECT_NEAR(error_of(sum_of_max, "sum_of_stages"), 3.0 / 9.0, 1e-9);
    EXPECT_NEAR(error_of(max_of_sums, "max_of_sums"), 0, 1e-9);
    EXPECT_GT(error_of(max_of_sums, "sum_of_max"), 0.2);
    EXPECT_NEAR(error_of(sums, "sum_of_stages"), 0, 1e-9);
    EXPECT_GT(error_of(sums, "sum_of_max"), 0.2);
}

TEST(PublishedCosts, TheFactorIsTaughtByOtherFramesAndTakesAConstantErrorAway) {
    const std::array<FrameSample, 3> taught{frame(1, 240), frame(2, 480), frame(3, 9000)};  // the last was disturbed
    const std::array<FrameSample, 2> held_out{frame(4, 960), frame(9, 2160)};
    for (const PublishedCost& cost : published_costs(taught, held_out)) {
        if (cost.name != "sum_of_stages") continue;
        EXPECT_NEAR(cost.factor, 2, 1e-9);
        EXPECT_NEAR(cost.as_published.p50, 0.5, 1e-9);
        EXPECT_NEAR(cost.as_published.bias, -0.5, 1e-9);
        EXPECT_NEAR(cost.as_published.r2, 1, 1e-9);
        EXPECT_NEAR(cost.with_factor.p99, 0, 1e-9);
        return;
    }
    FAIL() << "the thesis' sum is missing";
}

}  // namespace
}  // namespace surefoot::measure
