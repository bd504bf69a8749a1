// Small scenes by hand: the shapes that simplifiers and clusterers get wrong.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "render/import/scene.hpp"
#include "rt/base/random.hpp"

namespace surefoot::bake {

inline importer::Primitive grid_surface(std::uint32_t nu, std::uint32_t nv, const std::function<vec3(float, float)>& at) {
    importer::Primitive p;
    for (std::uint32_t j = 0; j <= nv; ++j) {
        for (std::uint32_t i = 0; i <= nu; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(nu), v = static_cast<float>(j) / static_cast<float>(nv);
            p.positions.push_back(at(u, v));
            p.normals.push_back({0, 1, 0});
            p.uvs.push_back({u, v});
        }
    }
    for (std::uint32_t j = 0; j < nv; ++j) {
        for (std::uint32_t i = 0; i < nu; ++i) {
            const std::uint32_t a = j * (nu + 1) + i, b = a + 1, c = a + nu + 1, d = c + 1;
            p.indices.insert(p.indices.end(), {a, b, d, a, d, c});
        }
    }
    return p;
}

/// Open at the poles, so that no triangle has zero area.
inline importer::Primitive ball(std::uint32_t n, float radius_m) {
    return grid_surface(2 * n, n, [=](float u, float v) {
        const float a = u * 6.2831853F, b = (0.02F + 0.96F * v) * 3.1415927F;
        return radius_m * vec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
    });
}

inline importer::Primitive tube(std::uint32_t n, float radius_m, float height_m) {
    return grid_surface(8, n, [=](float u, float v) {
        return vec3(radius_m * std::cos(u * 6.2831853F), height_m * v, radius_m * std::sin(u * 6.2831853F));
    });
}

inline importer::Primitive hills(std::uint32_t n, float size_m) {
    return grid_surface(n, n,
                        [=](float u, float v) { return vec3(size_m * u, 3 * std::sin(9 * u) * std::cos(7 * v), size_m * v); });
}

inline importer::Index add_mesh(importer::Scene& scene, importer::Primitive primitive, const std::string& name) {
    scene.meshes.push_back({name, {std::move(primitive)}});
    return static_cast<importer::Index>(scene.meshes.size() - 1);
}

inline void place(importer::Scene& scene, importer::Index mesh, const dvec3& at, const dvec3& scale = dvec3(1)) {
    importer::Node node;
    node.name = scene.meshes[mesh].name;
    node.mesh = mesh;
    node.world[0][0] = scale.x, node.world[1][1] = scale.y, node.world[2][2] = scale.z;
    node.world[3] = dvec4(at, 1);
    scene.nodes.push_back(node);
}

/// Ground, balls (one stretched, one mirrored), lamp posts far thinner than any cell, and a crumb far from all.
inline importer::Scene small_town(const dvec3& at = dvec3(0)) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(2);
    scene.materials[1].colour = {0.8F, 0.2F, 0.1F, 1};
    image::Image image;
    image.width = image.height = 4;
    for (int i = 0; i < 16; ++i) image.rgba.insert(image.rgba.end(), {static_cast<std::uint8_t>(16 * i), 90, 60, 255});
    scene.images.push_back(image);
    scene.materials[0].image = 0;
    importer::Primitive red = ball(24, 1);
    red.material = 1;
    const auto ground = add_mesh(scene, hills(40, 100), "ground");
    const auto sphere = add_mesh(scene, red, "ball");
    const auto post = add_mesh(scene, tube(12, 0.05F, 6), "post");
    const auto crumb = add_mesh(scene, tube(1, 0.02F, 0.03F), "crumb");
    place(scene, ground, at);
    for (int i = 0; i < 12; ++i) {
        place(scene, sphere, at + dvec3(10 + 7 * i, 5, 20 + i % 3),
              i == 4   ? dvec3(1, 4, 0.5)
              : i == 5 ? dvec3(-1, 1, 1)
                       : dvec3(1));
        place(scene, post, at + dvec3(8 + 7 * i, 2, 50));
    }
    place(scene, crumb, at + dvec3(300, 40, -90));
    return scene;
}

}  // namespace surefoot::bake
