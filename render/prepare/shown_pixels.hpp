// How many pixels of each leaf are not behind nearer ones, as estimated from the leaves' outlines and surfaces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/pixels.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Goes through the leaves from near to far over a grid of tiles on the view. The view is widened by the region's angle: what may
/// come into it in the next frames has value. A leaf's surface is taken to lie at random in its outline. So it covers the share
/// 1 - exp(-surface / outline) of it, and shows that share of what nearer leaves left open. The part of an outline that is beside
/// the picture has no counted surface: half a layer is taken there.
class ShownPixels {
public:
    /// Reserves for this many candidates. run() allocates nothing below that.
    void reserve(std::uint32_t max_candidates);
    /// [candidate]: pixels of the finest choice; 0 of candidates with children. All are >= 0, and together they are at most those
    /// of the wide view. Valid until the next call. weights: one a candidate, as Evaluator::evaluate made them. picture: the view
    /// that surfaces are counted in.
    std::span<const float> run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                               std::span<const Choice> choices, const model::ViewScale& wide, const model::ViewScale& picture);

private:
    static constexpr int across = 32, down = 18;
    /// The grid, and the part of it that is the picture.
    struct Tiles {
        float px = 0;  ///< of one
        float picture_x = 1, picture_y = 1;
    };
    float show(const Outline& outline, float surface_px, const Tiles& tiles);

    std::vector<std::uint32_t> order_;  ///< leaves, near to far
    std::vector<float> shown_;
    std::vector<float> open_;  ///< [tile]: share that no leaf has covered yet
};

}  // namespace surefoot::prepare
