// A model of three objects whose effects are counted by hand.
#pragma once

#include <string>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::test {

/// Two lamps of 6 textured and 4 bare triangles each, a wall of 5 lit triangles, and a cluster's form of 2 coloured triangles.
struct EffectScene {
    static constexpr model::Index bare = 0, textured = 1, lit = 2, coloured = 3;       ///< materials
    static constexpr model::Index cluster_form = 0, lamp_a = 1, lamp_b = 2, wall = 3;  ///< representations
    model::Model model;

    EffectScene() {
        model.materials.resize(4);
        model.materials[textured].effects = model::effect_texture;
        model.materials[textured].texture = 0;
        model.materials[lit].effects = model::effect_sun;
        model.materials[coloured].effects = model::effect_vertex_colour;
        model.textures.push_back({1, 1, 1, 0, false});
        model.texels.assign(4, std::byte{128});
        model.placements.emplace_back();
        model.names.assign(1, '\0');
        const model::Index lamp = add_name("lamp"), wall_name = add_name("wall");
        add_node(model::none, model::none, {{coloured, 2}});
        model.nodes[0].first_child = 1;
        model.nodes[0].child_count = 3;
        add_node(lamp, 0, {{textured, 6}, {bare, 4}});
        add_node(lamp, 1, {{textured, 6}, {bare, 4}});
        add_node(wall_name, 2, {{lit, 5}});
        model.nodes[0].triangles = 25;
        model.object_count = 3;
        for (std::uint32_t e = 0; e < model::effect_count; ++e) model.effects.push_back({1U << e, e < 3, 0, "by hand", true});
    }
    [[nodiscard]] model::Vertex& vertex_of(model::Index material) {
        for (const model::Part& part : model.parts)
            if (part.material == material) return model.vertices[part.first_vertex];
        return model.vertices.front();
    }

private:
    /// So many triangles of a material.
    struct Piece {
        model::Index material;
        std::uint32_t triangles;
    };

    model::Index add_name(const std::string& name) {
        const auto at = static_cast<model::Index>(model.names.size());
        model.names.append(name).push_back('\0');
        return at;
    }
    void add_node(model::Index name, model::Index object, const std::vector<Piece>& pieces) {
        model::Node node;
        node.box = {dvec3(-10, -1, -1), dvec3(10, 1, 1)};
        node.parent = model.nodes.empty() ? model::none : 0;
        node.first_rep = static_cast<model::Index>(model.reps.size());
        node.rep_count = 1;
        node.name = name;
        node.object = object;
        node.kind = object == model::none ? model::NodeKind::cluster : model::NodeKind::object;
        model::Representation rep;
        const float left = -6.0F + 3.0F * static_cast<float>(model.nodes.size());  // beside one another
        rep.first_part = static_cast<model::Index>(model.parts.size());
        rep.part_count = static_cast<std::uint32_t>(pieces.size());
        rep.error_m = model.nodes.empty() ? 0.5F : 0.0F;
        for (const Piece& piece : pieces) {
            model::Part part;
            part.material = piece.material;
            part.first_index = static_cast<std::uint32_t>(model.indices.size());
            part.index_count = 3 * piece.triangles;
            part.first_vertex = static_cast<std::uint32_t>(model.vertices.size());
            part.vertex_count = 3;
            for (std::uint32_t i = 0; i < part.index_count; ++i) model.indices.push_back(i % 3);
            for (const float x : {0.0F, 1.0F, 0.5F}) {
                model::Vertex vertex{};
                vertex.position[0] = left + x + (&piece == &pieces.front() ? 0.0F : 1.2F);
                vertex.position[1] = x == 0.5F ? 1.0F : 0.0F;
                vertex.normal[2] = 127;
                for (std::uint8_t& c : vertex.colour) c = piece.material == coloured ? 90 : 255;
                model.vertices.push_back(vertex);
            }
            model.parts.push_back(part);
            rep.triangles += piece.triangles;
            rep.effects |= model.materials[piece.material].effects;
        }
        node.triangles = rep.triangles;
        model.reps.push_back(rep);
        model.nodes.push_back(node);
    }
};

}  // namespace surefoot::test
