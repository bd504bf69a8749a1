// The smallest model that uses every array: a root cluster with two objects, a texture, three kinds of representation.
#pragma once

#include <string_view>

#include "render/model/model.hpp"

namespace surefoot::model {

inline void add_finding(Model& m, std::uint32_t bit, bool called_for, std::string_view reason) {
    m.effects.push_back({bit, called_for, called_for ? 2U : 0U, std::string(reason)});
}

inline Index add_triangle_rep(Model& m, float error_m, bool everywhere = true) {
    Representation rep;
    rep.kind = everywhere ? RepKind::mesh : RepKind::textured_box;
    rep.everywhere = everywhere;
    rep.min_distance_m = everywhere ? 0.0F : 1.0F;
    rep.error_m = error_m;
    rep.first_part = 0;
    rep.part_count = 1;
    rep.triangles = 1;
    rep.effects = effect_texture;
    rep.area_m2 = {0.5F, 0.5F, 0.5F};
    m.reps.push_back(rep);
    return static_cast<Index>(m.reps.size() - 1);
}

inline Model two_triangles() {
    Model m;
    m.names = std::string("\0first\0second\0", 14);
    m.vertices.resize(3);
    m.vertices[1].position[0] = 1;
    m.vertices[2].position[1] = 1;
    m.indices = {0, 1, 2};
    m.textures.push_back({2, 2, 2, 0, false});
    m.texels.assign(20, std::byte{200});
    Material material;
    material.texture = 0;
    material.effects = effect_texture;
    m.materials.push_back(material);
    m.parts.push_back({0, 0, 3, 0, 3});
    m.placements.push_back({{1, 2, 3}, mat3(1.0F)});
    m.nodes.resize(3);
    m.nodes[0] = {{{0, 0, 0}, {4, 4, 4}}, none, 1, 2, 0, 0, none, none, 1.0F, NodeKind::cluster, 2};
    add_triangle_rep(m, 3, false);
    add_triangle_rep(m, 2);
    m.nodes[0].rep_count = 2;
    for (Index i = 1; i <= 2; ++i) {
        m.nodes[i] = {{{1, 2, 3}, {2, 3, 3}}, 0, none, 0, add_triangle_rep(m, 0), 1, i == 1 ? 1U : 7U, i - 1, 0.5F,
                      NodeKind::object,       1};
    }
    m.object_count = 2;
    for (int e = 0; e < effect_count; ++e) add_finding(m, 1U << e, e == 0, e == 0 ? "1 image" : "none");
    m.provenance = {{"hand.glb"}, "draft", {"a warning"}};
    return m;
}

}  // namespace surefoot::model
