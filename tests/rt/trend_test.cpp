// The robust trend: exact on a line, deaf to a quarter of nonsense, and the same for many points as for few.
#include "rt/monitor/trend.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "rt/base/random.hpp"

namespace surefoot::rt {
namespace {

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

}  // namespace
}  // namespace surefoot::rt
