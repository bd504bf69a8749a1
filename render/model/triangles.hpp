// The triangles of a representation, part by part.
#pragma once

#include <cstdint>

#include "render/model/model.hpp"

namespace surefoot::model {

/// Calls use(const Material&, const vec3& a, const vec3& b, const vec3& c) for every triangle of a part. Corners are in the
/// part's coordinates; Representation::placement maps them to the world.
template <class Use>
void for_triangles(const Model& model, Index of_part, Use use) {
    const Part& part = model.parts[of_part];
    const auto corner = [&](std::uint32_t i) {
        const float* v = model.vertices[part.first_vertex + model.indices[part.first_index + i]].position;
        return vec3(v[0], v[1], v[2]);
    };
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3)
        use(model.materials[part.material], corner(i), corner(i + 1), corner(i + 2));
}

/// The same for every part of a representation, in order.
template <class Use>
void for_triangles(const Model& model, const Representation& rep, Use use) {
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) for_triangles(model, p, use);
}

}  // namespace surefoot::model
