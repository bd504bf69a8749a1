// Checks of a model: whatever the renderer relies on is proven here once, so that no frame has to ask.
#include "render/model/model.hpp"

#include "render/model/loss_groups.hpp"

#include <cmath>

#include <fmt/format.h>

#include "render/model/limits.hpp"

namespace surefoot::model {

namespace {

using Check = Result<void>;

Error wrong(std::string_view array, std::size_t index, std::string_view what) {
    return {fmt::format("{}[{}]", array, index), std::string(what), "Bake the model again", ErrorKind::damaged};
}

bool finite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool in_range(std::uint64_t first, std::uint64_t count, std::uint64_t size) { return first <= size && count <= size - first; }

Check check_textures(const Model& m) {
    for (std::size_t i = 0; i < m.textures.size(); ++i) {
        const Texture& t = m.textures[i];
        if (t.width == 0 || t.height == 0 || t.width > 16384 || t.height > 16384)
            return wrong("textures", i, "The size is not within 1 to 16384");
        std::uint32_t full = 1;
        while ((std::max(t.width, t.height) >> full) != 0) ++full;
        if (t.levels == 0 || t.levels > full) return wrong("textures", i, "The number of levels is wrong");
        std::uint64_t bytes = 0;
        for (std::uint32_t level = 0; level < t.levels; ++level) {
            bytes += 4ULL * std::max(1U, t.width >> level) * std::max(1U, t.height >> level);
        }
        if (!in_range(t.first_byte, bytes, m.texels.size())) return wrong("textures", i, "The texels are out of range");
    }
    return {};
}

Check check_materials(const Model& m) {
    for (std::size_t i = 0; i < m.materials.size(); ++i) {
        const Material& material = m.materials[i];
        for (const float c : material.colour) {
            if (!std::isfinite(c)) return wrong("materials", i, "The colour is not finite");
        }
        if (!std::isfinite(material.alpha_cutoff)) return wrong("materials", i, "The alpha cutoff is not finite");
        if (material.alpha > AlphaMode::blend) return wrong("materials", i, "The alpha mode is unknown");
        if ((material.effects >> effect_count) != 0) return wrong("materials", i, "An effect is unknown");
        if ((material.effects & background_effects) != 0) return wrong("materials", i, "An effect is of no material");
        if (material.texture != none && material.texture >= m.textures.size())
            return wrong("materials", i, "The texture is out of range");
        if (material.texture == none && (material.effects & effect_texture) != 0)
            return wrong("materials", i, "The texture effect has no texture");
    }
    return {};
}

Check check_parts(const Model& m) {
    for (std::size_t i = 0; i < m.parts.size(); ++i) {
        const Part& part = m.parts[i];
        if (part.material >= m.materials.size()) return wrong("parts", i, "The material is out of range");
        if (part.index_count == 0 || part.index_count % 3 != 0)
            return wrong("parts", i, "The index count is no positive multiple of 3");
        if (!in_range(part.first_index, part.index_count, m.indices.size()))
            return wrong("parts", i, "The indices are out of range");
        if (!in_range(part.first_vertex, part.vertex_count, m.vertices.size()))
            return wrong("parts", i, "The vertices are out of range");
        for (std::uint32_t k = 0; k < part.index_count; ++k) {
            if (m.indices[part.first_index + k] >= part.vertex_count)
                return wrong("parts", i, "An index is beyond the vertices of the part");
        }
    }
    for (std::size_t i = 0; i < m.vertices.size(); ++i) {
        const Vertex& v = m.vertices[i];
        if (!std::isfinite(v.position[0]) || !std::isfinite(v.position[1]) || !std::isfinite(v.position[2]) ||
            !std::isfinite(v.uv[0]) || !std::isfinite(v.uv[1])) {
            return wrong("vertices", i, "The vertex is not finite");
        }
    }
    return {};
}

Check check_placements(const Model& m) {
    for (std::size_t i = 0; i < m.placements.size(); ++i) {
        const Placement& p = m.placements[i];
        const float det = glm::determinant(p.linear);
        if (!finite(p.origin) || !std::isfinite(det) || det == 0.0F)
            return wrong("placements", i, "The placement is not finite, or is flat");
        if (p.motion != none && p.motion >= m.motions.size()) return wrong("placements", i, "The motion is out of range");
    }
    return {};
}

Check check_keys(const Model& m, std::size_t i) {
    const Motion& motion = m.motions[i];
    double before = 0;
    for (std::uint32_t k = motion.first_key; k < motion.first_key + motion.key_count; ++k) {
        const MotionKey& key = m.motion_keys[k];
        const auto& q = key.rotation;
        const float length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (!finite(key.translation) || !(std::abs(length2 - 1.0F) < 1e-3F))
            return wrong("motion_keys", k, "The pose is not finite, or its rotation is no unit quaternion");
        if (!(key.time_s >= before) || (k == motion.first_key && key.time_s != 0))
            return wrong("motion_keys", k, "The times do not begin at 0, or fall");
        before = key.time_s;
    }
    if (motion.key_count > 1 && before != motion.period_s) return wrong("motions", i, "The last key is not at the period");
    return {};
}

Check check_motions(const Model& m) {
    if (m.motions.size() > max_motions || m.motion_keys.size() > max_motion_keys)
        return Error{"motions", "The motions or their keys are too many", "Bake the model again", ErrorKind::damaged};
    std::vector<std::uint32_t> depth(m.motions.size(), 1);
    std::vector<std::uint64_t> keys_of(m.motions.size());  // those of what carries it included
    std::uint64_t own_keys = 0, all_keys = 0;
    for (std::size_t i = 0; i < m.motions.size(); ++i) {
        const Motion& motion = m.motions[i];
        if (!finite(motion.pivot)) return wrong("motions", i, "The pivot is not finite");
        if (!(motion.period_s >= min_period_s && motion.period_s <= max_period_s))
            return wrong("motions", i, "The period is out of range");
        if (motion.key_count == 0 || !in_range(motion.first_key, motion.key_count, m.motion_keys.size()))
            return wrong("motions", i, "The keys are out of range");
        if (motion.outer != none && motion.outer >= i) return wrong("motions", i, "What carries it does not come before it");
        if (motion.outer != none) depth[i] = depth[motion.outer] + 1;
        if (depth[i] > max_motion_depth) return wrong("motions", i, "Too many motions carry each other");
        keys_of[i] = motion.key_count + (motion.outer != none ? keys_of[motion.outer] : 0);
        own_keys += motion.key_count;
        all_keys += keys_of[i];
    }
    if (own_keys > m.motion_keys.size() || all_keys > 2 * std::uint64_t{max_motion_keys})
        return Error{"motions", "Motions share keys, or carry too many of them", "Bake the model again", ErrorKind::damaged};
    for (std::size_t i = 0; i < m.motions.size(); ++i)
        if (Check keys = check_keys(m, i); !keys) return keys;
    return {};
}

Check check_reps(const Model& m) {
    for (std::size_t i = 0; i < m.reps.size(); ++i) {
        const Representation& r = m.reps[i];
        if (r.kind > RepKind::textured_box) return wrong("reps", i, "The kind is unknown");
        if (!std::isfinite(r.error_m) || r.error_m < 0) return wrong("reps", i, "The error is negative or not finite");
        if (!std::isfinite(r.min_distance_m) || r.min_distance_m < 0)
            return wrong("reps", i, "The range is negative or not finite");
        if (r.everywhere && r.min_distance_m > 0)
            return wrong("reps", i, "The form is valid everywhere, yet only from a distance");
        if (r.placement >= m.placements.size()) return wrong("reps", i, "The placement is out of range");
        if (r.part_count == 0 || !in_range(r.first_part, r.part_count, m.parts.size()))
            return wrong("reps", i, "The parts are out of range");
        std::uint64_t indices = 0;
        EffectMask effects = 0;
        for (std::uint32_t k = 0; k < r.part_count; ++k) {
            indices += m.parts[r.first_part + k].index_count;
            effects |= m.materials[m.parts[r.first_part + k].material].effects;
        }
        if (indices != 3ULL * r.triangles) return wrong("reps", i, "The triangle count differs from that of the parts");
        if (effects != r.effects) return wrong("reps", i, "The effects differ from those of the materials");
        for (const float area : r.area_m2) {
            if (!std::isfinite(area) || area < 0) return wrong("reps", i, "The area is negative or not finite");
        }
    }
    return {};
}

bool within_one(float share) { return share >= 0.0F && share <= 1.0F; }

Check check_losses(const Model& m) {
    if (m.losses.empty()) return {};
    if (m.losses.size() != m.reps.size())
        return Error{"losses", "The losses are not one for every form", "Bake the model again", ErrorKind::damaged};
    bool colours = within_one(m.colours.variance);
    for (const float mean : m.colours.mean) colours = colours && within_one(mean);
    if (!colours) return Error{"losses", "The colours are not within 0 to 1", "Bake the model again", ErrorKind::damaged};
    for (std::size_t i = 0; i < m.losses.size(); ++i) {
        bool good = within_one(m.losses[i].coverage);
        for (const float colour : m.losses[i].colour) good = good && within_one(colour);
        if (!good) return wrong("losses", i, "The loss is not within 0 to 1");
    }
    return {};
}

/// Needs a tree that was checked.
Check check_group_losses(const Model& m) {
    if (m.group_losses.empty()) return {};
    if (m.losses.empty() || m.group_losses.size() != LossGroups(m).size())
        return Error{"losses of groups", "The losses are not one for every form and group", "Bake the model again",
                     ErrorKind::damaged};
    for (std::size_t i = 0; i < m.group_losses.size(); ++i) {
        for (const float colour : m.group_losses[i].colour)
            if (!within_one(colour)) return wrong("losses of groups", i, "The loss is not within 0 to 1");
    }
    return {};
}

Check check_node_reps(const Model& m, std::size_t i) {
    const Node& node = m.nodes[i];
    if (node.rep_count == 0 || !in_range(node.first_rep, node.rep_count, m.reps.size()))
        return wrong("nodes", i, "The forms are out of range");
    bool everywhere = false;
    for (std::uint32_t k = 0; k < node.rep_count; ++k) {
        const Representation& rep = m.reps[node.first_rep + k];
        everywhere = everywhere || rep.everywhere;
        if (k == 0) continue;
        const Representation& coarser = m.reps[node.first_rep + k - 1];
        if (!(rep.error_m < coarser.error_m)) return wrong("nodes", i, "The errors of the forms do not fall");
        const bool meshes = rep.kind == RepKind::mesh && coarser.kind == RepKind::mesh;
        const bool whole = coarser.error_m <= max_trimmed_error_m;  // cut masks have more triangles than full detail
        if (meshes && !whole && rep.triangles < coarser.triangles)
            return wrong("nodes", i, "The triangle counts of the meshes fall");
    }
    for (std::uint32_t k = 0; k < node.rep_count; ++k) {
        if (m.placements[m.reps[node.first_rep + k].placement].motion != motion_of(m, node))
            return wrong("nodes", i, "The forms do not move alike");
    }
    if (!everywhere) return wrong("nodes", i, "No form is valid from everywhere");
    if (node.child_count == 0 && !m.reps[node.first_rep + node.rep_count - 1].everywhere) {
        return wrong("nodes", i, "The full detail of the leaf is not valid from everywhere");
    }
    return {};
}

Check check_node(const Model& m, std::size_t i) {
    const Node& node = m.nodes[i];
    if (node.box.empty() || !finite(node.box.min) || !finite(node.box.max))
        return wrong("nodes", i, "The box is empty or not finite");
    if (node.kind > NodeKind::piece) return wrong("nodes", i, "The kind is unknown");
    if (!(node.importance >= 0.0F && node.importance <= 1.0F)) return wrong("nodes", i, "The importance is not within 0 to 1");
    if (node.name != none && node.name >= m.names.size()) return wrong("nodes", i, "The name is out of range");
    if (node.object != none && node.object >= m.object_count) return wrong("nodes", i, "The object is out of range");
    if ((i == 0) != (node.parent == none)) return wrong("nodes", i, "Only node 0 may be the root");
    if (node.child_count > 0) {
        if (node.first_child <= i || !in_range(node.first_child, node.child_count, m.nodes.size())) {
            return wrong("nodes", i, "The children are out of range, or before their parent");
        }
        for (std::uint32_t k = 0; k < node.child_count; ++k) {
            const Node& child = m.nodes[node.first_child + k];
            if (child.parent != i) return wrong("nodes", node.first_child + k, "The node belongs to another parent");
            if (!node.box.contains(child.box))
                return wrong("nodes", node.first_child + k, "The node sticks out of its parent's box");
        }
    }
    return check_node_reps(m, i);
}

// Each child names its parent and each parent its children: with equal counts the two say the same, and every node hangs on the
// root.
Check check_tree(const Model& m) {
    if (m.nodes.empty()) return Error{"nodes", "The model is empty", "Bake the model again", ErrorKind::damaged};
    std::uint64_t claimed = 1;
    for (std::size_t i = 0; i < m.nodes.size(); ++i) {
        if (Check check = check_node(m, i); !check) return check;
        claimed += m.nodes[i].child_count;
    }
    if (claimed != m.nodes.size())
        return Error{"nodes", "The children do not add up to the nodes", "Bake the model again", ErrorKind::damaged};
    return {};
}

Check check_light(const Model& m) {
    const auto wrong_light = [](const char* what) { return Error{"light", what, "Bake the model again", ErrorKind::damaged}; };
    EffectMask used = 0;
    for (const Material& material : m.materials) used |= material.effects;
    const std::size_t n = m.vertices.size();
    if (!m.sun_seen.empty() && m.sun_seen.size() != n) return wrong_light("Shadows are not there for every vertex");
    if (!m.lamp_light.empty() && m.lamp_light.size() != n) return wrong_light("Lamps are not there for every vertex");
    if ((used & effect_shadow) != 0 && m.sun_seen.empty()) return wrong_light("A material has shadows, and no vertex has any");
    if ((used & effect_lit_picture) != 0 && m.sun_seen.empty())
        return wrong_light("A picture is lit by the hour, and no vertex has shares of the sun");
    if ((used & effect_lamps) != 0 && m.lamp_light.empty()) return wrong_light("A material has lamps, and no vertex has any");
    const LightFacts& l = m.light;
    if (!(l.day >= 1 && l.day <= 366) || !(std::abs(l.latitude_deg) <= 90)) return wrong_light("The sun's day or place is wrong");
    if (!(l.max_lamp_light > 0 && l.max_lamp_light <= 1e4F)) return wrong_light("The lamps' light is out of range");
    if (!(l.night_room_light >= 0 && l.night_room_light <= 1)) return wrong_light("The light of rooms at night is out of range");
    if (!(l.fog_visibility_m >= 0 && l.fog_visibility_m <= 1e7F)) return wrong_light("The fog is out of range");
    return {};
}

Check check_rest(const Model& m) {
    if (m.names.empty() || m.names.front() != '\0' || m.names.back() != '\0') {
        return Error{"names", "The names are not zero-terminated", "Bake the model again", ErrorKind::damaged};
    }
    if (m.effects.size() > static_cast<std::size_t>(effect_count)) {
        return Error{"effects", "A later program baked the model: it calls for effects that are not known here",
                     "Use that program, or bake the model again with this one", ErrorKind::unsupported};
    }
    if (m.effects.size() != static_cast<std::size_t>(effect_count)) {
        return Error{"effects", "The findings are not one for every effect", "Bake the model again", ErrorKind::damaged};
    }
    EffectMask used = 0;
    for (const Material& material : m.materials) used |= material.effects;
    for (std::size_t i = 0; i < m.effects.size(); ++i) {
        if (m.effects[i].bit != (1U << i)) return wrong("effects", i, "The finding is out of order");
    }
    if ((used & ~m.called_for()) != 0)
        return Error{"effects", "A material uses an effect that no finding calls for", "Bake the model again",
                     ErrorKind::damaged};
    if (auto light = check_light(m); !light) return light;
    if (!finite(m.sun_direction) || std::abs(glm::length(m.sun_direction) - 1.0) > 0.01) {
        return Error{"sun_direction", "The direction is no unit vector", "Bake the model again", ErrorKind::damaged};
    }
    return {};
}

Check check_ground(const Model& m) {
    if (auto still = validate(m.ground); !still) return still;
    return validate_moving_ground(m);
}

Check check_tour(const Model& m) {
    double before = -1;
    for (std::size_t i = 0; i < m.tour.samples.size(); ++i) {
        const PathSample& sample = m.tour.samples[i];
        const Pose& pose = sample.pose;
        if (!(sample.time_s > before) || !(sample.time_s < path_time_limit_s))
            return wrong("tour", i, "The time does not increase");
        if (!finite(pose.position) || !(std::abs(glm::length(pose.orientation) - 1) < 1e-3) || !(pose.fov_y_rad > 0) ||
            !(pose.fov_y_rad < 3.1))
            return wrong("tour", i, "The pose is none");
        before = sample.time_s;
    }
    return {};
}

}  // namespace

EffectMask Model::called_for() const {
    EffectMask mask = 0;
    for (const EffectFinding& finding : effects) mask |= finding.called_for ? finding.bit : 0U;
    return mask;
}

Result<void> validate(const Model& model) {
    if (auto fits = check_limits(counts_of(model), "model"); !fits) return fits;
    for (const auto check : {check_textures, check_materials, check_parts, check_motions, check_placements, check_reps,
                             check_losses, check_tree, check_group_losses, check_rest, check_ground, check_tour}) {
        if (Check result = check(model); !result) return result;
    }
    return {};
}

}  // namespace surefoot::model
