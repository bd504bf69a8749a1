// Cluster meshes, valid from everywhere: the objects of a cluster, merged and strongly simplified.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/cluster.hpp"
#include "render/bake/emit.hpp"
#include "render/bake/objects.hpp"

namespace surefoot::bake {

/// The forms of one cluster.
struct ClusterForm {
    LodChain chain;  ///< world frame; full has the levels' vertices and no triangles
    BoxForm box;
    bool has_box = false;
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
    bool textured_boxes = false;
    float slack = 0.25F;  ///< relative gap allowed between upper and lower bound
    std::uint32_t max_input =
        24000;  ///< maximum triangles merged; objects enter at coarser levels to fit, and their errors are added

    [[nodiscard]] bool is_cut_out(model::Index material) const { return material < cut_out.size() && cut_out[material]; }
};

/// `members`: the objects below the cluster. If they are too many to merge, its children (entities) are merged instead.
/// The finest level has fewer triangles than the children's coarsest together, so a parent costs less (Maciel 1994, 3.1).
ClusterForm make_cluster(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members);

/// A box for one object, from a level of its chain.
BoxForm make_object_box(const ProxyInput& input, const PlacedObject& object, std::uint32_t pixels);

}  // namespace surefoot::bake
