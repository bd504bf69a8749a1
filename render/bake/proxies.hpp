// Cluster meshes, valid from everywhere: the objects of a cluster, merged and strongly simplified. And bounds of boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/cluster.hpp"
#include "render/bake/emit.hpp"
#include "render/bake/objects.hpp"

namespace surefoot::bake {

/// The meshes of one cluster.
struct ClusterForm {
    LodChain chain;  ///< world frame; full has the levels' vertices and no triangles
};

/// What all clusters are made from. Read by several threads at once.
struct ProxyInput {
    std::span<const PlacedObject> objects;
    std::span<const MeshForm> forms;
    std::span<const ClusterForm> clusters;  ///< those below this one must be complete
    const model::Model* model = nullptr;    ///< with complete materials and textures
    model::Index proxy_material = 0;
    std::vector<bool> two_sided;  ///< by material
    std::vector<bool> cut_out;    ///< by material: alpha-tested cards, which keep their material (cards.hpp)
    std::vector<bool> hidden;     ///< by material: nothing of it shows, as in ChainOptions
    float slack = 0.25F;          ///< relative gap allowed between upper and lower bound
    std::uint32_t max_input =
        24000;  ///< maximum triangles merged; objects enter at coarser levels to fit, and their errors are added

    [[nodiscard]] bool is_cut_out(model::Index material) const { return material < cut_out.size() && cut_out[material]; }
};

/// `members`: the objects below the cluster. If they are too many to merge, its children (entities) are merged instead.
/// The finest level has fewer triangles than the children's coarsest together, so a parent costs less (Maciel 1994, 3.1).
ClusterForm make_cluster(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members);

/// Upper bound of a box's error: of its captured faces to what it stands for, and back. The box's frame is its centre's.
float bound_box(const ProxyInput& input, const PlacedObject& object, const BoxForm& box);
float bound_box(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members,
                const BoxForm& box);

}  // namespace surefoot::bake
