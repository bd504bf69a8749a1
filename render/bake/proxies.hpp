// A cluster's mesh, valid from everywhere: merged from the actual objects and simplified hard.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/cluster.hpp"
#include "render/bake/emit.hpp"
#include "render/bake/objects.hpp"

namespace surefoot::bake {

struct ClusterForm {
    LodChain chain;  ///< world frame; full holds the levels' vertices only
    BoxForm box;
    bool has_box = false;
};

struct ProxyInput {
    std::span<const PlacedObject> objects;
    std::span<const MeshForm> forms;
    std::span<const ClusterForm> clusters;  ///< those below are made
    const model::Model* model = nullptr;    ///< its materials and textures are made
    model::Index proxy_material = 0;
    std::vector<bool> two_sided;  ///< by material
    std::vector<bool> cut_out;    ///< by material: cards (cards.hpp), kept in it
    bool textured_boxes = false;
    float slack = 0.25F;               ///< of bounds
    std::uint32_t most_input = 24000;  ///< triangles merged: objects come as coarse as that needs, their errors added

    [[nodiscard]] bool is_cut_out(model::Index material) const { return material < cut_out.size() && cut_out[material]; }
};

/// `members`: the objects below the cluster; where they are too many to merge, its children (entities) stand for them.
/// The finest level has fewer triangles than the children's coarsest together (Maciel 3.1: a parent costs less).
ClusterForm make_cluster(const ProxyInput& input, const ClusterTree::Cluster& cluster, std::span<const std::uint32_t> members);

/// A box for one object, from a level of its chain.
BoxForm make_object_box(const ProxyInput& input, const PlacedObject& object, std::uint32_t pixels);

}  // namespace surefoot::bake
