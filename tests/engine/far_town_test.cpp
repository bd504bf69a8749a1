// A town from so far off that all of it is within 64 pixels: its floor is one picture, and so is what an accuracy buys that it
// has.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "render/bake/bake.hpp"
#include "render/engine.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot {
namespace {

constexpr double town_px = 64, town_budget_us = 33'000;

/// A small town in an engine without GL.
std::unique_ptr<Engine> town_engine() {
    auto scene = scenes::generate(scenes::town_name, 0.02, 1);
    EXPECT_TRUE(scene.ok());
    if (!scene) return nullptr;
    auto model = bake::bake(scene->scene, {}, {});
    EXPECT_TRUE(model.ok());
    if (!model) return nullptr;
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    auto opened = Engine::open(std::move(*model), model::default_costs(), options);
    EXPECT_TRUE(opened.ok());
    return opened ? std::move(*opened) : nullptr;
}

TEST(FarTown, IsOnePicture) {
    const std::unique_ptr<Engine> engine = town_engine();
    ASSERT_NE(engine, nullptr);
    const model::Model& m = engine->model();
    ASSERT_GT(m.nodes.size(), 100U);
    const Box& box = m.nodes[0].box;
    Pose pose;
    const double pixel_rad = 2 * std::tan(0.5 * pose.fov_y_rad) / engine->options().device.viewport.height;
    const double distance_m = box.diagonal() / (town_px * pixel_rad);  // the sphere about it is as wide as 64 pixels
    pose.position = box.centre() + dvec3(0, 0, distance_m);
    prepare::PreparedFrame prepared;
    engine->reserve(prepared);
    engine->prepare({pose, 0, 0}, 0, 0, 0, prepared);
    const auto expect_picture = [&](const select::Cut& cut, const char* what) {
        ASSERT_EQ(cut.items.size(), 1U) << what;
        EXPECT_EQ(cut.items[0].node, 0U) << what;
        EXPECT_EQ(m.reps[cut.items[0].rep].kind, model::RepKind::textured_box) << what;
        EXPECT_EQ(cut.triangles, 12U) << what;
    };
    expect_picture(engine->select(prepared, 0, {}, 0), "the floor");
    const double error_rad = static_cast<double>(m.reps[m.nodes[0].first_rep].error_m) / box.distance(pose.position);
    expect_picture(engine->select(prepared, town_budget_us, {}, 1.01 * error_rad), "an accuracy that the picture has");
    EXPECT_LT(error_rad / pixel_rad, town_px) << "off by less than the town's size";
    EXPECT_GT(engine->select(prepared, town_budget_us, {}, error_rad / 16).items.size(), 1U) << "a finer one";
}

}  // namespace
}  // namespace surefoot
