// Models of a few triangles for the device's tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/flat_root.hpp"
#include "render/model/model.hpp"

namespace surefoot::test {

using model::Index;

/// Builds a model of one root cluster whose children are objects with one representation each.
class SmallModel {
public:
    SmallModel() {
        model_.names = std::string(1, '\0');
        model_.nodes.emplace_back();
        model_.placements.emplace_back();
        model_.sun_direction = glm::normalize(dvec3(0.36, 0.80, 0.48));
    }
    Index material(const model::Material& material) {
        model_.materials.push_back(material);
        return static_cast<Index>(model_.materials.size() - 1);
    }
    /// One colour (RGBA bytes), side x side, with mip levels.
    Index texture(std::array<std::uint8_t, 4> left, std::array<std::uint8_t, 4> right, std::uint32_t side = 8) {
        model::Texture t;
        t.width = t.height = side;
        t.first_byte = model_.texels.size();
        std::size_t bytes = 0;
        for (std::uint32_t s = side; s > 0; s /= 2, ++t.levels) bytes += std::size_t{4} * s * s;
        model_.texels.reserve(t.first_byte + bytes);  // at once and by rows: byte by byte is slow where tests are not optimised
        model_.texels.resize(t.first_byte + bytes);
        std::byte* to = model_.texels.data() + t.first_byte;
        std::vector<std::array<std::uint8_t, 4>> row(side, left);
        for (std::uint32_t s = side; s > 0; s /= 2) {
            for (std::uint32_t x = 0; x < s; ++x) row[x] = 2 * x < s ? left : right;
            for (std::uint32_t y = 0; y < s; ++y, to += std::size_t{4} * s) std::memcpy(to, row.data(), std::size_t{4} * s);
        }
        model_.textures.push_back(t);
        return static_cast<Index>(model_.textures.size() - 1);
    }
    /// A square of half size `half` in the plane z = 0 facing +z, corner colours white, in its own object.
    Index square(Index material, const model::Placement& placement, float half = 1,
                 std::array<std::uint8_t, 4> colour = {255, 255, 255, 255}) {
        std::vector<model::Vertex> vertices;
        for (const auto& [x, y] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
            model::Vertex v{};
            v.position[0] = x * half;
            v.position[1] = y * half;
            v.normal[2] = 127;
            for (std::size_t i = 0; i < 4; ++i) v.colour[i] = colour[i];
            v.uv[0] = 0.5F + 0.5F * x;
            v.uv[1] = 0.5F - 0.5F * y;
            vertices.push_back(v);
        }
        return object(vertices, {0, 1, 2, 0, 2, 3}, material, placement);
    }
    Index triangle(Index material, std::array<vec3, 3> corners, const model::Placement& placement = {}) {
        std::vector<model::Vertex> vertices;
        for (const vec3& c : corners) {
            model::Vertex v{};
            v.position[0] = c.x;
            v.position[1] = c.y;
            v.position[2] = c.z;
            v.normal[2] = 127;
            for (auto& byte : v.colour) byte = 255;
            vertices.push_back(v);
        }
        return object(vertices, {0, 1, 2}, material, placement);
    }
    /// Returns the node.
    Index object(const std::vector<model::Vertex>& vertices, const std::vector<std::uint32_t>& indices, Index material,
                 const model::Placement& placement) {
        model::Part part;
        part.material = material;
        part.first_index = static_cast<std::uint32_t>(model_.indices.size());
        part.index_count = static_cast<std::uint32_t>(indices.size());
        part.first_vertex = static_cast<std::uint32_t>(model_.vertices.size());
        part.vertex_count = static_cast<std::uint32_t>(vertices.size());
        model_.vertices.insert(model_.vertices.end(), vertices.begin(), vertices.end());
        model_.indices.insert(model_.indices.end(), indices.begin(), indices.end());
        model_.parts.push_back(part);
        model_.placements.push_back(placement);
        model::Representation rep;
        rep.placement = static_cast<Index>(model_.placements.size() - 1);
        rep.first_part = static_cast<Index>(model_.parts.size() - 1);
        rep.part_count = 1;
        rep.triangles = part.index_count / 3;
        rep.effects = model_.materials[material].effects;
        model::Node node;
        for (const model::Vertex& v : vertices) {
            node.box.grow(placement.origin + dvec3(placement.linear * vec3(v.position[0], v.position[1], v.position[2])));
        }
        const dvec3 size = node.box.max - node.box.min;
        rep.area_m2 = {static_cast<float>(size.y * size.z), static_cast<float>(size.x * size.z),
                       static_cast<float>(size.x * size.y)};
        model_.reps.push_back(rep);
        node.parent = 0;
        node.first_rep = static_cast<Index>(model_.reps.size() - 1);
        node.rep_count = 1;
        node.triangles = rep.triangles;
        node.kind = model::NodeKind::object;
        model_.nodes.push_back(node);
        return static_cast<Index>(model_.nodes.size() - 1);
    }
    /// The root shows the first object's representation.
    model::Model finish() {
        model::make_flat_root(model_);
        return model_;
    }
    model::Model& model() { return model_; }

private:
    model::Model model_;
};

inline model::Material plain(float r, float g, float b, float a = 1, model::EffectMask effects = 0) {
    model::Material material;
    material.colour = {r, g, b, a};
    material.effects = effects;
    return material;
}

inline model::Placement at(double x, double y, double z, const mat3& linear = mat3(1.0F)) {
    model::Placement placement;
    placement.origin = dvec3(x, y, z);
    placement.linear = linear;
    return placement;
}

/// Squares of every effect, for comparisons between backends.
inline model::Model mixed_scene(std::vector<gl::DrawItem>& items) {
    SmallModel scene;
    auto leaf = plain(1, 1, 1, 1, model::effect_texture | model::effect_alpha_mask | model::effect_sun);
    leaf.texture = scene.texture({30, 200, 60, 255}, {30, 90, 200, 0}, 16);
    leaf.two_sided = true;
    auto glass = plain(0.9F, 0.4F, 0.1F, 0.4F, model::effect_blend);
    const std::array<model::Index, 4> materials{
        scene.material(leaf), scene.material(glass),
        scene.material(plain(0.8F, 0.7F, 0.6F, 1, model::effect_sun | model::effect_vertex_colour)),
        scene.material(plain(0.3F, 0.3F, 0.35F))};
    for (int i = 0; i < 40; ++i) {
        const float angle = 0.37F * static_cast<float>(i);
        const mat3 turn(glm::mat3_cast(glm::angleAxis(angle, glm::normalize(vec3(0.3F, 1, 0.1F)))));
        const double x = -2.0 + 0.45 * (i % 10), y = -1.5 + 1.0 * (i / 10.0);
        const auto node =
            scene.square(materials[static_cast<std::size_t>(i) % 4], at(x, y, -3.0 - 0.1 * i, turn), 0.5F, {200, 220, 255, 255});
        items.push_back({node, node - 1});
    }
    return scene.finish();
}

}  // namespace surefoot::test
