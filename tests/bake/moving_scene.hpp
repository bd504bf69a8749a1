// A small town in which things move: a wheel of three parts that turns, a lift, and a ball that circles on a turning arm.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/bake/scenes.hpp"

namespace surefoot::bake {

inline std::array<float, 4> turn_about(const dvec3& axis, double angle_rad) {
    const dquat q = glm::angleAxis(angle_rad, axis);
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}

inline importer::Index add_scene_motion(importer::Scene& scene, const dvec3& pivot, const std::vector<model::MotionKey>& keys,
                                        importer::Index outer = importer::none) {
    scene.motions.push_back({pivot, static_cast<std::uint32_t>(scene.motion_keys.size()), static_cast<std::uint32_t>(keys.size()),
                             keys.back().time_s, outer});
    scene.motion_keys.insert(scene.motion_keys.end(), keys.begin(), keys.end());
    return static_cast<importer::Index>(scene.motions.size() - 1);
}

/// One whole turn about an axis through the pivot, by keys of 90 degrees.
inline importer::Index add_turn(importer::Scene& scene, const dvec3& pivot, const dvec3& axis, double period_s,
                                importer::Index outer = importer::none) {
    std::vector<model::MotionKey> keys;
    for (int k = 0; k <= 4; ++k) keys.push_back({period_s * k / 4, dvec3(0), turn_about(axis, 0.5 * std::numbers::pi * k)});
    return add_scene_motion(scene, pivot, keys, outer);
}

/// To a place and back.
inline importer::Index add_lift(importer::Scene& scene, const dvec3& way, double period_s,
                                importer::Index outer = importer::none) {
    const std::array<float, 4> straight{0, 0, 0, 1};
    return add_scene_motion(scene, dvec3(0),
                            {{0, dvec3(0), straight},
                             {0.4 * period_s, way, straight},
                             {0.6 * period_s, way, straight},
                             {period_s, dvec3(0), straight}},
                            outer);
}

inline void place_moving(importer::Scene& scene, importer::Index mesh, const dvec3& at, importer::Index motion,
                         const dvec3& scale = dvec3(1)) {
    place(scene, mesh, at, scale);
    scene.nodes.back().motion = motion;
}

inline importer::Scene moving_town() {
    importer::Scene scene = small_town();
    importer::Primitive red = ball(16, 1);
    red.material = 1;
    const auto part = add_mesh(scene, red, "part");
    const auto wheel = add_turn(scene, dvec3(40, 20, 40), dvec3(0, 0, 1), 8);
    for (int i = 0; i < 3; ++i) place_moving(scene, part, dvec3(36 + 4 * i, 20, 40), wheel, dvec3(1.5, 1, 1));
    place_moving(scene, part, dvec3(70, 6, 60), add_lift(scene, dvec3(0, 12, 0), 10), dvec3(2, 1, 2));
    const auto arm = add_turn(scene, dvec3(20, 8, 80), dvec3(0, 1, 0), 20);
    place_moving(scene, part, dvec3(26, 8, 80), add_turn(scene, dvec3(26, 8, 80), dvec3(1, 0, 0), 3, arm), dvec3(1, 0.3, 2));
    return scene;
}

/// A scene of a lawn of 40 m, and the mesh of a red ball for it. unlit: both materials are.
inline importer::Scene lawn_with_ball_mesh(importer::Index& ball_mesh, bool unlit = false) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(2);
    scene.materials[1].colour = {0.8F, 0.2F, 0.1F, 1};
    for (importer::Material& material : scene.materials) material.unlit = unlit;
    const auto lawn =
        add_mesh(scene, grid_surface(20, 20, [](float u, float v) { return vec3(40 * v - 20, 0, 40 * u - 20); }), "lawn");
    importer::Primitive red = ball(12, 1);
    red.material = 1;
    ball_mesh = add_mesh(scene, red, "ball");
    place(scene, lawn, dvec3(0));
    return scene;
}

}  // namespace surefoot::bake
