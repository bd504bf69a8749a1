// Falls to the floor: what counts as fallen, and that coarse levels count where the cut before would have fitted.
#include "render/floor_watch.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

using select::Shown;
using test::ample_us;

TEST(FloorWatch, OnlyWhatWasFinerBeforeHasFallen) {
    FloorWatch watch;
    watch.reserve(10, 10);
    watch.begin();
    EXPECT_EQ(watch.floor_share(), 0);
    EXPECT_EQ(watch.fallen_share(std::vector<Shown>{{1, 5}}), 0);
    watch.add({1, 10}, 40, true);   // node 1 in form 10
    watch.add({2, 20}, 30, true);   // node 2 in form 20
    watch.add({3, 31}, 30, false);  // full detail
    EXPECT_FLOAT_EQ(watch.floor_share(), 0.7F);
    EXPECT_EQ(watch.fallen_share({}), 0) << "what came into view has not fallen";
    EXPECT_EQ(watch.fallen_share(std::vector<Shown>{{1, 10}, {2, 20}, {3, 31}}), 0) << "the same forms";
    EXPECT_FLOAT_EQ(watch.fallen_share(std::vector<Shown>{{1, 11}, {2, 20}, {3, 32}}), 0.4F);
    EXPECT_FLOAT_EQ(watch.fallen_share(std::vector<Shown>{{1, 11}, {2, select::SelectState::opened}, {9, 90}}), 0.7F);
    EXPECT_EQ(watch.fallen_share({}), 0) << "nothing is remembered";
    watch.begin();
    EXPECT_EQ(watch.floor_share(), 0);
    EXPECT_EQ(watch.fallen_share(std::vector<Shown>{{1, 11}}), 0);
}

struct FallToFloor : testing::Test {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    Pose pose;

    void SetUp() override {
        engine = test::forest_engine();
        ASSERT_NE(engine, nullptr);
        engine->reserve(prepared);
        pose = test::forest_pose(*engine);
        engine->prepare({pose, 0.1, 0.1}, 0, 0, 0, prepared);
    }
    SubmitReport draw(double budget_us) {
        engine->select(prepared, budget_us, {}, 0);
        return engine->submit(pose, {.elapsed_us = 0, .limit_us = ample_us});
    }
    /// No prepared set and no time: the coarse levels.
    SubmitReport draw_coarse() {
        engine->select_last();
        return engine->submit(pose, {});
    }
};

TEST_F(FallToFloor, CoarseLevelsCountWhereTheCutBeforeWouldHaveFitted) {
    EXPECT_GT(draw_coarse().floor_share, 0.5F);
    EXPECT_FALSE(engine->fell_to_floor(pose, ample_us, 1)) << "there was no cut before";
    const SubmitReport full = draw(ample_us);
    EXPECT_LT(full.floor_share, 0.5F);
    EXPECT_FALSE(engine->fell_to_floor(pose, ample_us, 1));
    draw_coarse();
    EXPECT_TRUE(engine->fell_to_floor(pose, 2 * full.predicted_us, 1));
    EXPECT_FALSE(engine->fell_to_floor(pose, full.predicted_us / 2, 1)) << "the cut before would not have fitted";
    EXPECT_FALSE(engine->fell_to_floor(pose, 2 * full.predicted_us, 4)) << "nor where costs are four times as high";
    draw_coarse();
    EXPECT_TRUE(engine->fell_to_floor(pose, ample_us, 1)) << "each such frame counts";
}

TEST_F(FallToFloor, AFloorCutCountsOnceAndItsOwnSuccessorsDoNot) {
    draw(ample_us);
    EXPECT_GT(draw(0).floor_share, 0.5F);
    EXPECT_TRUE(engine->fell_to_floor(pose, ample_us, 1));
    draw(0);
    EXPECT_FALSE(engine->fell_to_floor(pose, ample_us, 1)) << "the cut before was the floor too";
    draw(ample_us);
    EXPECT_FALSE(engine->fell_to_floor(pose, ample_us, 1));
}

TEST_F(FallToFloor, ItemsOutsideTheViewAreListedAsCulled) {
    const std::size_t items = engine->select(prepared, ample_us, {}, 0).items.size();
    pose.orientation = glm::angleAxis(0.1, dvec3(0, 1, 0));
    engine->submit(pose, {.elapsed_us = 0, .limit_us = ample_us});
    EXPECT_FALSE(engine->culled().empty());
    EXPECT_EQ(engine->drawn().size() + engine->culled().size(), items);
}

}  // namespace
}  // namespace surefoot
