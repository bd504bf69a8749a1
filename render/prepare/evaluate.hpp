// One visible node seen from a region: its legal choices with cost and error, its pixels, its weight in the benefit.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// What a frame's evaluation needs of region, viewport and options; made once a frame.
struct RegionView {
    dvec3 eye{0.0};
    double radius_m = 0;
    model::ViewScale scale;  ///< at the centre's orientation: pixels are counted once, whichever way the eye turns
    model::ViewScale wide;   ///< widened by the region's angle: for size and focus, so that the rim is not forgotten
    float pixel_angle_rad = 1e-3F;
    float target_error_rad = 0;  ///< finer forms than this are left out
    bool full_depth = false;
    float focus_strength = 0.5F;
    float speed_mps = 0, turn_rps = 0;
};

/// Metres between the node's box and the nearest eye of the region; 0 inside.
float nearest_distance(const RegionView& view, const Box& box);
/// What errors are divided by.
float error_distance(float nearest_m);

/// Whether the representation may be drawn with every eye of the region.
bool legal(const model::Representation& rep, float nearest_m);
/// Error in metres of the finest legal representation.
float finest_error(const model::Model& model, const model::Node& node, float nearest_m);

/// Size x importance x focus x motion, each 0..1, and where it is seen from: what is common to the benefits of a node's
/// choices. Sources: Funkhouser's factors as Maciel 3.3.2 lists them; the accuracy factor is accuracy_gain().
struct Weight {
    float weight = 0;
    float size = 0;        ///< square root of the share of the view; importance in it
    float distance_m = 1;  ///< error_distance()
};

/// The accuracy factor of the benefit, 0..1: the mean of e / (e + 8) and e / (e + 256) with e the error in pixels. Below a
/// pixel there is little to win (a twentieth at one pixel); and what is off by hundreds of pixels (ground that is not there)
/// still goes before what is off by dozens (a coarse tree).
inline float accuracy_gain(float error_rad, float pixel_angle_rad) {
    const float error_px = error_rad / pixel_angle_rad;
    return 0.5F * (error_px / (error_px + 8.0F) + error_px / (error_px + 256.0F));
}

/// 0..1: a form that is no picture at all, where it fills the view. An error of about its distance and more is a shape that one
/// looks through, or that hangs before the eye: neither motion nor focus makes it less wrong. size: square root of its share of
/// the view.
inline float wrongness(float size, float error_rad) {
    constexpr float begins_rad = 0.75F, full_rad = 2.0F, small = 0.2F;  // small: 1/25 of the view
    return std::clamp((error_rad - begins_rad) / (full_rad - begins_rad), 0.0F, 1.0F) * std::min(1.0F, size / small);
}

/// The benefit, 0..1, of leaving a form: half of it weighs what is seen, the other half is for what is no picture, so that
/// nothing finer elsewhere goes before that.
inline float benefit_of(float weight, float gain, float wrong) { return 0.5F * weight * gain + 0.5F * wrong; }

/// One number to compare costs by, before the frame's sums are known.
inline float cost_metric(const model::FrameCombine& combine, const model::ItemCost& cost) {
    return combine.frame_us(cost.submit_us, cost.raster_us) - combine.fixed_us;
}

/// 0..1: what leaving a form costs counts against it. A half at 2 ms, the sixteenth of a 30 Hz frame that one item may cost at
/// most: of two forms that are equally wrong the cheaper one goes first, so that one dear step, which ends the search where it
/// does not fit, does not keep back dozens of cheap ones.
inline float thrift(float step_us) {
    constexpr float half_us = 2000.0F;
    return half_us / (half_us + std::max(step_us, 0.0F));
}

class Evaluator {
public:
    Evaluator(const model::Model& model, const model::CostModel& costs);

    /// Fills `candidate.pixels` and the choices, `rep_count` of the node at most; returns how many. candidate.node is given.
    /// Choices have benefit = weight x accuracy, not yet thrift, nor monotone down the tree.
    std::uint32_t evaluate(const RegionView& view, float nearest_m, Candidate& candidate, Choice* choices, Weight& weight) const;

    [[nodiscard]] const model::ItemCosts& item_costs() const { return item_costs_; }

private:
    const model::Model& model_;
    const model::CostModel& costs_;
    model::ItemCosts item_costs_;
};

}  // namespace surefoot::prepare
