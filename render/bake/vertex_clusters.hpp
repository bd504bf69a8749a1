// Levels for many objects at once: vertices that share a cell of a grid become one (Rossignac & Borrel), placed where their
// planes say (Lindstrom). It merges what is apart, which edge collapse cannot; and nothing vanishes: what collapses to a line
// or a point leaves blades or a small solid behind, so the bound holds both ways.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

struct ClusteringLimits {
    std::uint32_t most = 1000;  ///< triangles of the finest level (kept unless even two cells an axis need more)
    std::uint32_t least = 64;   ///< no level coarser than the first with at most this many triangles
    float slack = 0.25F;        ///< how far, relative, the bound may lie over what is proven
};

/// A chain of levels of g (not g itself), with vertices of its own and g's centre; at least one level.
/// owners: what a vertex belongs to; colours of different owners do not mix.
/// two_sided: by material; a one-sided triangle and its mirror image are both kept.
LodChain cluster_vertices(const Geometry& g, std::span<const std::uint32_t> owners, const std::vector<bool>& two_sided,
                          const ClusteringLimits& limits);

}  // namespace surefoot::bake
