// Scenes for tests of baked light: squares that face where they should, and rays through them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "render/bake/scene_light.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::lit {

const bake::ForAll one_by_one = [](std::size_t count, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < count; ++i) body(i);
};

/// Of 2 n * n triangles. Its normal points along u x v.
inline importer::Primitive sheet(const vec3& middle, const vec3& u, const vec3& v, std::uint32_t n = 1,
                                 importer::Index material = 0) {
    importer::Primitive p =
        bake::grid_surface(n, n, [&](float s, float t) { return middle + (2 * s - 1) * u + (2 * t - 1) * v; });
    for (auto& normal : p.normals) normal = glm::normalize(glm::cross(u, v));
    p.material = material;
    return p;
}

/// Level, and looks up.
inline importer::Primitive floor_of(float half_m, std::uint32_t n = 1) {
    return sheet(vec3(0), vec3(0, 0, half_m), vec3(half_m, 0, 0), n);
}

/// What stands on a floor and throws a shadow. Its own triangles are too small to be cut.
inline importer::Primitive post(float radius_m = 0.3F, float height_m = 6) { return bake::tube(12, radius_m, height_m); }

inline importer::Lamp bulb(const dvec3& at, double candela) {
    importer::Lamp lamp;
    lamp.at = at;
    lamp.candela = candela;
    return lamp;
}

/// Adds a mesh and places it.
inline importer::Index put(importer::Scene& scene, importer::Primitive primitive, const std::string& name, const dvec3& at) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    const importer::Index mesh = bake::add_mesh(scene, std::move(primitive), name);
    bake::place(scene, mesh, at);
    return mesh;
}

}  // namespace surefoot::lit
