// Items beside forms, through the engine: bought, charged to the virtual clock, predicted, and reported.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/forest_engine.hpp"

namespace surefoot {
namespace {

using select::ItemKind;
using test::ample_us;

struct Drawn {
    SubmitReport report;
    double charged_us = 0;
};

prepare::PreparedFrame prepared_forest(Engine& engine) {
    prepare::PreparedFrame set;
    engine.reserve(set);
    engine.prepare({test::forest_pose(engine), 0, 0}, 0, 0, 0, set);
    return set;
}

Drawn draw(Engine& engine, const prepare::PreparedFrame& set, double budget_us) {
    engine.device().draws.plays();
    engine.select(set, budget_us, {}, 0);
    const double before = engine.device().charged_us();
    const SubmitReport report = engine.submit(test::forest_pose(engine), {.elapsed_us = 0, .limit_us = ample_us});
    return {report, engine.device().charged_us() - before};
}

TEST(EngineItems, AreChargedPredictedAndReported) {
    const auto engine = test::forest_engine();
    ASSERT_TRUE(engine);
    const prepare::PreparedFrame set = prepared_forest(*engine);
    const Drawn without = draw(*engine, set, ample_us);
    EXPECT_EQ(without.report.bought_items, 0U);
    EXPECT_EQ(without.report.bought_us, 0.0);
    EXPECT_TRUE(engine->offer({ItemKind::upload, 3, 5000, 1}));
    EXPECT_FALSE(engine->offer({ItemKind::upload, 4, std::nanf(""), 1}));
    EXPECT_FALSE(engine->bought(ItemKind::upload, 3)) << "nothing is selected yet";
    const Drawn with = draw(*engine, set, ample_us);
    EXPECT_TRUE(engine->bought(ItemKind::upload, 3));
    EXPECT_FALSE(engine->bought(ItemKind::upload, 4));
    EXPECT_FALSE(engine->bought(ItemKind::refresh, 3));
    EXPECT_EQ(with.report.bought_items, 1U);
    EXPECT_EQ(with.report.refused_items, 1U);
    EXPECT_EQ(with.report.bought_us, 5000.0);
    EXPECT_NEAR(with.report.predicted_us - without.report.predicted_us, 5000, 0.5);
    EXPECT_NEAR(with.charged_us - without.charged_us, 5000, 0.5);
    EXPECT_NEAR(with.report.predicted_us, with.charged_us, 1e-4 * with.charged_us);
    const Drawn after = draw(*engine, set, ample_us);
    EXPECT_EQ(after.report.bought_items + after.report.refused_items, 0U) << "an offer is for one frame";
    EXPECT_FALSE(engine->bought(ItemKind::upload, 3));
}

TEST(EngineReport, TellsTheShareOfTheValueThatIsDrawn) {
    const auto engine = test::forest_engine();
    ASSERT_TRUE(engine);
    const prepare::PreparedFrame set = prepared_forest(*engine);
    EXPECT_NEAR(draw(*engine, set, ample_us).report.value, 1, 1e-6) << "full detail";
    const double floor = draw(*engine, set, 0).report.value;
    EXPECT_LT(floor, 0.9);
    EXPECT_GE(floor, 0);
    engine->select(set, ample_us, {}, 0);
    const SubmitReport of_full_detail = engine->submit(test::forest_pose(*engine), {});
    EXPECT_EQ(of_full_detail.downgraded_slices, of_full_detail.slices) << "without time, all slices are stand-ins";
    EXPECT_LT(of_full_detail.value, 0.9);
    EXPECT_GT(of_full_detail.value, 0);
    engine->select(set, 0, {}, 0);
    const double stand_ins = engine->submit(test::forest_pose(*engine), {}).value;
    EXPECT_LE(stand_ins, floor) << "without time, all slices are stand-ins";
    EXPECT_GT(stand_ins, 0);
    engine->select_last();
    EXPECT_EQ(engine->submit(test::forest_pose(*engine), {.elapsed_us = 0, .limit_us = ample_us}).value, 0) << "not known";
}

TEST(EngineItems, LeaveFormsTheRestOfTheBudget) {
    const auto engine = test::forest_engine();
    ASSERT_TRUE(engine);
    const prepare::PreparedFrame set = prepared_forest(*engine);
    const double budget_us = 0.5 * draw(*engine, set, ample_us).report.predicted_us;
    const Drawn without = draw(*engine, set, budget_us);
    engine->offer({ItemKind::effect, 1, static_cast<float>(0.2 * budget_us), 1e12F});
    const Drawn with = draw(*engine, set, budget_us);
    EXPECT_TRUE(engine->bought(ItemKind::effect, 1));
    EXPECT_LE(with.report.predicted_us, budget_us);
    EXPECT_LT(with.report.triangles, without.report.triangles);
    EXPECT_EQ(with.report.downgraded_slices, 0U);
}

TEST(EngineItems, AResolutionBelowFullIsOneThatIsPrepaid) {
    const auto engine = test::forest_engine(0.5F);
    ASSERT_TRUE(engine);
    const prepare::PreparedFrame set = prepared_forest(*engine);
    const Drawn drawn = draw(*engine, set, ample_us);
    EXPECT_TRUE(engine->bought(ItemKind::resolution, 4));
    EXPECT_EQ(drawn.report.bought_items, 1U);
    const double enlarge_us = static_cast<double>(engine->costs().enlarge_us(0.5F, engine->options().device.viewport));
    EXPECT_NEAR(drawn.report.bought_us, enlarge_us, 0.01);
    EXPECT_NEAR(drawn.report.predicted_us, drawn.charged_us, 1e-4 * drawn.charged_us) << "charged once";
    engine->select_last();
    engine->device().draws.plays();
    const SubmitReport last = engine->submit(test::forest_pose(*engine), {.elapsed_us = 0, .limit_us = ample_us});
    EXPECT_EQ(last.bought_items, 1U);
    EXPECT_NEAR(last.bought_us, enlarge_us, 0.01);
    EXPECT_FALSE(engine->bought(ItemKind::upload, 3));
}

}  // namespace
}  // namespace surefoot
