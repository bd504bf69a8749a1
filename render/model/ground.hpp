// What a visitor stands on and bumps into: the blocking triangles of full detail, in trees of small blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rt/base/geometry.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

/// A box in 65535ths of its mesh's box, rounded outwards.
struct GroundBox {
    std::array<std::uint16_t, 3> min{}, max{};
};

/// Neighbouring triangles, and their corners on the mesh's lattice. At first_byte stand the corners: three offsets from `origin`
/// each, of 16 bits, or of 32 bits where `wide`. Then stand the triangles: three numbers of corners each, of 8 bits.
struct GroundBlock {
    std::array<std::int32_t, 3> origin{};
    std::uint32_t first_byte = 0;  ///< in Ground::bytes
    std::uint8_t corners = 0, triangles = 0;
    bool wide = false;
};
constexpr std::uint32_t max_block_triangles = 32, max_block_corners = 96;

/// Blocking triangles in a frame of their own: point = origin + step_m * lattice point. All corners lie on one lattice, so
/// neighbouring triangles leave no crack. The tree is implicit: a node of n > 1 blocks has children of (n + 1) / 2 and n / 2
/// blocks. The first child follows it, and the second follows all of the first. A node of one block is that block.
struct GroundMesh {
    dvec3 origin{0.0};
    double step_m = 1;
    std::array<std::int32_t, 3> min{}, max{};  ///< box on the lattice
    std::uint32_t first_block = 0, block_count = 0;
    std::uint32_t first_node = 0;  ///< 2 * block_count - 1 of them in Ground::boxes
};

/// A placed mesh: world = origin + linear * point.
struct GroundInstance {
    dvec3 origin{0.0};
    mat3 linear{1.0F};
    std::uint32_t mesh = 0;
};

/// The ground of a model. Mesh 0 stands in the world itself and holds all that is there once; instances share the others.
struct Ground {
    std::vector<GroundMesh> meshes;
    std::vector<GroundBlock> blocks;
    std::vector<GroundBox> boxes;
    std::vector<std::byte> bytes;
    std::vector<GroundInstance> instances;
    std::vector<Box> instance_boxes;  ///< the same implicit tree over instances; not in the file: index_instances()
    std::uint64_t triangles = 0;      ///< blocking, unique

    [[nodiscard]] bool empty() const { return blocks.empty(); }
};

/// A placed mesh's box in the world.
Box box_of(const Ground& ground, const GroundInstance& instance);
/// Fills instance_boxes. The ground must be valid.
void index_instances(Ground& ground);
/// Boxes of the implicit tree over these leaves, in their order.
std::vector<Box> tree_over(std::span<const Box> leaves);

/// Checks every index, range and number that queries rely on. Errors name array and element.
Result<void> validate(const Ground& ground);

/// Bytes that the ground takes in a file.
std::uint64_t bytes_of(const Ground& ground);

}  // namespace surefoot::model
