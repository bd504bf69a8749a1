// Counting them, leaf by leaf, where they stand (curved_triangles.hpp).
#include "tools/accuracy/curved_triangles.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::accuracy {

namespace {

constexpr float curved_longer_m = 0.5F;
constexpr float curved_cosine = 0.96592583F;  // of 15 degrees

model::EffectMask effects_of_light() {
    model::EffectMask mask = 0;
    for (const effects::EffectModule& module : effects::all_effects())
        if (module.is_light()) mask |= module.bit;
    return mask;
}

/// A corner where it stands, but for the origin of its placement.
struct StandingCorner {
    vec3 place, normal;
};

bool is_curved(const std::array<StandingCorner, 3>& corners) {
    bool is_long = false, turns = false;
    for (std::size_t i = 0; i < 3; ++i) {
        const StandingCorner &a = corners[i], &b = corners[(i + 1) % 3];
        is_long = is_long || glm::length(b.place - a.place) > curved_longer_m;
        turns = turns || glm::dot(a.normal, b.normal) < curved_cosine * glm::length(a.normal) * glm::length(b.normal);
    }
    return is_long && turns;
}

std::uint64_t curved_of_part(const model::Model& m, const model::Part& part, const mat3& linear) {
    std::uint64_t curved = 0;
    const mat3 of_normals(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1]));
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
        std::array<StandingCorner, 3> corners{};
        for (std::uint32_t c = 0; c < 3; ++c) {
            const model::Vertex& v = m.vertices[part.first_vertex + m.indices[part.first_index + i + c]];
            corners[c] = {linear * vec3(v.position[0], v.position[1], v.position[2]),
                          of_normals * vec3(v.normal[0], v.normal[1], v.normal[2])};
        }
        curved += is_curved(corners) ? 1 : 0;
    }
    return curved;
}

}  // namespace

CurvedTriangles curved_triangles(const model::Model& m) {
    CurvedTriangles out;
    const model::EffectMask of_light = effects_of_light();
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0 || node.rep_count == 0) continue;
        const model::Representation& rep = m.reps[node.first_rep + node.rep_count - 1];
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::EffectMask own = m.materials[m.parts[p].material].effects;
            if ((own & of_light) == 0 || (own & model::effect_light_by_pixel) != 0) continue;
            out.lit += m.parts[p].index_count / 3;
            out.curved += curved_of_part(m, m.parts[p], m.placements[rep.placement].linear);
        }
    }
    return out;
}

std::string in_words(const CurvedTriangles& found) {
    if (found.lit == 0) return {};
    return fmt::format("of {} triangles lit at the vertices, {} are longer than 0.5 m with normals over 15 degrees apart",
                       found.lit, found.curved);
}

}  // namespace surefoot::accuracy
