// How many pixels of each leaf are not behind nearer ones, as estimated from the leaves' outlines and surfaces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Goes through the leaves from near to far over a grid of tiles. A leaf covers the share 1 - exp(-surface / outline) of the tiles
/// in its outline, and shows that share of what nearer leaves left open there.
class ShownPixels {
public:
    void reserve(std::uint32_t max_candidates);
    /// [candidate]: pixels, 0 of candidates with children. Valid until the next call.
    std::span<const float> run(std::span<const Weight> weights, const PreparedFrame& frame);

private:
    static constexpr int across = 32, down = 18;
    float show(const Weight& weight, float surface_px, float tile_px);

    std::vector<std::uint32_t> order_;
    std::vector<float> shown_;
    std::vector<float> open_;
};

}  // namespace surefoot::prepare
