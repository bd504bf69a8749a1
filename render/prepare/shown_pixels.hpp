// How many pixels of each leaf are not behind nearer ones, as estimated from the leaves' surfaces and outlines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/pixel_estimator.hpp"
#include "render/model/pixels.hpp"
#include "render/prepare/before_sky.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/item_buffer.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// What large leaves are drawn from. Without a model, their outlines count too.
struct LeafSurfaces {
    const model::Model* model = nullptr;
    const model::PixelEstimator* estimator = nullptr;
    dvec3 eye{0.0};
    const model::MovingNodes* moving = nullptr;  ///< null: all stand still
};

/// The points of an item buffer give what a large leaf shows. Small leaves go over the same points from near to far.
/// Each point has a share that is still open. A small leaf's surface is taken to lie at random in its outline. It covers the
/// share 1 - exp(-surface / outline), and shows that share of what is open and not behind the drawn surface. Then each point
/// counts for the leaf that is drawn there, as far as it is still open.
///
/// The view is widened by the region's angle: what may come into it in the next frames has value. The part of a small leaf's
/// outline that is beside the picture has no counted surface: half a layer is taken there.
class ShownPixels {
public:
    /// Reserves for this many candidates and hidden nodes. run() allocates nothing below that.
    void reserve(std::uint32_t max_candidates, std::uint32_t max_hidden = 0);
    /// [candidate]: pixels of the finest choice; 0 of candidates with children. All are >= 0, and together they are at most those
    /// of the wide view. Valid until the next call. weights: one a candidate, as Evaluator::evaluate made them. picture: the view
    /// that surfaces are counted in. hidden: what is behind, though no candidate.
    std::span<const float> run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                               std::span<const Choice> choices, const model::ViewScale& wide, const model::ViewScale& picture,
                               const LeafSurfaces& surfaces = {}, std::span<const HiddenNode> hidden = {});
    /// Of the last run(): those with nothing but the sky behind. They are valid until the next.
    [[nodiscard]] SkyPixels before_sky() const { return sky_.pixels(); }

private:
    static constexpr int across = ItemBuffer::columns, down = ItemBuffer::rows;
    static constexpr std::uint32_t max_work = 600'000;  ///< points and pieces looked at in a frame: about 3 ms
    /// The grid, and the part of it that is the picture.
    struct Grid {
        float point_px = 0;  ///< pixels of one point
        float picture_x = 1, picture_y = 1;
    };
    /// The share of its outline that a surface covers. points: of the outline.
    static float cover(const Outline& outline, float surface_px, float points, const Grid& grid);
    float show(const Outline& outline, float surface_px, float depth_m, std::uint32_t rank, const Grid& grid);
    /// What is large and was not drawn, over blocks of points: it is behind all that was drawn, and hides what comes after.
    float show_coarsely(const Outline& outline, float surface_px, const Grid& grid);
    /// Pixels of a leaf at a point. What is beside the picture is not before the sky yet.
    void show_before_sky(std::uint32_t leaf, float pixels, const Weight& of, int x, int y, const Grid& grid);
    /// A leaf without points is judged at the middle of its outline.
    void show_before_sky(std::uint32_t leaf, const Weight& of, const Grid& grid);
    void begin_blocks();
    void end_blocks();
    /// False: its surface is unknown, or the frame's work is done.
    bool draw(std::uint32_t leaf, const Candidate& candidate, const Choice& finest, const Outline& outline,
              const model::ViewScale& wide, const Grid& grid, const LeafSurfaces& surfaces);

    std::vector<std::uint32_t> order_;   ///< leaves, near to far
    std::vector<std::uint32_t> coarse_;  ///< those of show_coarsely()
    std::vector<float> shown_;
    std::vector<float> open_;  ///< [point]: share that no small leaf has covered yet
    ItemBuffer drawn_;
    BeforeSky sky_;
    std::vector<float> blocks_, blocks_before_;  ///< [block]: share of its points that is open; empty: not begun
    std::vector<model::SeenPiece> pieces_;       ///< of one leaf
    std::uint32_t work_ = 0;                     ///< of this frame
};

}  // namespace surefoot::prepare
