// Clusters by the growing grid of Maciel 1994, section 3.4.3, from the actual objects' boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::bake {

/// An entity is an object (index below the number of boxes) or a cluster.
struct ClusterTree {
    /// A node for several entities.
    struct Cluster {
        Box box;
        std::vector<std::uint32_t> children;  ///< entities; n + i is clusters[i]
        std::uint32_t motion = 0xffffffffU;   ///< of all of its objects, which it moves with; none: it stands still
        double displacement_m = 0;            ///< how far what it holds may be from its rest, where it stands still
    };
    std::vector<Cluster> clusters;
    std::uint32_t root = 0;  ///< entity
};

/// Cell sizes double from a size near the smaller objects' to the whole scene. Entities that fit into one cell become a cluster;
/// one alone does not. An entity fits if its centre is inside and its size is at most the cell's. No cluster has more than
/// `max_children` children: larger groups are first split at medians.
ClusterTree grow_clusters(std::span<const Box> objects, std::uint32_t max_children);
/// The same, with two kinds apart: a tree each, and a root above both if there are both. So a view of one kind opens none of the
/// other.
ClusterTree grow_clusters_apart(std::span<const Box> objects, const std::vector<bool>& kind, std::uint32_t max_children);

/// Clusters without other clusters below them, then those above, and so on. members: of each cluster, all objects below it.
std::vector<std::vector<std::uint32_t>> clusters_by_height(const ClusterTree& tree, std::uint32_t objects,
                                                           std::vector<std::vector<std::uint32_t>>& members);

}  // namespace surefoot::bake
