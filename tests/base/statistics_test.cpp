// Quantiles by rank, the robust trend (exact on a line, deaf to a quarter of nonsense), the permutation test by counting.
#include "rt/base/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"

namespace surefoot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Quantiles, AreNearestRanksThatOccurred) {
    std::vector<double> values;
    for (int i = 1000; i >= 1; --i) values.push_back(i);
    const auto q = quantiles(values);
    EXPECT_EQ(q.p50, 500);
    EXPECT_EQ(q.p90, 900);
    EXPECT_EQ(q.p99, 990);
    EXPECT_EQ(q.p999, 999);
    EXPECT_EQ(q.max, 1000);
    EXPECT_EQ(q.min, 1);
    EXPECT_DOUBLE_EQ(q.mean, 500.5);
}

TEST(Quantiles, OneSlowFrameOfThousandIsTheMaximumAndNoMore) {
    std::vector<double> values(1000, 1.0);
    values[3] = 50;
    EXPECT_EQ(quantiles(values).p999, 1.0);
    EXPECT_EQ(quantiles(values).max, 50.0);
    values.resize(999);
    EXPECT_EQ(quantiles(values).p999, 50.0);
}

TEST(Quantiles, EmptyAndNotFiniteValues) {
    EXPECT_EQ(quantiles({}).max, 0);
    EXPECT_EQ(quantiles({std::nan(""), infinity, 3.0}).max, 3);
    EXPECT_EQ(quantiles({7.0}).p50, 7);
}

TEST(Quantiles, ByRankAndTheMedian) {
    EXPECT_EQ(quantile_of({}, 0.5), 0);
    EXPECT_EQ(quantile_of({4, 1, 3, 2}, 0), 1);
    EXPECT_EQ(quantile_of({4, 1, 3, 2}, 0.5), 3) << "the upper one of the two in the middle";
    EXPECT_EQ(quantile_of({4, 1, 3, 2}, 0.74), 3);
    EXPECT_EQ(quantile_of({4, 1, 3, 2}, 1), 4);
    EXPECT_EQ(median_of({}), 0);
    EXPECT_EQ(median_of({9}), 9);
    EXPECT_EQ(median_of({5, 1, 9}), 5);
    EXPECT_EQ(median_of({9, 1, 4, 2}), 3);
}

TEST(Huber, WeighsOutliersByTheirDistance) {
    EXPECT_EQ(huber_weight(0, 0.15), 1);
    EXPECT_EQ(huber_weight(0.15, 0.15), 1);
    EXPECT_EQ(huber_weight(0.6, 0.15), 0.25);
}

TEST(Trend, OfALineIsTheLine) {
    std::vector<TrendPoint> points;
    for (int i = 0; i < 40; ++i) points.push_back({3.0 * i, 7 + 0.5 * (3.0 * i)});
    const Trend trend = robust_trend(points);
    EXPECT_TRUE(trend.known);
    EXPECT_NEAR(trend.per_s, 0.5, 1e-12);
    EXPECT_NEAR(trend.at_s0, 7, 1e-9);
}

TEST(Trend, OfTooLittleIsUnknown) {
    EXPECT_FALSE(robust_trend({}).known);
    const std::vector<TrendPoint> one = {{1, 2}}, together = {{1, 2}, {1, 9}};
    EXPECT_FALSE(robust_trend(one).known);
    EXPECT_FALSE(robust_trend(together).known);
}

TEST(Trend, AQuarterOfNonsenseMovesItLittle) {
    for (const int count : {200, 5000}) {
        Random random(4);
        std::vector<TrendPoint> points;
        for (int i = 0; i < count; ++i) {
            const double t = 3600.0 * i / count;
            points.push_back({t, random.unit() < 0.25 ? random.range(0, 1e6) : 1000 + 0.02 * t + random.range(-2, 2)});
        }
        EXPECT_NEAR(robust_trend(points).per_s, 0.02, 0.01) << count;
    }
}

TEST(Trend, AStepInTheMiddleIsNoLine) {
    std::vector<TrendPoint> points;
    for (int i = 0; i < 1000; ++i) points.push_back({1.0 * i, i < 300 ? 0.0 : 100.0});
    EXPECT_EQ(robust_trend(points).per_s, 0) << "most pairs lie on one side";
}

TEST(Permutation, OfSignsIsExact) {
    EXPECT_DOUBLE_EQ(sign_flip_p_value({}), 1.0);
    EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<int>{0, 0, 0}), 1.0);
    EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<int>{1}), 0.5);
    EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<int>{1, 1, 1}), 0.125);
    EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<int>{2, -1}), 0.5);  // +2-1 and +2+1 of four
    EXPECT_DOUBLE_EQ(sign_flip_p_value(std::vector<int>{-1, -1}), 1.0);
    Random random(3);
    std::vector<int> d;
    for (int i = 0; i < 12; ++i) d.push_back(static_cast<int>(random.below(7)) - 3);
    int seen = 0, least = 0;
    for (const int x : d) seen += x;
    for (unsigned mask = 0; mask < 4096; ++mask) {
        int sum = 0;
        for (unsigned i = 0; i < 12; ++i) sum += (mask >> i & 1U) != 0 ? std::abs(d[i]) : -std::abs(d[i]);
        least += sum >= seen ? 1 : 0;
    }
    EXPECT_NEAR(sign_flip_p_value(d), least / 4096.0, 1e-12);
}

}  // namespace
}  // namespace surefoot
