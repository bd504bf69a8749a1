// When the next set is prepared, where preparing takes time from frames.
#include <gtest/gtest.h>

#include "tools/walk/prepare_thread.hpp"

namespace surefoot::walk {
namespace {

PoseSample sample_of(std::uint64_t frame, double x = 0) {
    PoseSample sample;
    sample.frame = frame;
    sample.pose.position.x = x;
    return sample;
}

prepare::PreparedFrame set_after(std::uint64_t frame) {
    prepare::PreparedFrame set;
    set.frame = frame;
    set.viewport = {1280, 720};
    set.region = {sample_of(frame).pose, 1, 0.1};
    set.wall_us = 20'000;
    return set;
}

TEST(PrepareRhythm, OneSetServesForTwoFramesWhereCoresAreShared) {
    PrepareRhythm rhythm(2, 33'000);
    EXPECT_TRUE(rhythm.due(sample_of(0))) << "the first one";
    rhythm.prepared(set_after(0));
    EXPECT_FALSE(rhythm.due(sample_of(0)));
    EXPECT_FALSE(rhythm.due(sample_of(1)));
    EXPECT_TRUE(rhythm.due(sample_of(2)));
    rhythm.prepared(set_after(7));
    EXPECT_FALSE(rhythm.due(sample_of(8)));
    EXPECT_TRUE(rhythm.due(sample_of(11))) << "preparing took longer";
}

TEST(PrepareRhythm, APoseThatTheSetDoesNotCoverIsPreparedAtOnce) {
    PrepareRhythm rhythm(2, 33'000);
    rhythm.prepared(set_after(0));
    EXPECT_FALSE(rhythm.due(sample_of(1, 0.9)));
    EXPECT_TRUE(rhythm.due(sample_of(1, 1.1)));
}

TEST(PrepareRhythm, AfterASlowSetOrAJumpTheNextFrameIsPrepared) {
    PrepareRhythm rhythm(2, 33'000);
    prepare::PreparedFrame slow = set_after(0);
    slow.wall_us = 30'000;
    rhythm.prepared(slow);
    EXPECT_TRUE(rhythm.due(sample_of(1))) << "the second frame might have begun without it";
    rhythm.prepared(set_after(1));
    EXPECT_FALSE(rhythm.due(sample_of(2)));
    rhythm.forget();
    EXPECT_TRUE(rhythm.due(sample_of(2)));
}

TEST(PrepareRhythm, EachFrameHasASetWhereCoresAreItsOwn) {
    PrepareRhythm rhythm(1, 33'000);
    rhythm.prepared(set_after(0));
    EXPECT_TRUE(rhythm.due(sample_of(1)));
}

}  // namespace
}  // namespace surefoot::walk
