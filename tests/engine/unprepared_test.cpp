// Frames without a prepared set: the last cut's forms where they are legal, coarse levels elsewhere, never a hole.
#include "render/unprepared.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <vector>

#include "render/model/form_range.hpp"
#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

using test::ample_us;

struct WithoutPreparedSet : testing::Test {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    Pose pose;

    void SetUp() override {
        engine = test::forest_engine();
        ASSERT_NE(engine, nullptr);
        engine->reserve(prepared);
        pose = test::forest_pose(*engine);
    }
    const select::Cut& select_here() {
        engine->prepare({pose, 0.1, 0.06}, 0, 0, 0, prepared);
        return engine->select(prepared, ample_us, {}, 0);
    }
    SubmitReport draw_last(double limit_us) {
        engine->select_last();
        return engine->submit(pose, {.elapsed_us = 0, .limit_us = limit_us});
    }
    /// Every visible leaf is covered exactly once.
    void expect_whole(const char* what) const {
        const model::Model& m = engine->model();
        const model::Frustum frustum =
            model::make_frustum(pose, engine->options().device.viewport, model::far_corners_m(m.nodes[0].box));
        std::vector<int> times(m.nodes.size(), 0);
        for (const gl::DrawItem& item : engine->drawn()) ++times[item.node];
        std::size_t leaves = 0;
        for (model::Index leaf = 0; leaf < m.nodes.size(); ++leaf) {
            if (m.nodes[leaf].child_count > 0) continue;
            int covered = 0;
            bool seen = true;
            for (model::Index n = leaf; n != model::none; n = m.nodes[n].parent) {
                covered += times[n];
                seen = seen && model::visible(frustum, m.nodes[n].box);
            }
            if (seen) ++leaves;
            EXPECT_LE(covered, 1) << what << ": leaf " << leaf;
            EXPECT_GE(covered, seen ? 1 : 0) << what << ": leaf " << leaf;
        }
        EXPECT_GT(leaves, 5U) << what << ": or the test shows nothing";
    }
    void turn(double angle_rad) { pose.orientation = glm::angleAxis(angle_rad, dvec3(0, 1, 0)) * pose.orientation; }
};

TEST_F(WithoutPreparedSet, NothingWasShownYetSoCoarseLevelsAre) {
    const SubmitReport report = draw_last(ample_us);
    expect_whole("at first");
    EXPECT_LE(engine->drawn().size(), 256U);
    EXPECT_GT(report.predicted_us, 0);
    for (const gl::DrawItem& item : engine->drawn()) EXPECT_TRUE(engine->model().reps[item.rep].everywhere);
}

TEST_F(WithoutPreparedSet, TheLastCutKeepsItsFormsWhereTheyAreLegal) {
    std::map<model::Index, model::Index> shown;
    for (const select::CutItem& item : select_here().items) shown[item.node] = item.rep;
    turn(0.3);
    pose.position += dvec3(1.5, 0, -1.5);
    const SubmitReport report = draw_last(ample_us);
    expect_whole("turned");
    std::size_t kept = 0;
    const model::Model& m = engine->model();
    for (const gl::DrawItem& item : engine->drawn()) {
        const auto nearest_m = static_cast<float>(m.nodes[item.node].box.distance(pose.position));
        EXPECT_TRUE(model::legal(m.reps[item.rep], nearest_m)) << "node " << item.node;
        const auto before = shown.find(item.node);
        if (before == shown.end()) continue;
        if (model::legal(m.reps[before->second], nearest_m)) {
            EXPECT_EQ(item.rep, before->second) << "node " << item.node;
            ++kept;
        }
    }
    EXPECT_GT(kept, 5U) << "or the test shows nothing";
    EXPECT_EQ(report.downgraded_slices, 0U);
    EXPECT_FALSE(engine->fell_to_floor(pose, ample_us, 1));
}

TEST_F(WithoutPreparedSet, OverloadDrawsStandInsAndNoHole) {
    select_here();
    const double full_us = draw_last(ample_us).predicted_us;
    std::map<model::Index, model::Index> full;
    for (const gl::DrawItem& item : engine->drawn()) full[item.node] = item.rep;
    bool some_of_both = false;
    for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        const SubmitReport report = draw_last(full_us * share);
        expect_whole("overload");
        EXPECT_GT(report.downgraded_slices, 0U) << share;
        EXPECT_LT(report.predicted_us, full_us) << share;
        std::size_t kept = 0;
        for (const gl::DrawItem& item : engine->drawn()) kept += full.contains(item.node) && full[item.node] == item.rep ? 1 : 0;
        some_of_both |= kept > 0 && kept < engine->drawn().size();
        if (share == 0.0) {
            EXPECT_LE(engine->drawn().size(), 256U);
        }
    }
    EXPECT_TRUE(some_of_both) << "what comes first keeps its detail";
}

TEST_F(WithoutPreparedSet, SeveralSuchFramesInARowKeepTheForms) {
    select_here();
    turn(0.2);
    draw_last(ample_us);
    std::vector<gl::DrawItem> first(engine->drawn().begin(), engine->drawn().end());
    draw_last(ample_us);
    ASSERT_EQ(engine->drawn().size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(engine->drawn()[i].node, first[i].node);
        EXPECT_EQ(engine->drawn()[i].rep, first[i].rep);
    }
}

TEST(WithoutPreparedSetAtHalfResolution, TheFrameKeepsTheResolutionAndPaysForEnlarging) {
    const auto opened = test::forest_engine(0.5F);
    ASSERT_NE(opened, nullptr);
    Engine& engine = *opened;
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    const Pose pose = test::forest_pose(engine);
    engine.prepare({pose, 0.1, 0.06}, 0, 0, 0, prepared);
    engine.select(prepared, ample_us, {}, 0);
    EXPECT_EQ(engine.submit(pose, {.elapsed_us = 0, .limit_us = ample_us}).resolution, 0.5F);
    engine.select_last();
    const SubmitReport report = engine.submit(pose, {.elapsed_us = 0, .limit_us = ample_us});
    EXPECT_EQ(report.resolution, 0.5F);
    EXPECT_NEAR(report.predicted_us, report.finished_us, 0.02 * report.finished_us)
        << "the null device charges what is predicted";
}

}  // namespace
}  // namespace surefoot
