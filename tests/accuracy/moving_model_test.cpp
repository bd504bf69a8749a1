// A model in which something moves: its reference pictures have its shadows, and its places are drawn as of the time that was
// given.
#include <gtest/gtest.h>

#include <vector>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/accuracy/effect_use.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/accuracy/sweep.hpp"

namespace surefoot::accuracy {
namespace {

constexpr double in_view_s = 4, out_of_view_s = 0;

/// A lawn, and a ball with colours of its own that circles over it once in 8 s: at 4 s it is in view, with its shadow.
struct CirclingBall {
    test::TemporaryFolder folder;
    AccuracyRequest request;
    Pose pose;

    CirclingBall() {
        importer::Index ball = importer::none;
        importer::Scene scene = bake::lawn_with_ball_mesh(ball);
        bake::place_moving(scene, ball, dvec3(5, 2, 0), bake::add_turn(scene, dvec3(0, 2, 0), dvec3(0, 1, 0), 8));
        auto baked = bake::bake(scene, {}, {});
        EXPECT_TRUE(baked.ok());
        request.model_file = folder / "ball.walk";
        EXPECT_TRUE(model::write_walk(request.model_file, *baked).ok());
        pose.position = dvec3(-5, 14, 9);
        pose.orientation = glm::quatLookAt(glm::normalize(dvec3(-5, 0, 0) - pose.position), dvec3(0, 1, 0));
        pose.fov_y_rad = 0.6;
        Path path;
        path.samples = {{0, pose}, {1, pose}};
        request.path_file = folder / "path.csv";
        EXPECT_TRUE(write_path(request.path_file, path).ok());
        request.state_dir = folder / "";
        request.width = request.height = 64;
        request.poses = request.repeats = 1;
        request.workers = request.rasterisers = 1;
        request.selectors = {"best-first-1994"};  // without changes of single settings: each would open an engine
        request.budgets_ms = {10'000};
    }

    /// The whole picture at full detail.
    [[nodiscard]] std::vector<std::uint8_t> picture(double time_s) const {
        PlacesRequest places = static_cast<const PlacesRequest&>(request);
        places.time_s = time_s;
        auto opened = open_engine_of_places(places, std::move(*model::read_walk(request.model_file)), 0, {});
        EXPECT_TRUE(opened.ok());
        Engine& engine = *opened->engine;
        engine.device().bind();
        engine.draw_unbudgeted(pose, engine.full_detail(pose));
        auto image = engine.device().read_pixels();
        EXPECT_TRUE(image.ok());
        engine.device().release();
        return image->rgba;
    }
};

const CirclingBall& circling_ball() {
    static const CirclingBall ball;
    return ball;
}

}  // namespace

TEST(AccuracyOfMoving, FullDetailIsDrawnAsOfTheTime) {
    const auto first = circling_ball().picture(in_view_s);
    EXPECT_EQ(first, circling_ball().picture(in_view_s)) << "it equals itself";
    EXPECT_TRUE(first != circling_ball().picture(out_of_view_s));
}

/// The cut has what moves only if it is prepared for that time, and the reference has its shadow only if the map is drawn.
TEST(AccuracyOfMoving, AnAmpleBudgetShowsWhatFullDetailShows) {
    AccuracyRequest request = circling_ball().request;
    for (const double time_s : {out_of_view_s, in_view_s}) {
        request.time_s = time_s;
        const auto run = run_accuracy(request, {});
        ASSERT_TRUE(run.ok()) << run.error().text();
        ASSERT_EQ(run->points.size(), 1U);
        EXPECT_GT(run->points[0].psnr_db, 60) << time_s;
        EXPECT_EQ(run->points[0].exact, 1U) << time_s;
        EXPECT_EQ(run->points[0].triangles > 100, time_s == in_view_s) << "of the ball: the lawn has few in view";
    }
}

/// Budgets that buy the forms of an ample one, and not its shadow map. Earlier pictures had the map.
TEST(AccuracyOfMoving, ABudgetThatDoesNotBuyTheShadowMapShowsNone) {
    AccuracyRequest request = circling_ball().request;
    request.time_s = in_view_s;
    for (int i = 1; i <= 30; ++i) request.budgets_ms.push_back(0.05 * i);
    const auto run = run_accuracy(request, {});
    ASSERT_TRUE(run.ok()) << run.error().text();
    const AccuracyPoint& ample = run->points.front();
    EXPECT_GT(ample.psnr_db, 60);
    constexpr double map_us = 100;  // takes more
    int without = 0;
    for (const AccuracyPoint& point : run->points) {
        if (point.triangles != ample.triangles || point.cost_us > ample.cost_us - map_us) continue;
        ++without;
        EXPECT_LT(point.psnr_db, 45) << point.budget_ms << " ms";
    }
    EXPECT_GT(without, 0);
}

TEST(AccuracyOfMoving, EffectsAreCountedAsOfTheTime) {
    EffectReport early, late;
    for (const double time_s : {out_of_view_s, in_view_s}) {
        PlacesRequest request = static_cast<const PlacesRequest&>(circling_ball().request);
        request.time_s = time_s;
        auto report = measure_effects(request, {});
        ASSERT_TRUE(report.ok()) << report.error().text();
        (time_s == in_view_s ? late : early) = std::move(*report);
    }
    ASSERT_EQ(early.effects.size(), late.effects.size());
    bool differ = false;
    for (std::size_t e = 0; e < early.effects.size(); ++e)
        differ = differ || early.effects[e].worth.with != late.effects[e].worth.with;
    EXPECT_TRUE(differ) << "pictures";
}

TEST(AccuracyOfMoving, WhatAWalkDrawsIsCountedAsOfTheTime) {
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = {64, 64};
    auto engine = Engine::open(std::move(*model::read_walk(circling_ball().request.model_file)), model::default_costs(), options);
    ASSERT_TRUE(engine.ok()) << engine.error().text();
    const auto triangles = [&](double time_s) {
        (*engine)->set_time(time_s);
        const UseOfEffects use = measure_use(**engine, std::vector<Pose>{circling_ball().pose}, {}, time_s);
        return use.walked.triangles;
    };
    EXPECT_LT(triangles(out_of_view_s), 100U) << "the lawn alone, as a pixel's size allows it";
    EXPECT_GT(triangles(in_view_s), 100U) << "with the ball";
}

}  // namespace surefoot::accuracy
