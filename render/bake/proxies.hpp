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
    LodChain chain;   ///< world frame; full is the merged input, which is not a level
    BoxForm box;
    bool has_box = false;
};

struct ProxyInput {
    std::span<const PlacedObject> objects;
    std::span<const MeshForm> forms;
    const ClusterTree* tree = nullptr;
    model::Index proxy_material = 0;
    bool textured_boxes = false;
    ChainOptions chain;
    std::uint32_t most_input = 12000;  ///< triangles merged: objects come as coarse as that needs, their errors added
};

/// `members`: the objects below the cluster. `children_coarsest`: triangles of its children's coarsest forms together; the
/// cluster's finest level has at most half of them (Maciel 3.1: a parent costs less than its children).
ClusterForm make_cluster(const ProxyInput& input, const Box& box, std::span<const std::uint32_t> members, std::uint32_t children_coarsest);

/// A box for one object, from a level of its chain.
BoxForm make_object_box(const ProxyInput& input, const PlacedObject& object, std::uint32_t pixels);

/// The level of a chain with at most `most` triangles, else its coarsest.
const Level& level_within(const LodChain& chain, std::uint32_t most);

}  // namespace surefoot::bake
