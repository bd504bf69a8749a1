// Building the drawing tables (tables.hpp).
#include "render/draw/tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::draw {

namespace {

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))); }

vec3 centre_of(const model::Model& model, const model::Part& part) {
    vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (std::uint32_t i = part.first_index; i < part.first_index + part.index_count; ++i) {
        const float* const at = model.vertices[part.first_vertex + model.indices[i]].position;
        low = glm::min(low, vec3(at[0], at[1], at[2]));
        high = glm::max(high, vec3(at[0], at[1], at[2]));
    }
    return part.index_count > 0 ? 0.5F * low + 0.5F * high : vec3(0);
}

DrawPart make_part(const model::Model& model, const model::Part& part, std::uint16_t program, const TextureLayout& textures) {
    const model::Material& material = model.materials[part.material];
    DrawPart out{};
    out.first_index = part.first_index;
    out.index_count = part.index_count;
    out.base_vertex = static_cast<std::int32_t>(part.first_vertex);
    out.texture = model::none;
    if ((material.effects & model::effect_texture) != 0 && material.texture != model::none) {
        const TextureSlot slot = textures.slots[material.texture];
        out.texture = slot.array;
        out.texture_layer = static_cast<float>(slot.layer);
    }
    for (std::size_t i = 0; i < 4; ++i) out.colour[i] = to_byte(material.colour[i]);
    out.alpha_cutoff = material.alpha_cutoff;
    out.program = program;
    out.two_sided = material.two_sided;
    out.blended = (material.effects & model::effect_blend) != 0;
    if (out.blended) out.centre = centre_of(model, part);
    return out;
}

std::uint16_t program_of(model::EffectMask mask, const std::vector<model::EffectMask>& masks) {
    return static_cast<std::uint16_t>(std::lower_bound(masks.begin(), masks.end(), mask) - masks.begin());
}

/// The state classes of a part: as most eyes see it, and as those do that see only closed sides of it. Equal: all see it alike.
struct PartMasks {
    model::EffectMask open, closed;
};

PartMasks masks_of(const model::Model& model, const model::RoomSides& sides, std::uint32_t part) {
    const model::EffectMask mask = model.materials[model.parts[part].material].effects;
    const model::EffectMask closed = sides.any(part) ? mask & ~model::effects_under_sky : mask;
    return {sides.all(part) ? closed : mask, closed};
}

std::vector<model::EffectMask> all_masks(const model::Model& model, const model::RoomSides& sides) {
    std::vector<model::EffectMask> masks;
    for (std::uint32_t p = 0; p < model.parts.size(); ++p) {
        const PartMasks of_part = masks_of(model, sides, p);
        masks.insert(masks.end(), {of_part.open, of_part.closed});
    }
    std::sort(masks.begin(), masks.end());
    masks.erase(std::unique(masks.begin(), masks.end()), masks.end());
    return masks;
}

void add_parts(const model::Model& model, DrawTables& tables) {
    tables.closed = model::RoomSides(model);
    tables.masks = all_masks(model, tables.closed);
    const auto count = static_cast<std::uint32_t>(model.parts.size());
    tables.parts.reserve(count);
    for (std::uint32_t p = 0; p < count; ++p)
        tables.parts.push_back(
            make_part(model, model.parts[p], program_of(masks_of(model, tables.closed, p).open, tables.masks), tables.textures));
    for (std::uint32_t p = 0; p < count; ++p) {
        const PartMasks masks = masks_of(model, tables.closed, p);
        if (masks.open == masks.closed) continue;
        tables.parts[p].in_room = static_cast<std::uint32_t>(tables.parts.size());
        tables.parts.push_back(tables.parts[p]);
        tables.parts.back().in_room = model::none;
        tables.parts.back().program = program_of(masks.closed, tables.masks);
        tables.part_of.push_back(p);
    }
}

}  // namespace

DrawTables make_tables(const model::Model& model) {
    DrawTables tables;
    tables.textures = lay_out_textures(model);
    tables.depth_bias = depth_bias_ranks(model);
    add_parts(model, tables);
    tables.reps.reserve(model.reps.size());
    for (const model::Representation& rep : model.reps) {
        tables.reps.push_back({rep.placement, rep.first_part, rep.part_count, rep.triangles, 0});
        if (rep.kind != model::RepKind::textured_box) continue;
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            tables.parts[p].captured = (model.materials[model.parts[p].material].effects & model::effect_lit_picture) == 0;
    }
    for (std::uint32_t n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        for (std::uint32_t r = node.first_rep; r < node.first_rep + node.rep_count; ++r) tables.reps[r].node = n;
    }
    tables.placements.reserve(model.placements.size());
    for (const model::Placement& placement : model.placements) {
        Placed placed{placement.origin, {}, glm::determinant(placement.linear) < 0, placement.motion != model::none};
        if (!model.motions.empty()) tables.motions.push_back(placement.motion);
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                placed.rows[3 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column)] = placement.linear[column][row];
            }
        }
        tables.placements.push_back(placed);
    }
    if (!model.nodes.empty() && !model.nodes[0].box.empty()) tables.middle = model.nodes[0].box.centre();
    tables.centres.reserve(model.nodes.size());
    for (const model::Node& node : model.nodes) {
        const dvec3 centre = node.box.empty() ? dvec3(0.0) : node.box.centre() - tables.middle;
        tables.centres.emplace_back(vec3(centre), 0.0F);
    }
    return tables;
}

vec3 eye_in_frame(const Placed& placed, const dvec3& eye) {
    mat3 linear;
    std::size_t at = 0;  // by rows
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) linear[column][row] = placed.rows[at++];
    return model::eye_in_frame(placed.origin, linear, eye);
}

float distance_m(const DrawPart& part, const Placed& placed, const dvec3& eye) {
    std::array<float, 12> rows{};
    eye_relative_rows(placed, eye, rows);
    const auto along = [&](std::size_t row) {
        return rows[4 * row] * part.centre.x + rows[4 * row + 1] * part.centre.y + rows[4 * row + 2] * part.centre.z +
               rows[4 * row + 3];
    };
    return glm::length(vec3(along(0), along(1), along(2)));
}

Placed moved(const Placed& placed, const model::RigidPose& pose) {
    Placed out = placed;
    out.origin = pose(placed.origin);
    const dmat3 turn = glm::mat3_cast(pose.rotation);
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k)
                sum += turn[static_cast<int>(k)][static_cast<int>(row)] * static_cast<double>(placed.rows[3 * k + column]);
            out.rows[3 * row + column] = static_cast<float>(sum);
        }
    }
    return out;
}

void eye_relative_rows(const Placed& placed, const dvec3& eye, std::array<float, 12>& rows) {
    const dvec3 origin = placed.origin - eye;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) rows[4 * row + column] = placed.rows[3 * row + column];
    }
    rows[3] = static_cast<float>(origin.x);
    rows[7] = static_cast<float>(origin.y);
    rows[11] = static_cast<float>(origin.z);
}

}  // namespace surefoot::draw
