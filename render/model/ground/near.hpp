// The triangles of a ground near a box. Nothing here allocates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "render/model/ground.hpp"
#include "render/model/ground/capsule.hpp"

namespace surefoot::model {

namespace ground_tree {

inline bool overlap(const Box& a, const Box& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
           b.min.z <= a.max.z;
}

inline Box box_of(const GroundTriangle& t) { return {glm::min(glm::min(t.a, t.b), t.c), glm::max(glm::max(t.a, t.b), t.c)}; }

/// A node of an implicit tree: its own number, and the leaves below it.
struct Span {
    std::uint32_t node, first, count;
};

/// Visits the leaves whose nodes all pass. passes(node) -> bool, use(leaf).
template <class Passes, class Use>
void for_leaves(std::uint32_t count, const Passes& passes, const Use& use) {
    if (count == 0) return;
    std::array<Span, 40> stack;  // halves: one waiting span a level, 32 levels at most
    std::size_t top = 0;
    stack[top++] = {0, 0, count};
    while (top > 0) {
        const Span span = stack[--top];
        if (!passes(span.node)) continue;
        if (span.count == 1) {
            use(span.first);
            continue;
        }
        const std::uint32_t left = (span.count + 1) / 2, right = span.count / 2;
        stack[top++] = {span.node + 2 * left, span.first + left, right};
        stack[top++] = {span.node + 1, span.first, left};
    }
}

/// Corners of a block on the lattice, from their bytes.
template <class Offset>
void unpack(const GroundBlock& block, const std::byte* bytes, std::array<dvec3, max_block_corners>& corners) {
    const dvec3 origin(block.origin[0], block.origin[1], block.origin[2]);
    std::array<Offset, std::size_t{3} * max_block_corners> offsets;
    std::memcpy(offsets.data(), bytes, std::size_t{3} * block.corners * sizeof(Offset));
    for (std::size_t i = 0; i < block.corners; ++i)
        corners[i] = origin + dvec3(offsets[3 * i], offsets[3 * i + 1], offsets[3 * i + 2]);
}

/// The query's box on a mesh's lattice, and in the units of its tree.
struct LatticeQuery {
    Box box;                                   ///< lattice points
    std::array<std::int32_t, 3> min{}, max{};  ///< in 65535ths of the mesh's box; outside of 0..65535 where the query is

    LatticeQuery(const GroundMesh& mesh, const Box& local) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = static_cast<std::size_t>(axis);
            box.min[axis] = (local.min[axis] - mesh.origin[axis]) / mesh.step_m - 1;
            box.max[axis] = (local.max[axis] - mesh.origin[axis]) / mesh.step_m + 1;
            const double low = mesh.min[at], extent = static_cast<double>(mesh.max[at]) - low;
            const double scale = extent > 0 ? 65535.0 / extent : 0.0;
            min[at] = bounded(std::floor((box.min[axis] - low) * scale));
            max[at] = bounded(std::ceil((box.max[axis] - low) * scale));
            if (extent > 0) continue;  // flat: all of its boxes are at 0
            min[at] = box.min[axis] > low ? 1 : 0;
            max[at] = box.max[axis] < low ? -1 : 0;
        }
    }
    /// No number becomes -1.
    static std::int32_t bounded(double value) { return value > -1 ? static_cast<std::int32_t>(std::min(value, 65536.0)) : -1; }
    [[nodiscard]] bool meets(const GroundBox& b) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (min[a] > b.max[a] || max[a] < b.min[a]) return false;
        return true;
    }
};

/// The triangles of a block, by `place` from mesh frame to world, to use(GroundTriangle). Those that pass only: on the lattice.
template <class Place, class Passes, class Use>
void in_block(const Ground& ground, const GroundMesh& mesh, const GroundBlock& block, const Place& place, const Passes& passes,
              const Use& use) {
    std::array<dvec3, max_block_corners> corners;
    const std::byte* bytes = ground.bytes.data() + block.first_byte;
    block.wide ? unpack<std::uint32_t>(block, bytes, corners) : unpack<std::uint16_t>(block, bytes, corners);
    const std::byte* numbers = bytes + std::size_t{block.corners} * (block.wide ? 12 : 6);
    const auto in_world = [&](const dvec3& p) { return place(mesh.origin + mesh.step_m * p); };
    for (std::uint32_t t = 0; t < block.triangles; ++t, numbers += 3) {
        const dvec3 &a = corners[std::to_integer<std::size_t>(numbers[0])],
                    &b = corners[std::to_integer<std::size_t>(numbers[1])],
                    &c = corners[std::to_integer<std::size_t>(numbers[2])];
        if (passes(GroundTriangle{a, b, c})) use(GroundTriangle{in_world(a), in_world(b), in_world(c)});
    }
}

/// use(number): blocks of a mesh that meet the query.
template <class Use>
void blocks_in_mesh(const Ground& ground, const GroundMesh& mesh, const LatticeQuery& query, const Use& use) {
    const auto passes = [&](std::uint32_t node) { return query.meets(ground.boxes[mesh.first_node + node]); };
    for_leaves(mesh.block_count, passes, [&](std::uint32_t leaf) { use(mesh.first_block + leaf); });
}

/// use(GroundTriangle): triangles whose lattice box meets the query, by `place` from mesh frame to world.
template <class Place, class Use>
void in_mesh(const Ground& ground, const GroundMesh& mesh, const Box& local, const Place& place, const Use& use) {
    const LatticeQuery query(mesh, local);
    const auto passes = [&](const GroundTriangle& t) { return overlap(query.box, box_of(t)); };
    blocks_in_mesh(ground, mesh, query,
                   [&](std::uint32_t block) { in_block(ground, mesh, ground.blocks[block], place, passes, use); });
}

/// use(instance): those whose boxes meet `box`.
template <class Use>
void instances_near(const Ground& ground, const Box& box, const Use& use) {
    const auto passes = [&](std::uint32_t node) { return overlap(box, ground.instance_boxes[node]); };
    for_leaves(static_cast<std::uint32_t>(ground.instances.size()), passes, use);
}

/// The world's box in the frame of an instance.
inline Box in_frame_of(const GroundInstance& instance, const Box& box) {
    const dmat3 inverse = glm::inverse(dmat3(instance.linear));
    const dvec3 centre = inverse * (box.centre() - instance.origin), half = box.half();
    const dvec3 reach = glm::abs(inverse[0]) * half.x + glm::abs(inverse[1]) * half.y + glm::abs(inverse[2]) * half.z;
    return {centre - reach, centre + reach};
}

}  // namespace ground_tree

/// Calls use(const GroundTriangle&) for every triangle that meets `box`, and for some whose boxes do; always in the same order.
template <class Use>
void for_triangles_near(const Ground& ground, const Box& box, const Use& use) {
    if (ground.meshes.empty()) return;
    const auto near = [&](const GroundTriangle& t) {
        if (ground_tree::overlap(box, ground_tree::box_of(t))) use(t);
    };
    ground_tree::in_mesh(
        ground, ground.meshes[0], box, [](const dvec3& p) { return p; }, near);
    ground_tree::instances_near(ground, box, [&](std::uint32_t number) {
        const GroundInstance& instance = ground.instances[number];
        const dmat3 linear(instance.linear);
        const bool mirrored = glm::determinant(linear) < 0;  // fronts stay fronts
        ground_tree::in_mesh(
            ground, ground.meshes[instance.mesh], ground_tree::in_frame_of(instance, box),
            [&](const dvec3& p) { return instance.origin + linear * p; },
            [&](const GroundTriangle& t) {
                near(mirrored ? GroundTriangle{t.a, t.c, t.b} : t);
            });
    });
}

}  // namespace surefoot::model
