// Evaluates one visible node for a region of eyes: legal choices with cost and error, pixels, and weight in the benefit.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/model/moving.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Region, viewport and options in the form that the evaluation needs; made once a frame.
struct RegionView {
    dvec3 eye{0.0};
    double radius_m = 0;
    model::ViewScale scale;      ///< at the centre's orientation; used for pixels
    model::ViewScale wide;       ///< widened by the region's angle, so that the rim counts; used for size and focus
    float resolved_rad = 1e-3F;  ///< prepare::resolved_rad()
    float target_error_rad = 0;  ///< representations with a smaller error are not offered
    bool full_depth = false;
    model::EffectMask without = 0;             ///< effects that are not in the costs
    float full_factor = 1, coarse_factor = 1;  ///< on the costs of full detail and of all other forms
    float focus_strength = 0.5F;
    float speed_mps = 0, turn_rps = 0;  ///< of the eye
    float object_mps = 0;               ///< of what is evaluated, where it moves
};

/// The value, unless it is infinite or no number.
inline double finite_or(double value, double otherwise) { return std::isfinite(value) ? value : otherwise; }

/// The region with numbers: what is not finite is replaced, a position by the middle of the model's box.
Region cleaned(const Region& region, const Box& root);
/// The view of the frame's region. target_factor: on the error from which nodes are opened.
RegionView region_view(const PreparedFrame& frame, const PrepareOptions& options, float target_factor, double speed_mps,
                       double turn_rps);
/// The view as a moving thing has it: turned and moved back, so that the thing stands at rest. The region grows by its drift.
RegionView seen_at_rest(const RegionView& view, const model::MovingNode& moving);

/// Metres between the node's box and the nearest eye of the region; 0 inside.
float nearest_distance(const RegionView& view, const Box& box);
/// Error in metres of the finest legal representation.
float finest_error(const model::Model& model, const model::Node& node, float nearest_m);

/// The rectangle round a box as the eye in the middle of the region sees it. -1..1 is the wide view.
struct Outline {
    float left = 1, low = 1, right = -1, high = -1;
};

/// What is beside the eye counts as at the near plane. What is wholly behind it has none.
Outline outline_of(const RegionView& view, const Box& box);

/// What all choices of a node share.
/// Source of the factors: Funkhouser & Séquin 1993, as in Maciel 1994, 3.3.2. The accuracy factor is accuracy_gain().
struct Weight {
    float weight = 0;        ///< of the benefit: size x importance x focus x motion, each 0..1
    float size = 0;          ///< square root of the share of the view, times importance
    float distance_m = 1;    ///< model::error_distance()
    float pixel_weight = 0;  ///< of one pixel in the value: importance x focus x motion
    Outline outline;
    float size_m = 0;  ///< square root of the box's outline, as a mean of all directions
};

/// The accuracy factor of the benefit, 0..1: the mean of e / (e + 8) and e / (e + 256), with e the error in
/// pixels. If the acuity is more than a pixel, e is in multiples of that.
/// Errors below a pixel win little: a twentieth at one pixel. An error of hundreds of pixels (missing ground) still ranks above
/// one of dozens (a coarse tree).
inline float accuracy_gain(float error_rad, float resolved_rad) {
    const float error_px = error_rad / resolved_rad;
    return 0.5F * (error_px / (error_px + 8.0F) + error_px / (error_px + 256.0F));
}

/// 0..1: penalty of an unusable representation that fills the view. With an error of about its distance or more, the eye sees
/// through the shape, or the shape hangs before the eye. Motion and focus do not reduce this penalty.
/// size: square root of its share of the view.
inline float unusable_penalty(float size, float error_rad) {
    constexpr float begins_rad = 0.75F, full_rad = 2.0F, small = 0.2F;  // small: 1/25 of the view
    return std::clamp((error_rad - begins_rad) / (full_rad - begins_rad), 0.0F, 1.0F) * std::min(1.0F, size / small);
}

/// The benefit, 0..1, of replacing a representation by a finer one. One half is the weighted accuracy. The other half is the
/// penalty of unusable representations, so that these are replaced before anything else is refined.
inline float benefit_of(float weight, float gain, float wrong) { return 0.5F * weight * gain + 0.5F * wrong; }

/// One number by which costs are compared before the frame's sums are known, us.
inline float cost_metric(const model::FrameCombine& combine, const model::ItemCost& cost) {
    return combine.frame_us(cost.submit_us, cost.raster_us) - combine.fixed_us;
}

/// Factor 0..1 by which an expensive step loses benefit. It is a half at 2 ms: 1/16 of a 30 Hz frame, the limit of an item.
/// Of two equally wrong representations the cheaper step goes first. Otherwise one expensive step that does not fit would end
/// the search before dozens of cheap ones.
inline float cost_penalty(float step_us) {
    constexpr float half_us = 2000.0F;
    return half_us / (half_us + std::max(step_us, 0.0F));
}

/// Fills the choices of a candidate with cost, error and benefit. Constant after it is made; any thread may use it.
class Evaluator {
public:
    Evaluator(const model::Model& model, const model::CostModel& costs);

    /// Fills `candidate.pixels` and the choices, at most `rep_count` of the node; returns their number. Requires candidate.node.
    /// The choices have benefit = 0.5 weight x gain + 0.5 unusable (see README.md). Cost is not in it yet, and it is not yet
    /// monotone down the tree. box: the node's, as the view has it; what moves stands at rest in both.
    std::uint32_t evaluate(const RegionView& view, const Box& box, float nearest_m, Candidate& candidate, Choice* choices,
                           Weight& weight) const;
    std::uint32_t evaluate(const RegionView& view, float nearest_m, Candidate& candidate, Choice* choices, Weight& weight) const {
        return evaluate(view, model_.nodes[candidate.node].box, nearest_m, candidate, choices, weight);
    }

    [[nodiscard]] const model::ItemCosts& item_costs() const { return item_costs_; }

private:
    const model::Model& model_;
    const model::CostModel& costs_;
    model::ItemCosts item_costs_;
};

}  // namespace surefoot::prepare
