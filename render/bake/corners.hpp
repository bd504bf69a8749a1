// Corners of coarse levels: which of the vertices that lie in one place they go to, once the simplifier has taken any.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// The vertices of the full detail that lie in one place, and differ in normal, picture or colour.
class Places {
public:
    explicit Places(const Geometry& g);
    /// Its normal stands across one of its own triangles: bent on purpose, as leaves' are, or smooth over an edge.
    [[nodiscard]] bool bent(std::uint32_t vertex) const { return bent_[vertex]; }
    /// All of its material in the place of `vertex`, which is one of the full detail.
    [[nodiscard]] std::span<const std::uint32_t> with(std::uint32_t vertex) const {
        return std::span(order_).subspan(range_[vertex].first, range_[vertex].second - range_[vertex].first);
    }

private:
    std::vector<std::uint32_t> order_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> range_;
    std::vector<bool> bent_;
};

/// Corners whose normal stands across their triangle go to the vertex in their place that fits it best: the simplifier keeps any
/// of them, and a door with colour and light of its edge is dark. Where none fits, they get the triangle's normal. What is bent
/// stays so.
void mend_corners(Geometry& g, const Places& places, GeometryPart& part);

}  // namespace surefoot::bake
