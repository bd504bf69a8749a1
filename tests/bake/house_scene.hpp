// A house of two rooms as one mesh: its walls have an inner and an outer side. One room is closed, the other has a window.
#pragma once

#include <array>
#include <utility>

#include "tests/bake/lit_scenes.hpp"

namespace surefoot::lit {

/// Adds a rectangle of 2 n * n triangles whose normal points along u x v.
inline void add_sheet(importer::Primitive& to, const vec3& middle, const vec3& u, const vec3& v, std::uint32_t n = 5) {
    const importer::Primitive one = sheet(middle, u, v, n);
    const auto base = static_cast<std::uint32_t>(to.positions.size());
    to.positions.insert(to.positions.end(), one.positions.begin(), one.positions.end());
    to.normals.insert(to.normals.end(), one.normals.begin(), one.normals.end());
    to.uvs.insert(to.uvs.end(), one.uvs.begin(), one.uvs.end());
    for (const std::uint32_t i : one.indices) to.indices.push_back(base + i);
}

/// Adds the six faces of a box, seen from outside or from within. without_east: the face at high.x is left out.
inline void add_faces(importer::Primitive& to, const vec3& low, const vec3& high, bool from_within, bool without_east = false) {
    const vec3 middle = 0.5F * (low + high), half = 0.5F * (high - low);
    for (int axis = 0; axis < 3; ++axis) {
        vec3 u(0), v(0), out(0);
        u[(axis + 1) % 3] = half[(axis + 1) % 3];
        v[(axis + 2) % 3] = half[(axis + 2) % 3];
        out[axis] = half[axis];
        if (axis > 0 || !without_east) from_within ? add_sheet(to, middle + out, v, u) : add_sheet(to, middle + out, u, v);
        from_within ? add_sheet(to, middle - out, u, v) : add_sheet(to, middle - out, v, u);
    }
}

/// A face at x, of y and z from low to high, around a hole of 1 m by 1 m in its middle.
inline void add_face_with_hole(importer::Primitive& to, float x, const vec2& low, const vec2& high, bool looks_east) {
    const vec2 middle = 0.5F * (low + high);
    const std::array<std::pair<vec2, vec2>, 4> around = {
        std::pair{low, vec2(high.x, middle.y - 0.5F)}, std::pair{vec2(low.x, middle.y + 0.5F), high},
        std::pair{vec2(low.x, middle.y - 0.5F), vec2(middle.x - 0.5F, middle.y + 0.5F)},
        std::pair{vec2(middle.x + 0.5F, middle.y - 0.5F), vec2(high.x, middle.y + 0.5F)}};
    for (const auto& [from, till] : around) {
        const vec2 at = 0.5F * (from + till), half = 0.5F * (till - from);
        const vec3 y(0, half.x, 0), z(0, 0, half.y), here(x, at.x, at.y);
        looks_east ? add_sheet(to, here, y, z) : add_sheet(to, here, z, y);
    }
}

/// Walls of half a metre. The west room is closed: -4.8..-0.3, 0.6..3.4, -2.4..2.4. The east room has the window.
inline importer::Primitive house() {
    importer::Primitive walls;
    add_faces(walls, vec3(-5.3F, 0, -2.9F), vec3(5.3F, 4, 2.9F), false, true);
    add_face_with_hole(walls, 5.3F, vec2(0, -2.9F), vec2(4, 2.9F), true);
    add_faces(walls, vec3(-4.8F, 0.6F, -2.4F), vec3(-0.3F, 3.4F, 2.4F), true);
    add_faces(walls, vec3(0.3F, 0.6F, -2.4F), vec3(4.8F, 3.4F, 2.4F), true, true);
    add_face_with_hole(walls, 4.8F, vec2(0.6F, -2.4F), vec2(3.4F, 2.4F), false);
    const float sill = 1.5F, top = 2.5F, middle = 5.05F, half = 0.25F;  // the reveal, between the two holes
    add_sheet(walls, vec3(middle, sill, 0), vec3(0, 0, 0.5F), vec3(half, 0, 0), 1);
    add_sheet(walls, vec3(middle, top, 0), vec3(half, 0, 0), vec3(0, 0, 0.5F), 1);
    add_sheet(walls, vec3(middle, 2, -0.5F), vec3(half, 0, 0), vec3(0, 0.5F, 0), 1);
    add_sheet(walls, vec3(middle, 2, 0.5F), vec3(0, 0.5F, 0), vec3(half, 0, 0), 1);
    return walls;
}

/// The house on a floor of 40 m, and a cup in each place: five in the closed room, one outside.
inline importer::Scene house_scene() {
    importer::Scene scene;
    put(scene, house(), "house", dvec3(0));
    put(scene, floor_of(20, 20), "ground", dvec3(0, -0.01, 0));
    const importer::Index cup = put(scene, bake::ball(4, 0.1F), "cup", dvec3(-4, 1, 0));
    for (int i = 1; i < 5; ++i) bake::place(scene, cup, dvec3(-4 + 0.7 * i, 1, 0.5 * i - 1));
    bake::place(scene, cup, dvec3(-2, 1, 8));
    return scene;
}

}  // namespace surefoot::lit
