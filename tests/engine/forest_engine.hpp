// A small forest in an engine without GL, for tests of what a frame draws.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "render/bake/bake.hpp"
#include "render/engine.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::test {

/// More time than any frame takes.
constexpr double ample_us = 1e9;

/// Baked once for all tests of the program.
inline const model::Model& forest_model() {
    static const model::Model forest = [] {
        auto scene = scenes::generate("forest", 0.5, 1);
        EXPECT_TRUE(scene.ok());
        auto model = scene ? bake::bake(scene->scene, {}, {}) : Result<model::Model>(scene.error());
        EXPECT_TRUE(model.ok());
        return model ? std::move(*model) : model::Model{};
    }();
    return forest;
}

/// Null and a failure of the test where it cannot be opened. resolution: as in EngineOptions.
inline std::unique_ptr<Engine> forest_engine(float resolution = 1) {
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.resolution = resolution;
    auto opened = Engine::open(forest_model(), model::default_costs(), options);
    EXPECT_TRUE(opened.ok());
    return opened ? std::move(*opened) : nullptr;
}

/// Most of the forest lies ahead.
inline Pose forest_pose(const Engine& engine) {
    Pose pose;
    const Box& box = engine.model().nodes[0].box;
    pose.position = box.centre() + dvec3(0, 2, 0.8 * box.half().z);
    return pose;
}

}  // namespace surefoot::test
