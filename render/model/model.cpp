// Checks of a model: whatever the renderer relies on is proven here once, so that no frame has to ask.
#include "render/model/model.hpp"

#include <cmath>

#include <fmt/format.h>

#include "render/model/limits.hpp"

namespace surefoot::model {

namespace {

using Check = Result<void>;

Error wrong(std::string_view array, std::size_t index, std::string_view what) {
    return {fmt::format("{}[{}]", array, index), std::string(what), "bake the model again"};
}

bool finite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool in_range(std::uint64_t first, std::uint64_t count, std::uint64_t size) { return first <= size && count <= size - first; }

Check check_textures(const Model& m) {
    for (std::size_t i = 0; i < m.textures.size(); ++i) {
        const Texture& t = m.textures[i];
        if (t.width == 0 || t.height == 0 || t.width > 16384 || t.height > 16384)
            return wrong("textures", i, "size out of 1..16384");
        std::uint32_t full = 1;
        while ((std::max(t.width, t.height) >> full) != 0) ++full;
        if (t.levels == 0 || t.levels > full) return wrong("textures", i, "wrong number of levels");
        std::uint64_t bytes = 0;
        for (std::uint32_t level = 0; level < t.levels; ++level) {
            bytes += 4ULL * std::max(1U, t.width >> level) * std::max(1U, t.height >> level);
        }
        if (!in_range(t.first_byte, bytes, m.texels.size())) return wrong("textures", i, "texels out of range");
    }
    return {};
}

Check check_materials(const Model& m) {
    for (std::size_t i = 0; i < m.materials.size(); ++i) {
        const Material& material = m.materials[i];
        for (const float c : material.colour) {
            if (!std::isfinite(c)) return wrong("materials", i, "colour is not finite");
        }
        if (!std::isfinite(material.alpha_cutoff)) return wrong("materials", i, "alpha cutoff is not finite");
        if (material.alpha > AlphaMode::blend) return wrong("materials", i, "unknown alpha mode");
        if ((material.effects >> effect_count) != 0) return wrong("materials", i, "unknown effect");
        if (material.texture != none && material.texture >= m.textures.size())
            return wrong("materials", i, "texture out of range");
        if (material.texture == none && (material.effects & effect_texture) != 0)
            return wrong("materials", i, "texture effect without a texture");
    }
    return {};
}

Check check_parts(const Model& m) {
    for (std::size_t i = 0; i < m.parts.size(); ++i) {
        const Part& part = m.parts[i];
        if (part.material >= m.materials.size()) return wrong("parts", i, "material out of range");
        if (part.index_count == 0 || part.index_count % 3 != 0)
            return wrong("parts", i, "index count is no positive multiple of 3");
        if (!in_range(part.first_index, part.index_count, m.indices.size())) return wrong("parts", i, "indices out of range");
        if (!in_range(part.first_vertex, part.vertex_count, m.vertices.size())) return wrong("parts", i, "vertices out of range");
        for (std::uint32_t k = 0; k < part.index_count; ++k) {
            if (m.indices[part.first_index + k] >= part.vertex_count) return wrong("parts", i, "index beyond its vertices");
        }
    }
    for (std::size_t i = 0; i < m.vertices.size(); ++i) {
        const Vertex& v = m.vertices[i];
        if (!std::isfinite(v.position[0]) || !std::isfinite(v.position[1]) || !std::isfinite(v.position[2]) ||
            !std::isfinite(v.uv[0]) || !std::isfinite(v.uv[1])) {
            return wrong("vertices", i, "not finite");
        }
    }
    return {};
}

Check check_placements(const Model& m) {
    for (std::size_t i = 0; i < m.placements.size(); ++i) {
        const Placement& p = m.placements[i];
        const float det = glm::determinant(p.linear);
        if (!finite(p.origin) || !std::isfinite(det) || det == 0.0F) return wrong("placements", i, "not finite, or flat");
    }
    return {};
}

Check check_reps(const Model& m) {
    for (std::size_t i = 0; i < m.reps.size(); ++i) {
        const Representation& r = m.reps[i];
        if (r.kind > RepKind::textured_box) return wrong("reps", i, "unknown kind");
        if (!std::isfinite(r.error_m) || r.error_m < 0) return wrong("reps", i, "error is negative or not finite");
        if (!std::isfinite(r.min_distance_m) || r.min_distance_m < 0) return wrong("reps", i, "range is negative or not finite");
        if (r.everywhere && r.min_distance_m > 0) return wrong("reps", i, "valid everywhere, yet only from a distance");
        if (r.placement >= m.placements.size()) return wrong("reps", i, "placement out of range");
        if (r.part_count == 0 || !in_range(r.first_part, r.part_count, m.parts.size()))
            return wrong("reps", i, "parts out of range");
        std::uint64_t indices = 0;
        EffectMask effects = 0;
        for (std::uint32_t k = 0; k < r.part_count; ++k) {
            indices += m.parts[r.first_part + k].index_count;
            effects |= m.materials[m.parts[r.first_part + k].material].effects;
        }
        if (indices != 3ULL * r.triangles) return wrong("reps", i, "triangle count differs from its parts");
        if (effects != r.effects) return wrong("reps", i, "effects differ from its materials");
        for (const float area : r.area_m2) {
            if (!std::isfinite(area) || area < 0) return wrong("reps", i, "area is negative or not finite");
        }
    }
    return {};
}

Check check_node_reps(const Model& m, std::size_t i) {
    const Node& node = m.nodes[i];
    if (node.rep_count == 0 || !in_range(node.first_rep, node.rep_count, m.reps.size()))
        return wrong("nodes", i, "representations out of range");
    bool everywhere = false;
    for (std::uint32_t k = 0; k < node.rep_count; ++k) {
        const Representation& rep = m.reps[node.first_rep + k];
        everywhere = everywhere || rep.everywhere;
        if (k == 0) continue;
        const Representation& coarser = m.reps[node.first_rep + k - 1];
        if (!(rep.error_m < coarser.error_m)) return wrong("nodes", i, "errors of its representations do not fall");
        if (rep.triangles < coarser.triangles) return wrong("nodes", i, "triangles of its representations fall");
    }
    if (!everywhere) return wrong("nodes", i, "no representation is valid from everywhere");
    if (node.child_count == 0 && !m.reps[node.first_rep + node.rep_count - 1].everywhere) {
        return wrong("nodes", i, "a leaf's full detail is not valid from everywhere");
    }
    return {};
}

Check check_node(const Model& m, std::size_t i) {
    const Node& node = m.nodes[i];
    if (node.box.empty() || !finite(node.box.min) || !finite(node.box.max))
        return wrong("nodes", i, "box is empty or not finite");
    if (node.kind > NodeKind::piece) return wrong("nodes", i, "unknown kind");
    if (!(node.importance >= 0.0F && node.importance <= 1.0F)) return wrong("nodes", i, "importance out of 0..1");
    if (node.name != none && node.name >= m.names.size()) return wrong("nodes", i, "name out of range");
    if (node.object != none && node.object >= m.object_count) return wrong("nodes", i, "object out of range");
    if ((i == 0) != (node.parent == none)) return wrong("nodes", i, "only node 0 is the root");
    if (node.child_count > 0) {
        if (node.first_child <= i || !in_range(node.first_child, node.child_count, m.nodes.size())) {
            return wrong("nodes", i, "children out of range, or before their parent");
        }
        for (std::uint32_t k = 0; k < node.child_count; ++k) {
            const Node& child = m.nodes[node.first_child + k];
            if (child.parent != i) return wrong("nodes", node.first_child + k, "its parent is another node");
            if (!node.box.contains(child.box)) return wrong("nodes", node.first_child + k, "sticks out of its parent's box");
        }
    }
    return check_node_reps(m, i);
}

// Each child names its parent and each parent its children: with equal counts the two say the same, and every node hangs on the
// root.
Check check_tree(const Model& m) {
    if (m.nodes.empty()) return Error{"nodes", "the model is empty", "bake the model again"};
    std::uint64_t claimed = 1;
    for (std::size_t i = 0; i < m.nodes.size(); ++i) {
        if (Check check = check_node(m, i); !check) return check;
        claimed += m.nodes[i].child_count;
    }
    if (claimed != m.nodes.size()) return Error{"nodes", "children do not add up to the nodes", "bake the model again"};
    return {};
}

Check check_rest(const Model& m) {
    if (m.names.empty() || m.names.front() != '\0' || m.names.back() != '\0') {
        return Error{"names", "not zero-terminated", "bake the model again"};
    }
    if (m.effects.size() != static_cast<std::size_t>(effect_count)) {
        return Error{"effects", "not one finding for every effect", "bake the model again"};
    }
    EffectMask used = 0;
    for (const Material& material : m.materials) used |= material.effects;
    for (std::size_t i = 0; i < m.effects.size(); ++i) {
        if (m.effects[i].bit != (1U << i)) return wrong("effects", i, "out of order");
    }
    if ((used & ~m.called_for()) != 0)
        return Error{"effects", "a material uses what no finding calls for", "bake the model again"};
    if (!finite(m.sun_direction) || std::abs(glm::length(m.sun_direction) - 1.0) > 0.01) {
        return Error{"sun_direction", "not a unit vector", "bake the model again"};
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
    for (const auto check :
         {check_textures, check_materials, check_parts, check_placements, check_reps, check_tree, check_rest}) {
        if (Check result = check(model); !result) return result;
    }
    return {};
}

}  // namespace surefoot::model
