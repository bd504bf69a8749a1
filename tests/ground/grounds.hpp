// Grounds made of a few triangles by hand.
#pragma once

#include <vector>

#include "render/bake/ground_build.hpp"
#include "render/model/ground.hpp"
#include "render/model/ground/capsule.hpp"
#include "render/model/ground/walker.hpp"

namespace surefoot::test {

using Triangles = std::vector<model::GroundTriangle>;

inline void add_quad(Triangles& to, const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    to.push_back({a, b, c});
    to.push_back({a, c, d});
}

/// A level floor.
inline void add_floor(Triangles& to, double x0, double x1, double z0, double z1, double y) {
    add_quad(to, {x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0});
}

/// An upright wall from (x0, z0) to (x1, z1).
inline void add_wall(Triangles& to, const dvec2& from, const dvec2& until, double low, double high) {
    add_quad(to, {from.x, low, from.y}, {until.x, low, until.y}, {until.x, high, until.y}, {from.x, high, from.y});
}

/// A box with all of its six sides, which face outwards.
inline void add_box(Triangles& to, const dvec3& min, const dvec3& max) {
    add_floor(to, max.x, min.x, min.z, max.z, min.y);
    add_floor(to, min.x, max.x, min.z, max.z, max.y);
    add_wall(to, {max.x, min.z}, {min.x, min.z}, min.y, max.y);
    add_wall(to, {max.x, max.z}, {max.x, min.z}, min.y, max.y);
    add_wall(to, {min.x, max.z}, {max.x, max.z}, min.y, max.y);
    add_wall(to, {min.x, min.z}, {min.x, max.z}, min.y, max.y);
}

inline model::Ground ground_of(const Triangles& triangles) {
    model::Ground ground;
    bake::append(ground, bake::build_tree(triangles, 1.0 / 4096));
    model::index_instances(ground);
    return ground;
}

constexpr double tick_s = 0.002;

/// Pushes the walker level along `velocity` for a time. Returns where the eye is then.
inline dvec3 push(model::Walker& walker, dvec3 eye, const dvec3& velocity, double seconds) {
    for (double t = 0; t < seconds; t += tick_s) eye = walker.walk(eye, eye + velocity * tick_s, tick_s);
    return eye;
}

}  // namespace surefoot::test
