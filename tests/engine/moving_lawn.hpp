// A lawn over which a ball circles, and a planner of its shadow map.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "render/bake/bake.hpp"
#include "render/moving_shadow.hpp"
#include "tests/bake/moving_scene.hpp"

namespace surefoot::test {

/// A lawn, a ball that circles over it once in 8 s, and a ball that stands far away.
inline importer::Scene lawn_and_ball(bool unlit = false) {
    importer::Index ball = importer::none;
    importer::Scene scene = bake::lawn_with_ball_mesh(ball, unlit);
    bake::place(scene, ball, dvec3(500, 1, 0));
    bake::place_moving(scene, ball, dvec3(5, 3, 0), bake::add_turn(scene, dvec3(0, 3, 0), dvec3(0, 1, 0), 8));
    return scene;
}

inline const model::Model& baked_lawn() {
    static const model::Model baked = [] {
        auto m = bake::bake(lawn_and_ball(), {}, {});
        EXPECT_TRUE(m.ok());
        return std::move(*m);
    }();
    return baked;
}

inline Pose over_the_lawn() {
    Pose pose;
    pose.position = dvec3(0, 12, 20);
    pose.orientation = glm::quatLookAt(glm::normalize(dvec3(0, 0, 0) - pose.position), dvec3(0, 1, 0));
    return pose;
}

inline constexpr model::Viewport lawn_picture{320, 180};
inline const ShadowEye eye_of_lawn{over_the_lawn(), lawn_picture};

/// A planner, and the scene at a time.
struct PlannedLawn {
    const model::Model& m;
    model::MovingNodes moving{m};
    model::MotionPoses poses{m};
    model::Daylight light = model::daylight_of_model(m.sun_direction, m.light);
    MovingShadow shadow;

    explicit PlannedLawn(const model::Model& of = baked_lawn(), const ShadowLimits& limits = {}) : m(of), shadow(m, limits) {}
    PlannedLawn(const PlannedLawn&) = delete;
    PlannedLawn& operator=(const PlannedLawn&) = delete;
    ShadowScene at(double time_s) {
        moving.set_span(time_s, time_s);
        poses.set_time(time_s);
        return {m, moving, poses, light, time_s};
    }
};

}  // namespace surefoot::test
