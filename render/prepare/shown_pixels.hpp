// How many pixels of each leaf are not behind nearer ones, as estimated from the leaves' surfaces and outlines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/pixel_estimator.hpp"
#include "render/model/pixels.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/item_buffer.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// What large leaves are drawn from. Without a model, their outlines count too.
struct LeafSurfaces {
    const model::Model* model = nullptr;
    const model::PixelEstimator* estimator = nullptr;
    dvec3 eye{0.0};
};

/// What is seen of a leaf that is large on the screen, the points of an item buffer tell. Small leaves go over it from near to
/// far. Each point has a share that is still open. A small leaf's surface is taken to lie at random in its outline. So it covers
/// the share 1 - exp(-surface / outline) of it, and shows that share of what is open there and not behind the drawn surface. Then
/// each point counts for the leaf that is drawn there, as far as it is still open.
///
/// The view is widened by the region's angle: what may come into it in the next frames has value. The part of a small leaf's
/// outline that is beside the picture has no counted surface: half a layer is taken there.
class ShownPixels {
public:
    /// Reserves for this many candidates. run() allocates nothing below that.
    void reserve(std::uint32_t max_candidates);
    /// [candidate]: pixels of the finest choice; 0 of candidates with children. All are >= 0, and together they are at most those
    /// of the wide view. Valid until the next call. weights: one a candidate, as Evaluator::evaluate made them. picture: the view
    /// that surfaces are counted in.
    std::span<const float> run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                               std::span<const Choice> choices, const model::ViewScale& wide, const model::ViewScale& picture,
                               const LeafSurfaces& surfaces = {});

private:
    static constexpr int across = ItemBuffer::columns, down = ItemBuffer::rows;
    static constexpr std::size_t max_pieces = 4096;           ///< of one leaf
    static constexpr std::size_t max_pieces_a_frame = 60000;  ///< more leaves count as small: 2 ms at most
    /// The grid, and the part of it that is the picture.
    struct Tiles {
        float px = 0;  ///< of one
        float picture_x = 1, picture_y = 1;
    };
    float show(const Outline& outline, float surface_px, float depth_m, const Tiles& tiles);
    /// False: it is to be shown as a small one.
    bool draw(std::uint32_t leaf, const Choice& finest, const Box& box, float points, const model::ViewScale& wide,
              const Tiles& tiles, const LeafSurfaces& surfaces);

    std::vector<std::uint32_t> order_;  ///< leaves, near to far
    std::vector<float> shown_;
    std::vector<float> open_;  ///< [point]: share that no small leaf has covered yet
    ItemBuffer drawn_;
    std::vector<model::SeenPiece> pieces_;  ///< of one leaf
    std::size_t pieces_drawn_ = 0;          ///< in this frame
};

}  // namespace surefoot::prepare
