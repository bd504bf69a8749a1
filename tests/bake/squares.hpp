// Models of squares that face +Z: each is an object, and a form of its own.
#pragma once

#include <array>
#include <vector>

#include "render/bake/form_picture.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

const Direction front = direction_of(0, 0);
const Box unit_box{dvec3(0, 0, -0.5), dvec3(1, 1, 0.5)};

/// From (x, 0, z) to (x + size, size, z); plain red.
struct Square {
    float x = 0, z = 0, size = 1;
    std::array<float, 4> colour{1, 0, 0, 1};
    model::AlphaMode alpha = model::AlphaMode::opaque;
    bool two_sided = false, textured = false;
};

/// A board of black and white texels, and its grey mip levels.
inline void add_board(model::Model& m, std::uint32_t side) {
    m.textures.push_back({side, side, 0, m.texels.size(), false});
    for (std::uint32_t wide = side; wide > 0; wide /= 2, ++m.textures.back().levels) {
        for (std::uint32_t i = 0; i < wide * wide; ++i) {
            const auto shade = static_cast<std::byte>(wide < side ? 128 : (i % side + i / side) % 2 * 255);
            for (int channel = 0; channel < 4; ++channel) m.texels.push_back(channel == 3 ? std::byte{255} : shade);
        }
    }
}

/// Forms without nodes: reps[i] is the i-th square. Texture 0 is a board of 64 x 64 texels.
inline model::Model squares(const std::vector<Square>& list) {
    model::Model m;
    m.placements.emplace_back();
    add_board(m, 64);
    for (const Square& square : list) {
        model::Material material;
        material.colour = square.colour;
        material.alpha = square.alpha;
        material.two_sided = square.two_sided;
        if (square.textured) {
            material.colour = {1, 1, 1, 1};
            material.texture = 0;
            material.effects = model::effect_texture;
        }
        model::Part part{static_cast<model::Index>(m.materials.size()), static_cast<std::uint32_t>(m.indices.size()), 6,
                         static_cast<std::uint32_t>(m.vertices.size()), 4};
        m.materials.push_back(material);
        for (int corner = 0; corner < 4; ++corner) {
            model::Vertex v{};
            v.uv[0] = static_cast<float>(corner % 2);
            v.uv[1] = corner < 2 ? 0.0F : 1.0F;
            v.position[0] = square.x + square.size * v.uv[0];
            v.position[1] = square.size * v.uv[1];
            v.position[2] = square.z;
            m.vertices.push_back(v);
        }
        for (const std::uint32_t i : {0U, 1U, 3U, 0U, 3U, 2U}) m.indices.push_back(i);
        model::Representation rep;
        rep.first_part = static_cast<model::Index>(m.parts.size());
        rep.part_count = 1;
        rep.triangles = 2;
        m.parts.push_back(part);
        m.reps.push_back(rep);
    }
    return m;
}

}  // namespace surefoot::bake
