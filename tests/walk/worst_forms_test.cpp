// Which forms cost the pictures most: what stands in for an item, where a box shows, and what a walk's report says of it.
#include "tools/walk/worst_forms.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/path.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

using walk::PixelRect;

/// Root 0 over 1 and 2; 1 over 3 and 4. Each has a coarse form and a fine one: node n has the forms 2n and 2n + 1.
model::Model tree_of_two_forms() {
    model::Model model;
    model.nodes.resize(5);
    model.reps.resize(10);
    for (model::Index n = 0; n < 5; ++n) {
        model.nodes[n].first_rep = 2 * n;
        model.nodes[n].rep_count = 2;
        model.reps[2 * n].error_m = 1;
    }
    for (const auto& [child, parent] : {std::pair{1U, 0U}, {2U, 0U}, {3U, 1U}, {4U, 1U}}) {
        model.nodes[child].parent = parent;
        ++model.nodes[parent].child_count;
    }
    return model;
}

TEST(WorstForms, FullDetailStandsInForWhatIsBelowTheItem) {
    const model::Model model = tree_of_two_forms();
    const std::vector<gl::DrawItem> full{{2, 5}, {3, 7}, {4, 9}};
    const auto below = walk::full_detail_below(model, std::vector<gl::DrawItem>{{1, 3}, {2, 4}}, full);
    ASSERT_EQ(below.size(), 2U);
    ASSERT_EQ(below[0].size(), 2U) << "the leaves of the cluster, even for its finest form";
    EXPECT_EQ(below[0][0].rep, 7U);
    EXPECT_EQ(below[0][1].rep, 9U);
    ASSERT_EQ(below[1].size(), 1U);
    EXPECT_EQ(below[1][0].rep, 5U);
    const auto leaves = walk::full_detail_below(model, std::vector<gl::DrawItem>{{2, 5}, {3, 6}, {4, 9}}, {&full[1], 2});
    EXPECT_TRUE(leaves[0].empty()) << "full detail already";
    EXPECT_EQ(leaves[1].size(), 1U);
    EXPECT_TRUE(leaves[2].empty());
}

TEST(WorstForms, ABoxShowsWhereItIsProjected) {
    const Pose pose;  // at the origin, looks along -z
    const model::Viewport viewport{200, 100};
    const PixelRect ahead = walk::pixels_of({{-1, -1, -101}, {1, 1, -99}}, pose, viewport);
    EXPECT_LT(ahead.x0, 100U);
    EXPECT_GT(ahead.x1, 100U);
    EXPECT_LT(ahead.x1 - ahead.x0, 10U);
    EXPECT_LT(ahead.y1 - ahead.y0, 10U);
    const PixelRect high = walk::pixels_of({{-1, 20, -101}, {1, 22, -99}}, pose, viewport);
    EXPECT_LT(high.y1, ahead.y0) << "rows count from the top";
    const PixelRect behind = walk::pixels_of({{-1, -1, 99}, {1, 1, 101}}, pose, viewport);
    EXPECT_TRUE(behind.empty());
    const PixelRect right = walk::pixels_of({{1, -1, -101}, {3, 1, 5}}, pose, viewport);  // reaches past the eye
    EXPECT_GT(right.x0, 99U) << "what is before the eye lies to the right";
    EXPECT_EQ(right.x1, 200U);
    const PixelRect around = walk::pixels_of({{-1, -1, -1}, {1, 1, 1}}, pose, viewport);
    EXPECT_EQ(around.x1 - around.x0, 200U);
    EXPECT_EQ(around.y1 - around.y0, 100U);
    const PixelRect beside = walk::pixels_of({{500, -1, -101}, {502, 1, -99}}, pose, viewport);
    EXPECT_EQ(beside.x0, beside.x1);
}

/// Only a library that is not here is a reason to skip: one that fails is a failure.
bool lacks_egl(const Error& error) {
    const std::string text = error.text();
    return text.find("libEGL.so.1") != std::string::npos && text.find("The library cannot be opened") != std::string::npos;
}

/// A frame of these items, drawn as a report does.
struct DrawnFrame {
    walk::FrameSnapshot snapshot;
    std::vector<report::ReportSnapshot> pictures;
    DrawnFrame(Engine& engine, const Pose& pose, std::vector<gl::DrawItem> items, float resolution) {
        snapshot.pose = pose;
        snapshot.resolution = resolution;
        snapshot.items = std::move(items);
        auto drawn = walk::render_snapshot(engine, snapshot);
        EXPECT_TRUE(drawn.ok());
        pictures.push_back(std::move(*drawn));
    }
};

TEST(WorstForms, TheOnlyFormHasAllOfTheErrorAndFullDetailOnlyTheResolutions) {
    const auto path = read_path(test::Forest::get().path_file);
    ASSERT_TRUE(path.ok());
    const Pose pose = sample_path(*path, 1);
    auto model = model::read_walk(test::Forest::get().model_file);
    ASSERT_TRUE(model.ok());
    EngineOptions options;
    options.device.viewport = {320, 180};
    auto engine = Engine::open(std::move(*model), model::default_costs(), options);
    if (!engine.ok() && lacks_egl(engine.error())) GTEST_SKIP() << engine.error().text();
    ASSERT_TRUE(engine.ok()) << engine.error().text();
    (*engine)->device().bind();
    (*engine)->device().draws.plays();

    const gl::DrawItem root{0, (*engine)->model().nodes[0].first_rep};
    const DrawnFrame coarse(**engine, pose, {root}, 1);
    ASSERT_GT(coarse.pictures[0].mse, 0);
    walk::WorstForms of_root(**engine);
    ASSERT_TRUE(of_root.add(coarse.snapshot, coarse.pictures, 0, {}).ok());
    const auto forms = of_root.list(8, coarse.pictures);
    ASSERT_EQ(forms.size(), 1U);
    EXPECT_EQ(forms[0].node, 0U);
    EXPECT_DOUBLE_EQ(forms[0].error_share, 1) << "in its place, full detail has no error";
    EXPECT_EQ(forms[0].pictures, 1U);
    EXPECT_EQ(of_root.resolution_share(), 0);

    const DrawnFrame soft(**engine, pose, (*engine)->full_detail(pose), 0.5F);
    ASSERT_GT(soft.pictures[0].mse, 0);
    walk::WorstForms of_full_detail(**engine);
    ASSERT_TRUE(of_full_detail.add(soft.snapshot, soft.pictures, 0, {}).ok());
    EXPECT_TRUE(of_full_detail.list(8, soft.pictures).empty());
    EXPECT_DOUBLE_EQ(of_full_detail.resolution_share(), 1) << "all of it is blur";
}

TEST(WorstForms, OfAWalkStandInItsReportAndCostWhatTheyCost) {
    walk::WalkRequest request = test::Forest::get().virtual_request(24);
    request.backend = "egl";
    request.width = 320;
    request.height = 180;
    request.budget_ms = 2;
    request.pictures = 2;
    request.report_dir = test::Forest::get().dir + "/worst";
    const auto outcome = walk::run_walk(request, {}, {});
    if (!outcome.ok() && lacks_egl(outcome.error())) GTEST_SKIP() << outcome.error().text();
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    const auto& forms = outcome->summary.picture.worst_forms;
    ASSERT_FALSE(forms.empty());
    for (std::size_t i = 0; i < forms.size(); ++i) {
        EXPECT_GT(forms[i].error_share, 0);
        EXPECT_LE(forms[i].error_share, 1);
        EXPECT_GE(forms[i].pictures, 1U);
        if (i > 0) {
            EXPECT_LE(forms[i].error_share, forms[i - 1].error_share);
        }
        EXPECT_GT(forms[i].width, 0U);
        EXPECT_GT(forms[i].height, 0U);
        EXPECT_NE(forms[i].walk, forms[i].full) << "the part shows what is wrong";
        EXPECT_EQ(forms[i].walk.size(), std::size_t{4} * forms[i].width * forms[i].height);
        EXPECT_EQ(forms[i].full.size(), forms[i].walk.size());
    }
    EXPECT_GE(outcome->summary.picture.resolution_error_share, 0);
    const auto json = nlohmann::json::parse(*read_text(request.report_dir + "/walk.json"));
    EXPECT_EQ(json["picture"]["worst_forms"].size(), forms.size());
    EXPECT_EQ(json["picture"]["worst_forms"][0]["node"], forms[0].node);
    EXPECT_NE(read_text(request.report_dir + "/index.html")->find("Forms that cost most"), std::string::npos);
}

}  // namespace
}  // namespace surefoot
