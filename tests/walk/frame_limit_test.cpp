// What preparing takes from frames that share its cores.
#include <gtest/gtest.h>

#include <limits>

#include "tools/walk/frame_limit.hpp"

namespace surefoot::walk {
namespace {

prepare::PreparedFrame set_of(std::uint64_t frame, double cpu_us) {
    prepare::PreparedFrame set;
    set.frame = frame;
    set.cpu_us = cpu_us;
    return set;
}

TEST(FrameLimit, LeavesTheKernelItsShareOfEachCore) {
    FrameLimit limit(29'000, 33'000, 2);
    EXPECT_EQ(limit.us(), 29'000) << "nothing is prepared yet";
    for (std::uint64_t frame = 0; frame < 300; ++frame) limit.count(set_of(frame, 8'000));
    EXPECT_NEAR(limit.us(), 0.90 * 33'000 - 4'000, 1) << "both cores together prepare";
    for (std::uint64_t frame = 300; frame < 900; ++frame) limit.count(set_of(frame / 2, 8'000));
    EXPECT_NEAR(limit.us(), 0.90 * 33'000 - 2'000, 150) << "a set that serves twice costs half";
    for (std::uint64_t frame = 900; frame < 1500; ++frame) limit.count(set_of(frame, 100));
    EXPECT_EQ(limit.us(), 29'000) << "cheap sets take nothing";
}

TEST(FrameLimit, TakesNoMoreThanHalfOfThePeriodAndNothingWhereNoCoreIsShared) {
    FrameLimit heavy(29'000, 33'000, 2), alone(29'000, 33'000, 0), short_one(10'000, 33'000, 2);
    for (std::uint64_t frame = 0; frame < 300; ++frame)
        for (FrameLimit* limit : {&heavy, &alone, &short_one}) limit->count(set_of(frame, 1e6));
    EXPECT_EQ(heavy.us(), 16'500);
    EXPECT_EQ(alone.us(), 29'000);
    EXPECT_EQ(short_one.us(), 10'000) << "a limit that is lower stays";
}

TEST(FrameLimit, LeavesTimeForASetInTwoFrames) {
    FrameLimit limit(14'600, 16'667, 2);
    for (std::uint64_t frame = 0; frame < 300; ++frame) limit.count(set_of(frame / 2, 10'000));
    EXPECT_NEAR(limit.us(), 16'667 - 6'000, 1);
    for (std::uint64_t frame = 300; frame < 600; ++frame) limit.count(set_of(frame / 6, 10'000));
    EXPECT_NEAR(limit.us(), 16'667 - 6'000, 1) << "sets that come late get no less";
}

TEST(FrameLimit, APlanIsExpectedToEndByTheMeanAndWithHeadroomByTheLimit) {
    FrameLimit limit(14'600, 16'667, 2);
    for (std::uint64_t frame = 0; frame < 300; ++frame) limit.count(set_of(frame, 6'000));
    for (const double spent_us : {0.0, 300.0, 5'000.0})
        for (const double margin_us : {0.0, 800.0})
            for (const double headroom : {0.0, 1.0, 1.04, 1.25, 2.0}) {
                const double plan_us = limit.plan_us(spent_us, margin_us, headroom), h = std::max(headroom, 1.0);
                EXPECT_LE(spent_us + plan_us / h, limit.us() + 1e-6);
                EXPECT_LE(spent_us + plan_us + margin_us, 14'600 + 1e-6);
                EXPECT_GT(plan_us, 0);
            }
    EXPECT_EQ(limit.plan_us(20'000, 0, 1.1), 0) << "nothing is left";
    limit.count(set_of(1000, std::numeric_limits<double>::infinity()));
    EXPECT_GT(limit.us(), 8'000) << "no number says nothing";
}

TEST(FrameLimit, AFrameTakesWhatEarlierOnesLeftAndNoMore) {
    FrameLimit limit(14'600, 16'667, 2);
    for (std::uint64_t frame = 0; frame < 300; ++frame) limit.count(set_of(frame, 6'000));
    const double mean_us = limit.us();
    EXPECT_NEAR(mean_us, 12'000, 1);
    EXPECT_EQ(limit.next_us(), mean_us) << "nothing is left yet";
    limit.ended(mean_us - 1'000);
    EXPECT_DOUBLE_EQ(limit.next_us(), mean_us + 1'000);
    for (int frame = 0; frame < 100; ++frame) limit.ended(10'000);
    EXPECT_EQ(limit.next_us(), 14'600) << "never beyond the limit without preparing";
    // From now on each frame takes all that it may.
    double beyond_us = 0;
    for (int frame = 0; frame < 60; ++frame) {
        beyond_us += limit.next_us() - mean_us;
        limit.ended(limit.next_us());
    }
    EXPECT_LE(beyond_us, 0.5 * 16'667 + 1) << "in a second";
    EXPECT_DOUBLE_EQ(limit.next_us(), mean_us);
    limit.ended(std::numeric_limits<double>::quiet_NaN());
    EXPECT_DOUBLE_EQ(limit.next_us(), mean_us) << "no number says nothing";
}

}  // namespace
}  // namespace surefoot::walk
