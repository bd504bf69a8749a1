// Trees of small blocks over blocking triangles (render/model/ground.hpp).
#pragma once

#include <span>
#include <vector>

#include "render/model/ground.hpp"
#include "render/model/ground/capsule.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// A mesh with its blocks, boxes and bytes, to be joined to a ground.
struct GroundTree {
    model::GroundMesh mesh;
    std::vector<model::GroundBlock> blocks;
    std::vector<model::GroundBox> boxes;
    std::vector<std::byte> bytes;
    std::uint64_t triangles = 0;
};

/// Corners move to a lattice of at most `step_m`, a power of two. It is finer where the mesh is tiny, and coarser where it is too
/// wide for 31 bits. Triangles of which two corners meet there are dropped.
GroundTree build_tree(std::span<const model::GroundTriangle> triangles, double step_m);
/// Its numbers count on from the ground's.
void append(model::Ground& ground, GroundTree&& tree);
/// A thing that moves by itself, with a motion of its own, for a model made by hand. At least one key; the last one's time is the
/// period. Then model::index_moving_ground() is due, once for all of them.
void append_moving(model::Model& model, std::span<const model::GroundTriangle> at_rest, const dvec3& pivot,
                   std::span<const model::MotionKey> keys);
/// Puts instances into the order of their implicit tree. The ground's meshes must be complete. Returns their old numbers.
std::vector<std::uint32_t> order_instances(model::Ground& ground);

/// Corners of models made by hand lie on it.
constexpr double made_lattice_m = 1.0 / 4096;

}  // namespace surefoot::bake
