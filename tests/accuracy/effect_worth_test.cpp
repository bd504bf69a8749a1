// The report of effects: what each costs and shows, and a page that holds it.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <nlohmann/json.hpp>

#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/path.hpp"
#include "tests/accuracy/effect_scene.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/text_pieces.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/report/report.hpp"

namespace surefoot::accuracy {
namespace {

PlacesRequest of_the_forest() {
    PlacesRequest request;
    request.model_file = test::Forest::get().model_file;
    request.path_file = test::Forest::get().path_file;
    request.state_dir = test::Forest::get().dir;
    request.width = 160;
    request.height = 90;
    request.poses = 2;
    request.repeats = 1;
    return request;
}

TEST(EffectWorth, EachEffectIsDrawnWithAndWithoutAndTheRestIsSaidToBeAbsent) {
    const auto report = measure_effects(of_the_forest(), {});
    ASSERT_TRUE(report.ok()) << report.error().text();
    std::size_t shown = 0;
    for (const EffectWorth& e : report->effects) {
        EXPECT_FALSE(e.reason.empty()) << e.name;
        if (!e.called_for) {
            EXPECT_EQ(e.shown_at, 0U) << e.name << ": nothing that nobody calls for is drawn";
        }
        if (e.shown_at == 0) continue;
        ++shown;
        EXPECT_GT(e.worth.with_ms, 0) << e.name;
        EXPECT_GT(e.worth.without_ms, 0) << e.name;
        EXPECT_LT(e.worth.psnr_db, report::max_psnr_db) << e.name << " is seen";
        EXPECT_GE(e.worth.psnr_db, report->bare.psnr_db - 6) << e.name << ": all together are worth more";
        EXPECT_FALSE(e.worth.with.empty());
        EXPECT_NE(e.worth.with, e.worth.without) << e.name;
    }
    EXPECT_GE(shown, 2U) << "the forest is lit and has colours";
    EXPECT_EQ(report->use_frames, min_use_poses);
    for (const EffectWorth& e : report->effects) {
        EXPECT_EQ(e.where.empty(), e.triangles == 0) << e.name;
        EXPECT_EQ(e.frames_share > 0, e.triangles_share > 0) << e.name;
    }
    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_effects_page(folder / "page", *report).ok());
    const auto json = nlohmann::json::parse(*read_text(folder / "page/effects.json"));
    EXPECT_EQ(json["effects"].size(), report->effects.size());
    EXPECT_GT(json["bare"]["flip"], 0);
    const std::string page = *read_text(folder / "page/index.html");
    for (const EffectWorth& e : report->effects) EXPECT_NE(page.find("<td>" + e.name + "</td>"), std::string::npos) << e.name;
    EXPECT_EQ(test::count_of(page, "<figcaption>with</figcaption>"), shown + 1);
    for (const char* way : {"all on", "as called for", "bare"})
        EXPECT_NE(page.find(std::string("<tr><td>") + way + "</td>"), std::string::npos) << way;
    for (const char* way : {"all_on", "as_called_for", "bare"}) EXPECT_GT(json["ways"][way]["ms"], 0) << way;
    for (const EffectWorth& e : report->effects) EXPECT_NE(page.find(e.reason), std::string::npos) << e.name;
}

/// The three ways and the shares of a model whose figures are known.
TEST(EffectWorth, AllOnShowsTheSamePictureByFewerPrograms) {
    const test::TemporaryFolder folder;
    PlacesRequest request = of_the_forest();
    request.model_file = folder / "three.walk";
    request.path_file = folder / "three.csv";
    ASSERT_TRUE(model::write_walk(request.model_file, test::EffectScene().model).ok());
    Path path;
    for (const double second : {0.0, 1.0}) path.samples.push_back({second, Pose{}});
    for (PathSample& sample : path.samples) sample.pose.position = dvec3(0, 0, 12);
    ASSERT_TRUE(write_path(request.path_file, path).ok());
    const auto report = measure_effects(request, {});
    ASSERT_TRUE(report.ok()) << report.error().text();

    const ThreeWays& w = report->ways;
    EXPECT_EQ(w.as_called_for.programs, 4U) << "the cluster's form has one of its own";
    EXPECT_EQ(w.all_on.programs, 2U) << "with light and without";
    EXPECT_EQ(w.bare.programs, 1U);
    EXPECT_EQ(w.as_called_for.batches, 3) << "bare, textured, lit";
    EXPECT_EQ(w.all_on.batches, 2);
    EXPECT_EQ(w.bare.batches, 1);
    EXPECT_EQ(w.all_on.difference.psnr_db, report::max_psnr_db) << "nothing changes";
    EXPECT_TRUE(w.all_on.difference.with.empty());
    EXPECT_LT(w.bare.difference.psnr_db, 40);
    for (const Way* way : {&w.all_on, &w.as_called_for, &w.bare}) {
        EXPECT_GT(way->ms, 0);
        EXPECT_GE(way->state_changes, way->batches) << "each batch begins with a change";
    }

    EXPECT_EQ(report->effects[0].name, "texture");
    EXPECT_DOUBLE_EQ(report->effects[0].frames_share, 1);
    EXPECT_DOUBLE_EQ(report->effects[0].triangles_share, 12.0 / 25);
    ASSERT_EQ(report->effects[0].where.size(), 1U);
    EXPECT_EQ(report->effects[0].where[0].name, "lamp");
    EXPECT_EQ(report->effects[1].frames_share, 0) << "no full detail has vertex colours";
    EXPECT_TRUE(report->effects[1].where.empty());
    EXPECT_FALSE(report->effects[3].called_for);

    ASSERT_TRUE(write_effects_page(folder / "page", *report).ok());
    const auto json = nlohmann::json::parse(*read_text(folder / "page/effects.json"));
    EXPECT_EQ(json["ways"]["as_called_for"]["programs"], 4);
    EXPECT_EQ(json["ways"]["all_on"]["psnr_db"], nullptr) << "equal";
    EXPECT_DOUBLE_EQ(json["effects"][0]["triangles_share"].get<double>(), 12.0 / 25);
    EXPECT_EQ(json["effects"][0]["where"][0]["objects"], 2);
    const std::string page = *read_text(folder / "page/index.html");
    EXPECT_NE(page.find("lamp (2×): 100 %"), std::string::npos);
    EXPECT_NE(page.find("coarse forms alone"), std::string::npos);
}

TEST(EffectWorth, ASkyIsShownInEveryPictureAndNoItemHasIt) {
    const test::TemporaryFolder folder;
    PlacesRequest request = of_the_forest();
    request.model_file = folder / "sky.walk";
    request.path_file = folder / "sky.csv";
    test::EffectScene scene;
    constexpr std::size_t sky_at = std::countr_zero(model::effect_sky + 0U);
    scene.model.effects[sky_at].called_for = true;
    ASSERT_EQ(scene.model.effects[sky_at].bit, model::effect_sky);
    ASSERT_TRUE(model::write_walk(request.model_file, scene.model).ok());
    Path path;
    for (const double second : {0.0, 1.0}) path.samples.push_back({second, Pose{}});
    for (PathSample& sample : path.samples) sample.pose.position = dvec3(0, 0, 12);
    ASSERT_TRUE(write_path(request.path_file, path).ok());
    const auto report = measure_effects(request, {});
    ASSERT_TRUE(report.ok()) << report.error().text();
    const EffectWorth& sky = report->effects[sky_at];
    EXPECT_TRUE(sky.called_for);
    EXPECT_EQ(sky.shown_at, request.poses);
    EXPECT_GT(sky.worth.with_ms, 0);
    EXPECT_GT(sky.worth.without_ms, 0);
    EXPECT_LT(sky.worth.psnr_db, 30) << "most of the picture is sky";
    EXPECT_GE(sky.worth.psnr_db, report->bare.psnr_db - 0.1) << "the bare way has none either";
    EXPECT_EQ(report->ways.all_on.difference.psnr_db, report::max_psnr_db) << "all on has it";
    EXPECT_EQ(report->ways.as_called_for.programs, 5U) << "one more than without it";
    EXPECT_EQ(report->ways.bare.programs, 1U);
    EXPECT_EQ(sky.frames_share, 1);
    EXPECT_EQ(sky.walked_frames, report->use_frames);
    EXPECT_EQ(sky.triangles_share, 0);
    EXPECT_EQ(sky.walked_items, 0U);
    for (const EffectWorth& e : report->effects) EXPECT_EQ(e.behind, &e == &sky) << e.name;
    ASSERT_TRUE(write_effects_page(folder / "page", *report).ok());
    const std::string page = *read_text(folder / "page/index.html");
    EXPECT_NE(page.find("behind everything</td>"), std::string::npos);
    EXPECT_NE(page.find(sky.along_path), std::string::npos);
    for (const EffectRegion& region : report->regions) EXPECT_EQ(region.effects[sky_at].reason, "it is behind everything");
}

TEST(EffectWorth, StopsWhereTheUserSaysSo) {
    const std::atomic<bool> stop = true;
    Progress progress;
    progress.stop = &stop;
    const auto report = measure_effects(of_the_forest(), progress);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().kind, ErrorKind::stopped);
}

TEST(EffectWorth, OfABackendWithoutPicturesIsRefused) {
    PlacesRequest request = of_the_forest();
    request.backend = "null";
    const auto report = measure_effects(request, {});
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(report.error().kind, ErrorKind::misuse);
}

}  // namespace
}  // namespace surefoot::accuracy
