// Scenes of a few meshes made by hand, for the tests of the exact judge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "render/import/scene.hpp"
#include "rt/base/geometry.hpp"
#include "tests/ground/exact_ground.hpp"

namespace surefoot::exact {

using Blocks = std::vector<std::vector<bool>>;

inline std::vector<bool> all(std::size_t count, bool blocks) { return std::vector<bool>(count, blocks); }

inline dmat4 moved(double x, double y, double z) {
    dmat4 world(1.0);
    world[3] = dvec4(x, y, z, 1.0);
    return world;
}

inline dmat4 scaled(double x, double y, double z) {
    dmat4 world(1.0);
    world[0][0] = x;
    world[1][1] = y;
    world[2][2] = z;
    return world;
}

/// Two triangles from `corner` along `u` and `v`. With uvs the whole image lies on them, upright along v.
inline void add_quad(importer::Primitive& to, const vec3& corner, const vec3& u, const vec3& v, bool with_uvs = false) {
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    to.positions.insert(to.positions.end(), {corner, corner + u, corner + u + v, corner + v});
    if (with_uvs) to.uvs.insert(to.uvs.end(), {vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)});
    to.indices.insert(to.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

/// Twelve triangles: two for each of the sides at low z, high z, low x, high x, low y and high y.
inline void add_box(importer::Primitive& to, const vec3& corner, const vec3& size) {
    const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    add_quad(to, corner, x, y);
    add_quad(to, corner + z, x, y);
    add_quad(to, corner, y, z);
    add_quad(to, corner + x, y, z);
    add_quad(to, corner, x, z);
    add_quad(to, corner + y, x, z);
}

inline importer::Primitive one_quad(const vec3& corner, const vec3& u, const vec3& v) {
    importer::Primitive primitive;
    add_quad(primitive, corner, u, v);
    return primitive;
}

inline importer::Primitive one_box(const vec3& corner, const vec3& size) {
    importer::Primitive primitive;
    add_box(primitive, corner, size);
    return primitive;
}

/// Adds to a scene whose material 0 is opaque. Each function returns the number of what it adds.
struct SceneMaker {
    importer::Scene scene;

    SceneMaker() { scene.materials.emplace_back(); }

    importer::Index add_material(model::AlphaMode mode, float factor, importer::Index image, float cutoff = 0.5F) {
        importer::Material material;
        material.alpha = mode;
        material.colour[3] = factor;
        material.image = image;
        material.alpha_cutoff = cutoff;
        scene.materials.push_back(material);
        return static_cast<importer::Index>(scene.materials.size() - 1);
    }

    /// `alpha` of column and row, 0 to 255.
    importer::Index add_image(std::uint32_t width, std::uint32_t height,
                              const std::function<int(std::uint32_t, std::uint32_t)>& alpha) {
        image::Image picture;
        picture.width = width;
        picture.height = height;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                picture.rgba.insert(picture.rgba.end(), 3, 200);
                picture.rgba.push_back(static_cast<std::uint8_t>(alpha(x, y)));
            }
        }
        scene.images.push_back(std::move(picture));
        return static_cast<importer::Index>(scene.images.size() - 1);
    }

    /// Holes with bars between them, as wide as one texel in four.
    importer::Index add_barred_material() {
        const importer::Index bars = add_image(16, 16, [](std::uint32_t x, std::uint32_t) { return x % 4 == 0 ? 255 : 0; });
        return add_material(model::AlphaMode::mask, 1, bars);
    }

    /// A node with a mesh of its own.
    importer::Index add(std::vector<importer::Primitive> primitives, const dmat4& world = dmat4(1.0),
                        importer::WalkRule walk = importer::WalkRule::by_rule) {
        importer::Mesh mesh;
        mesh.primitives = std::move(primitives);
        scene.meshes.push_back(std::move(mesh));
        return add_node(static_cast<importer::Index>(scene.meshes.size() - 1), world, walk);
    }

    importer::Index add_node(importer::Index mesh, const dmat4& world, importer::WalkRule walk = importer::WalkRule::by_rule) {
        importer::Node node;
        node.mesh = mesh;
        node.world = world;
        node.walk = walk;
        scene.nodes.push_back(node);
        return static_cast<importer::Index>(scene.nodes.size() - 1);
    }
};

}  // namespace surefoot::exact
