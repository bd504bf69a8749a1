// One grid of cells over a geometry, and the clustered mesh that it yields (vertex_clusters.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// A triangle of the source, with its plane.
struct SourceTriangle {
    std::array<std::uint32_t, 3> vertex;
    std::uint32_t part = 0;
    float area = 0;
    vec3 normal{0};  ///< unit, by winding
};

/// Input of the clustering; made once, used at every resolution.
struct ClusterSource {
    const Geometry* geometry = nullptr;
    std::span<const std::uint32_t> owners;
    std::vector<SourceTriangle> triangles;
    std::vector<bool> one_sided;  ///< a part
    std::vector<float> weight;    ///< a vertex: area of its triangles
    vec3 low{0};
    float longest = 0;  ///< longest side of the box
};
ClusterSource make_source(const Geometry& g, std::span<const std::uint32_t> owners, const std::vector<bool>& two_sided);

/// A clustered mesh, with an error bound for each of its triangles and each source triangle. The bounds are vertex movements.
struct GridMesh {
    std::vector<model::Vertex> vertices;
    std::vector<std::array<std::uint8_t, 4>> baked;
    std::vector<GeometryPart> parts;  ///< as many as the source has, some empty
    std::vector<float> out_bound;     ///< a triangle of the mesh, part by part
    std::vector<float> source_bound;  ///< a source triangle
    [[nodiscard]] std::size_t triangles() const { return out_bound.size(); }
};
/// `steps` cells along the longest side.
GridMesh grid_mesh(const ClusterSource& source, std::uint32_t steps);

}  // namespace surefoot::bake
