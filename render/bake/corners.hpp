// After simplification, reassigns each corner to the best-matching of the coincident vertices.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Coincident vertices of the full detail: same position and material, different normal, uv or colour.
class CoincidentVertices {
public:
    explicit CoincidentVertices(const Geometry& g);
    /// Custom normal: it differs by more than 60 degrees from that of one of its own triangles, as on leaves or smoothed edges.
    [[nodiscard]] bool custom_normal(std::uint32_t vertex) const { return custom_normal_[vertex]; }
    /// All vertices of its material at the position of `vertex`, a vertex of the full detail.
    [[nodiscard]] std::span<const std::uint32_t> with(std::uint32_t vertex) const {
        return std::span(order_).subspan(range_[vertex].first, range_[vertex].second - range_[vertex].first);
    }

private:
    std::vector<std::uint32_t> order_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> range_;
    std::vector<bool> custom_normal_;
};

/// A corner whose normal differs by more than 60 degrees from its triangle's moves to the coincident vertex that fits best.
/// If none fits, it gets the triangle's normal. The simplifier keeps any of the coincident vertices: a door could get the dark
/// colour of its edge. Custom normals do not change.
void repair_corners(Geometry& g, const CoincidentVertices& coincident, GeometryPart& part);

}  // namespace surefoot::bake
