// Vertex clustering, for levels of many objects at once. Vertices in one cell of a grid become one (Rossignac & Borrel 1993),
// placed by the quadric of their planes (Lindstrom 2000). It merges separate surfaces, which edge collapse cannot.
// Nothing vanishes: geometry that collapses to a line or point leaves thin blades or a small solid. So the two-sided bound holds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Limits of the clustered levels.
struct ClusteringLimits {
    std::uint32_t max_triangles = 1000;  ///< triangles of the finest level; exceeded only if two cells an axis need more
    std::uint32_t min_triangles = 64;    ///< the chain ends at the first level with at most this many triangles
    float slack = 0.25F;                 ///< relative gap allowed between upper and lower bound
};

/// A chain of levels of g (not g itself), with vertices of its own and g's centre; at least one level.
/// owners: by vertex, the object that it belongs to; colours of different owners are not mixed.
/// two_sided: by material. Of one-sided materials, a triangle and its mirror image are both kept.
LodChain cluster_vertices(const Geometry& g, std::span<const std::uint32_t> owners, const std::vector<bool>& two_sided,
                          const ClusteringLimits& limits);

}  // namespace surefoot::bake
