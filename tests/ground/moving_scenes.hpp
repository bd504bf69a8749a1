// Scenes of still and moving triangles made by hand: as the walker has them, and as a judge sees them at any time.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"
#include "tests/ground/exact_ground.hpp"
#include "tests/ground/grounds.hpp"

namespace surefoot::test {

/// Turned by an angle about an axis through the pivot, then moved. Between times all is linear.
struct Stand {
    double time_s = 0;
    dvec3 move{0.0};
    double angle_rad = 0;
};

/// A thing, and how it moves: for ever, from the first stand to the last.
struct MovingThing {
    Triangles at_rest;
    std::vector<Stand> stands;  ///< the first at time 0; angles of neighbours differ by less than pi
    dvec3 pivot{0.0}, axis{0, 1, 0};

    /// Where a point is at a time. Shares nothing with what is tested: Rodrigues' formula between two stands.
    [[nodiscard]] dvec3 at(const dvec3& p, double time_s) const {
        const double in_loop_s = std::fmod(time_s, stands.back().time_s);
        std::size_t i = 0;
        while (i + 2 < stands.size() && stands[i + 1].time_s <= in_loop_s) ++i;
        const Stand &a = stands[i], &b = stands[i + 1];
        const double share = (in_loop_s - a.time_s) / (b.time_s - a.time_s);
        const double angle = a.angle_rad + share * (b.angle_rad - a.angle_rad);
        const dvec3 r = p - pivot, move = a.move + share * (b.move - a.move);
        const double c = std::cos(angle), s = std::sin(angle);
        return pivot + move + c * r + s * glm::cross(axis, r) + (1 - c) * glm::dot(axis, r) * axis;
    }
};

/// Still triangles, and things that move.
struct MovingScene {
    Triangles still;
    std::vector<MovingThing> things;

    /// The walker's model: its ground and its motions alone.
    [[nodiscard]] model::Model model() const {
        model::Model model;
        model.ground = ground_of(still);
        for (const MovingThing& thing : things) {
            std::vector<model::MotionKey> keys;
            for (const Stand& stand : thing.stands) {
                const auto s = static_cast<float>(std::sin(stand.angle_rad / 2));
                const vec3 q = s * vec3(thing.axis);
                keys.push_back({stand.time_s, stand.move, {q.x, q.y, q.z, static_cast<float>(std::cos(stand.angle_rad / 2))}});
            }
            bake::append_moving(model, thing.at_rest, thing.pivot, keys);
        }
        model::index_moving_ground(model);
        return model;
    }

    /// All that stands still, for the judge.
    [[nodiscard]] exact::ExactGround still_judge() const { return judge_of(still); }
    /// What moves, where it is at a time.
    [[nodiscard]] exact::ExactGround moving_judge(double time_s) const {
        Triangles now;
        for (const MovingThing& thing : things)
            for (const model::GroundTriangle& t : thing.at_rest)
                now.push_back({thing.at(t.a, time_s), thing.at(t.b, time_s), thing.at(t.c, time_s)});
        return judge_of(now);
    }

private:
    /// The judge takes a scene: each triangle is placed by a matrix, so that its corners keep their digits.
    static exact::ExactGround judge_of(const Triangles& triangles) {
        importer::Scene scene;
        importer::Primitive corner;
        corner.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        corner.indices = {0, 1, 2};
        scene.meshes.emplace_back().primitives.push_back(corner);
        scene.materials.emplace_back();
        for (const model::GroundTriangle& t : triangles) {
            importer::Node node;
            node.mesh = 0;
            const dvec3 u = t.b - t.a, v = t.c - t.a;
            node.world = dmat4(dvec4(u, 0), dvec4(v, 0), dvec4(glm::cross(u, v), 0), dvec4(t.a, 1));
            scene.nodes.push_back(node);
        }
        return {scene, std::vector<std::vector<bool>>(triangles.size(), std::vector<bool>{true})};
    }
};

/// A walker of a scene with its own clock, and its eye.
struct Rider {
    model::Model model;
    model::Walker walker;
    dvec3 eye{0.0};
    double time_s = 0;

    Rider(const MovingScene& scene, const dvec3& start, const model::Body& body = {})
        : model(scene.model()), walker(model, body), eye(start) {}
    Rider(const Rider&) = delete;
    Rider& operator=(const Rider&) = delete;

    /// One step with the hand's velocity.
    void step(const dvec3& velocity, double dt_s = tick_s) {
        walker.set_time(time_s += dt_s);
        eye = walker.walk(eye, eye + velocity * dt_s, dt_s);
    }
    void push(const dvec3& velocity, double seconds, double dt_s = tick_s) {
        for (double s = 0; s < seconds - 1e-9; s += dt_s) step(velocity, dt_s);
    }
    void wait(double seconds, double dt_s = tick_s) { push(dvec3(0.0), seconds, dt_s); }
};

/// A platform that starts after a second, goes `way` in `takes_s`, waits a second, and comes back.
inline MovingThing platform(const dvec3& min, const dvec3& max, const dvec3& way, double takes_s) {
    MovingThing thing;
    add_box(thing.at_rest, min, max);
    thing.stands = {{0, dvec3(0.0)}, {1, dvec3(0.0)}, {1 + takes_s, way}, {2 + takes_s, way}, {2 + 2 * takes_s, dvec3(0.0)}};
    return thing;
}

}  // namespace surefoot::test
