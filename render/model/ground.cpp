// Checks of a ground, so that no query has to ask; and the boxes over its instances.
#include "render/model/ground.hpp"

#include <cmath>

#include <fmt/format.h>

namespace surefoot::model {

namespace {

Error ground_error(std::string_view array, std::size_t index, std::string_view what) {
    return {fmt::format("ground {}[{}]", array, index), std::string(what), "Bake the model again", ErrorKind::damaged};
}

/// Finite, and near enough that sums with it are.
bool is_finite(const dvec3& v) { return glm::length(v) <= 1e13; }

Result<void> check_blocks(const Ground& ground) {
    for (std::size_t i = 0; i < ground.blocks.size(); ++i) {
        const GroundBlock& block = ground.blocks[i];
        if (block.corners < 3 || block.corners > max_block_corners || block.triangles < 1 ||
            block.triangles > max_block_triangles)
            return ground_error("blocks", i, "The number of corners or triangles is out of range");
        const std::size_t numbers = std::size_t{block.corners} * (block.wide ? 12 : 6), all = numbers + 3ULL * block.triangles;
        if (block.first_byte > ground.bytes.size() || all > ground.bytes.size() - block.first_byte)
            return ground_error("blocks", i, "The bytes are out of range");
        for (std::size_t at = block.first_byte + numbers; at < block.first_byte + all; ++at) {
            if (std::to_integer<std::uint32_t>(ground.bytes[at]) >= block.corners)
                return ground_error("blocks", i, "A corner is out of range");
        }
    }
    return {};
}

Result<void> check_meshes(const Ground& ground) {
    std::uint64_t blocks = 0, nodes = 0;
    for (std::size_t i = 0; i < ground.meshes.size(); ++i) {
        const GroundMesh& mesh = ground.meshes[i];
        if (!is_finite(mesh.origin) || !(mesh.step_m >= 1e-15) || !(mesh.step_m <= 1e6))
            return ground_error("meshes", i, "The lattice is not finite");
        if (mesh.first_block != blocks || mesh.first_node != nodes) return ground_error("meshes", i, "The tree is out of order");
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (mesh.min[axis] > mesh.max[axis]) return ground_error("meshes", i, "The box is inside out");
        blocks += mesh.block_count;
        nodes += mesh.block_count == 0 ? 0 : 2ULL * mesh.block_count - 1;
        if (blocks > ground.blocks.size() || nodes > ground.boxes.size())
            return ground_error("meshes", i, "The tree is out of range");
    }
    if (blocks != ground.blocks.size() || nodes != ground.boxes.size())
        return ground_error("meshes", ground.meshes.size(), "Some blocks belong to no mesh");
    return {};
}

void fill_boxes(std::vector<Box>& tree, std::span<const Box> leaves, std::size_t node, std::size_t first, std::size_t count) {
    if (count == 1) {
        tree[node] = leaves[first];
        return;
    }
    const std::size_t left = (count + 1) / 2;
    fill_boxes(tree, leaves, node + 1, first, left);
    fill_boxes(tree, leaves, node + 2 * left, first + left, count - left);
    tree[node] = tree[node + 1];
    tree[node].grow(tree[node + 2 * left]);
}

}  // namespace

Box box_of(const Ground& ground, const GroundInstance& instance) {
    const GroundMesh& mesh = ground.meshes[instance.mesh];
    const auto corner = [](const std::array<std::int32_t, 3>& c) { return dvec3(c[0], c[1], c[2]); };
    const dvec3 low = mesh.origin + mesh.step_m * corner(mesh.min), high = mesh.origin + mesh.step_m * corner(mesh.max);
    Box box;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 p((c & 1U) != 0 ? high.x : low.x, (c & 2U) != 0 ? high.y : low.y, (c & 4U) != 0 ? high.z : low.z);
        box.grow(instance.origin + dmat3(instance.linear) * p);
    }
    return box;
}

std::vector<Box> tree_over(std::span<const Box> leaves) {
    std::vector<Box> tree;
    if (leaves.empty()) return tree;
    tree.resize(2 * leaves.size() - 1);
    fill_boxes(tree, leaves, 0, 0, leaves.size());
    return tree;
}

void index_instances(Ground& ground) {
    std::vector<Box> leaves;
    leaves.reserve(ground.instances.size());
    for (const GroundInstance& instance : ground.instances) leaves.push_back(box_of(ground, instance));
    ground.instance_boxes = tree_over(leaves);
}

Result<void> validate(const Ground& ground) {
    if (auto checked = check_blocks(ground); !checked) return checked;
    if (auto checked = check_meshes(ground); !checked) return checked;
    for (std::size_t i = 0; i < ground.instances.size(); ++i) {
        const GroundInstance& instance = ground.instances[i];
        const dmat3 inverse = glm::inverse(dmat3(instance.linear));
        bool invertible = true;
        for (int column = 0; column < 3; ++column) {
            invertible = invertible && glm::length(dvec3(instance.linear[column])) <= 1e9;
            invertible = invertible && glm::length(inverse[column]) <= 1e12;
        }
        if (!is_finite(instance.origin) || !invertible)
            return ground_error("instances", i, "The placement is not finite, or flat");
        if (instance.mesh == 0 || instance.mesh >= ground.meshes.size() || ground.meshes[instance.mesh].block_count == 0)
            return ground_error("instances", i, "The mesh is out of range");
    }
    if (ground.instances.size() >= (std::size_t{1} << 31U))
        return ground_error("instances", ground.instances.size(), "There are too many");
    return {};
}

std::uint64_t bytes_of(const Ground& ground) {
    return 64 * ground.meshes.size() + 19 * ground.blocks.size() + 12 * ground.boxes.size() + ground.bytes.size() +
           64 * ground.instances.size();
}

}  // namespace surefoot::model
