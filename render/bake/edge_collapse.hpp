// Simplifies a mesh by collapsing edges, and keeps what it shows. Normals, texture coordinates and colours have quadrics of their
// own. Quadrics: Garland and Heckbert 1997. With attributes: Hoppe 1999, sections 3 and 4.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// What may not move, and how much each kind of error counts. Errors are squared metres times area.
struct CollapseOptions {
    bool fixed_borders = false;    ///< borders of the mesh stay as they are, for what others join
    double uv_weight = 0.5;        ///< of a picture that lies a metre off along the surface; 1: as much as the surface itself
    double normal_weight = 0.005;  ///< metres for a normal that is off by its length, as a share of the mesh's diagonal
    double colour_weight = 0.03;   ///< the same for a vertex colour that is off by its whole range
    double border_weight = 3, seam_weight = 0.5;  ///< of a border or seam that moves aside; its length squared counts as the area
};

/// A mesh that shrinks edge by edge, the cheapest first. Vertices keep their places and attributes, so each result uses vertices
/// of the source. All parts are simplified together: materials do not part. No connected part vanishes.
class EdgeCollapse {
public:
    /// `vertices` must outlive this. The parts' order counts, and that of their triangles, but no thread or address does.
    EdgeCollapse(std::span<const model::Vertex> vertices, std::span<const GeometryPart> parts, const CollapseOptions& options);
    ~EdgeCollapse();
    EdgeCollapse(const EdgeCollapse&) = delete;
    EdgeCollapse& operator=(const EdgeCollapse&) = delete;

    /// Collapses until at most this many triangles are left, or no edge may collapse any more. Returns what is left.
    std::uint32_t reduce_to(std::uint32_t triangles);
    /// What is left, over the source's vertices; parts in the source's order, empty ones left out.
    [[nodiscard]] std::vector<GeometryPart> parts() const;

private:
    struct Mesh;
    std::unique_ptr<Mesh> mesh_;
};

}  // namespace surefoot::bake
