// Surfaces of a baked model for tests: a node's full detail and a representation, as triangles about the node's centre.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "render/measure/mesh_distance.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

struct Surface {
    std::vector<vec3> positions;
    std::vector<std::uint32_t> indices;
    [[nodiscard]] measure::MeshView view() const { return {positions, indices}; }
    void add(const vec3& a, const vec3& b, const vec3& c) {
        for (const vec3& p : {a, b, c}) {
            indices.push_back(static_cast<std::uint32_t>(positions.size()));
            positions.push_back(p);
        }
    }
};

inline vec3 placed(const model::Model& m, const model::Representation& rep, const model::Vertex& v, const dvec3& centre) {
    const model::Placement& p = m.placements[rep.placement];
    return vec3(p.origin + dmat3(p.linear) * dvec3(v.position[0], v.position[1], v.position[2]) - centre);
}

/// Opaque texels of a picture's triangle pair become squares of their own: what is seen, not what it is painted on.
inline void add_picture(const model::Model& m, const model::Representation& rep, const model::Part& part, std::size_t face,
                        const dvec3& centre, Surface& out) {
    const model::Material& material = m.materials[part.material];
    const model::Texture& t = m.textures[material.texture];
    const std::uint32_t* index = &m.indices[part.first_index + 6 * face];
    const auto vertex = [&](std::uint32_t k) -> const model::Vertex& { return m.vertices[part.first_vertex + index[k]]; };
    const model::Vertex &a = vertex(0), &b = vertex(1), &c = vertex(2);  // corners in turn: b is between a and c
    const vec3 pa = placed(m, rep, a, centre), pb = placed(m, rep, b, centre), pc = placed(m, rep, c, centre);
    const int steps = 48;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const auto at = [&](float s, float r) { return pb + s * (pa - pb) + r * (pc - pb); };
            const float s = (static_cast<float>(i) + 0.5F) / steps, r = (static_cast<float>(j) + 0.5F) / steps;
            const float u = b.uv[0] + s * (a.uv[0] - b.uv[0]) + r * (c.uv[0] - b.uv[0]);
            const float v = b.uv[1] + s * (a.uv[1] - b.uv[1]) + r * (c.uv[1] - b.uv[1]);
            const auto x = std::min(t.width - 1, static_cast<std::uint32_t>(u * static_cast<float>(t.width)));
            const auto y = std::min(t.height - 1, static_cast<std::uint32_t>(v * static_cast<float>(t.height)));
            const auto alpha =
                std::to_integer<int>(m.texels[t.first_byte + 4ULL * (static_cast<std::uint64_t>(y) * t.width + x) + 3]);
            if (material.alpha == model::AlphaMode::mask && static_cast<float>(alpha) < material.alpha_cutoff * 255.0F) continue;
            const float s0 = static_cast<float>(i) / steps, s1 = static_cast<float>(i + 1) / steps;
            const float r0 = static_cast<float>(j) / steps, r1 = static_cast<float>(j + 1) / steps;
            out.add(at(s0, r0), at(s1, r0), at(s1, r1));
            out.add(at(s0, r0), at(s1, r1), at(s0, r1));
        }
    }
}

inline Surface surface_of(const model::Model& m, const model::Representation& rep, const dvec3& centre) {
    Surface out;
    for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = m.parts[p];
        if (rep.kind == model::RepKind::textured_box) {
            for (std::size_t face = 0; face < part.index_count / 6; ++face) add_picture(m, rep, part, face, centre, out);
            continue;
        }
        for (std::uint32_t i = 0; i < part.index_count; i += 3) {
            const std::uint32_t* index = &m.indices[part.first_index + i];
            const auto at = [&](std::uint32_t k) { return placed(m, rep, m.vertices[part.first_vertex + index[k]], centre); };
            out.add(at(0), at(1), at(2));
        }
    }
    return out;
}

/// Finest representations of all leaves below a node.
inline Surface full_detail(const model::Model& m, model::Index node, const dvec3& centre) {
    Surface out;
    std::vector<model::Index> open{node};
    while (!open.empty()) {
        const model::Node& n = m.nodes[open.back()];
        open.pop_back();
        for (std::uint32_t c = 0; c < n.child_count; ++c) open.push_back(n.first_child + c);
        if (n.child_count > 0) continue;
        const Surface leaf = surface_of(m, m.reps[n.first_rep + n.rep_count - 1], centre);
        for (std::size_t i = 0; i + 2 < leaf.positions.size(); i += 3)
            out.add(leaf.positions[i], leaf.positions[i + 1], leaf.positions[i + 2]);
    }
    return out;
}

/// Leaves of so many triangles or more that have coarser forms, `count` of them, evenly spread: one a mesh.
inline std::vector<model::Index> distinct_leaves(const model::Model& m, std::size_t count, std::uint32_t min_triangles = 0) {
    std::set<model::Index> seen;
    std::vector<model::Index> all, out;
    for (model::Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        if (node.child_count > 0 || node.rep_count < 2) continue;
        const model::Representation& full = m.reps[node.first_rep + node.rep_count - 1];
        if (full.triangles >= min_triangles && seen.insert(full.first_part).second) all.push_back(n);
    }
    count = std::min(count, all.size());
    for (std::size_t i = 0; i < count; ++i) out.push_back(all[i * all.size() / count]);
    return out;
}

/// What sampling says of one representation.
struct Judged {
    model::Index node = 0, rep = 0;
    float bound = 0;     ///< error_m
    float sampled = 0;   ///< largest of both directions; never above the true distance
    float rounding = 0;  ///< of float positions about the node's centre
};

/// Every representation of a node below full detail, `points` samples each way.
inline std::vector<Judged> judge_node(const model::Model& m, model::Index n, std::size_t points) {
    std::vector<Judged> out;
    const model::Node& node = m.nodes[n];
    const dvec3 centre = node.box.centre();
    const Surface full = full_detail(m, n, centre);
    const measure::TriangleTree full_tree(full.view());
    for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        if (m.reps[r].error_m == 0) continue;
        const Surface rep = surface_of(m, m.reps[r], centre);
        Judged judged{n, r, m.reps[r].error_m, std::numeric_limits<float>::infinity(), 0};
        if (!rep.indices.empty()) {
            const measure::TriangleTree rep_tree(rep.view());
            judged.sampled = std::max(measure::sampled_distance(full.view(), rep_tree, points, 1 + r).largest,
                                      measure::sampled_distance(rep.view(), full_tree, points, 7 + r).largest);
        }
        judged.rounding = 1e-6F * static_cast<float>(node.box.diagonal());
        out.push_back(judged);
    }
    return out;
}

/// Those of every `stride`-th node.
inline std::vector<Judged> judge(const model::Model& m, std::size_t points, std::size_t stride = 1) {
    std::vector<Judged> out;
    for (model::Index n = 0; n < m.nodes.size(); n += static_cast<model::Index>(stride)) {
        const std::vector<Judged> of_node = judge_node(m, n, points);
        out.insert(out.end(), of_node.begin(), of_node.end());
    }
    return out;
}

}  // namespace surefoot::bake
