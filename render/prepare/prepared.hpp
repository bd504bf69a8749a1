// The prepared frame: visible candidates with cost, error and benefit for a region of poses, in flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/covered_boxes.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/model/view.hpp"

namespace surefoot::prepare {

using model::Index;
using model::none;

/// A representation that is legal in the whole region, with its predictions. The choices of a candidate go from coarse to fine:
/// cost rises and error falls, both strictly. The first is the cheapest legal one.
struct Choice {
    Index rep = 0;
    model::ItemCost cost;  ///< us, at the region's eye that is nearest to the box, where it is most expensive
    float error_rad = 0;   ///< largest angular error over the region: error_m / max(distance, near)
    /// 0..1, of replacing this choice by the next finer one, or by the children. From the node alone; limited to the benefits of
    /// coarser choices and ancestors, so monotone down the tree. The key of best-first search.
    float benefit = 0;
    /// 0..1, the same from the visible subtree: seen from its nearest visible descendant, and at least the maximum below.
    /// Monotone down the tree. The key of two-stage search (Maciel 1994, 3.5.3, figures 3.17 and 3.18).
    float subtree_benefit = 0;
    std::uint32_t triangles = 0;
    float surface_px = 0;  ///< pixels that it rasterises, of full resolution, overdraw included. Captures have none.
    /// What the choice shows, in weighted pixels; adds up over a cut, and rises along the choices. See value.hpp.
    float value = 0;
    /// Value per us of replacing this choice, and all that follows below at that rate. Monotone down the tree. The key of
    /// `threshold`.
    float rate = 0;
};

/// A visible node. Its visible children are contiguous candidates after it, in node order. Candidate 0 is the root.
struct Candidate {
    Index node = 0;
    Index parent = none;
    Index first_child = none;  ///< candidate index; none: leaf, not worth refining, or cut off by a limit
    std::uint32_t child_count = 0;
    Index first_choice = 0;
    std::uint32_t choice_count = 0;  ///< >= 1
    model::ItemCost children_cost;   ///< sum of the visible children's first choices
    model::ItemCost floor_cost;      ///< of the cheapest legal cut of the visible subtree
    float pixels = 0;                ///< projected box area in the view, clipped to it
    float importance = 1;            ///< of the node, 0..1: a factor on errors, where all objects share one
    float full_value = 0;            ///< of full detail below, in weighted pixels. Captures have none
    bool floor_open = false;         ///< the cheapest cut of the subtree uses the children
};

/// Poses that the eye may have when the set is used.
struct Region {
    Pose centre;
    double radius_m = 0;   ///< largest distance of an eye from the centre's
    double angle_rad = 0;  ///< largest turn away from the centre's view
};

/// Groups of effects that a frame may buy, each by itself.
constexpr std::size_t max_effect_groups = 4;

/// What a picture loses where a group of effects is left out.
struct EffectLoss {
    std::span<const float> before, after;  ///< by node: mean squared difference of the colours, 0..1, in two lights; empty: none
    float between = 0;                     ///< 0..1: the light is between them
    bool is_fog = false;                   ///< the differences are of what is infinitely far
    float fog_density = 0;                 ///< Daylight::fog_density; 0 where fog is left out, but for fog itself
};

constexpr std::uint32_t value_levels = 40;

/// The best cuts of a whole frame by the rate at which they stop: value (weighted pixels) and cost (us, of the items alone). Both
/// rise from level to level.
struct ValueCurve {
    std::array<float, value_levels> value{}, cost{};
    float full_value = 0;  ///< of full detail at full resolution
    /// The greatest value that this cost buys; between levels interpolated.
    [[nodiscard]] float value_at(float cost_us) const;
};

/// The candidates of a region. Filled by the prepare thread, then read by the frame thread only.
struct PreparedFrame {
    std::uint64_t frame = 0;  ///< the frame whose pose was newest when preparation began
    Region region;
    double from_s = 0, to_s = 0;  ///< times of the pictures that it is for: where what moves may be
    model::Viewport viewport;
    std::vector<Candidate> candidates;  ///< reserved at start; never grows after; empty: nothing is visible
    std::vector<Choice> choices;
    model::ItemCost full_cost;                 ///< of the finest choice of every visible leaf
    float full_filter_us = 0;                  ///< raster time that two mip levels add to full_cost; 0: they are not bought
    double full_value = 0;                     ///< sum of their values; 0: not computed
    ValueCurve curve;                          ///< of the best cuts
    float full_factor = 1, coarse_factor = 1;  ///< in the costs of full detail and of all other forms
    model::EffectMask without = 0;             ///< effects that are not in the costs
    std::array<float, max_effect_groups>
        effect_value{};          ///< weighted pixels that each group of effects shows; 0: none, or not set
    float resolution = 1;        ///< of the picture that the costs are for, 0..1]: share of its width
    float resolution_value = 0;  ///< weighted pixels: what it shows more than full resolution for the same time
    std::uint32_t visits = 0;    ///< nodes tested, invisible ones included
    std::uint32_t hidden = 0;    ///< of these, nodes in the view that others hide; their subtrees were not tested
    model::CoverBits covered;    ///< what pictures show: nodes that lie wholly in it are no candidates; set before run()
    std::uint32_t left_out = 0;  ///< nodes in the view that lie there; their subtrees were not tested
    bool truncated = false;      ///< capacity reached: deeper detail is missing, but the tree is complete and legal
    double acuity_rad = 0;       ///< PrepareOptions::acuity_rad
    float target_error_rad = 0;  ///< nodes with a smaller error were not opened, and finer choices not offered
    double cpu_us = 0;           ///< all workers together
    double wall_us = 0;
};

/// The smallest angle that shows: a pixel's, or what the eye can tell apart if that is more.
inline double resolved_rad(const PreparedFrame& frame) {
    return std::max(model::pixel_angle(frame.region.centre, frame.viewport), frame.acuity_rad);
}

/// Called on worker threads, several at a time; never on the thread that calls run().
struct WorkerHooks {
    std::function<void(int number)> on_start;  ///< when a worker starts, before its first task; numbered from 1
    std::function<void()> on_first_task;       ///< once, within its first task
    [[nodiscard]] bool any() const { return on_start || on_first_task; }
};

/// Limits and weights of preparation, fixed when the Preparer is made.
struct PrepareOptions {
    /// Do not open nodes whose error is below this. 0: an eighth of a drawn pixel, or the acuity if that is more.
    double target_error_rad = 0;
    /// Angle that the eye can tell apart, seen in the picture's own field of view; 0: unknown, so a pixel is.
    double acuity_rad = 0;
    /// The field of view at which the acuity holds, radians; a narrower one is magnified for the eye. 0: it holds at any.
    double acuity_fov_y_rad = 0;
    std::uint32_t max_candidates = 1U << 18U;
    std::uint32_t max_choices = 1U << 20U;
    double focus_strength = 0.5;  ///< 0: the periphery counts as much as the centre
    /// 0..1: how much of its loss a group's own form is forgiven if all members are alike; 0: none.
    double gestalt = 0;
    int workers = 1;           ///< with the caller of run()
    WorkerHooks worker_hooks;  ///< if set, workers start with the Preparer, else at first use
    bool occlusion = true;     ///< occlusion culling for the whole region
    bool full_depth = false;   ///< open all nodes down to the leaves (reference images, `flat`)
    /// Bounds the CPU time on any model: 7 to 9 ms, 3 of them for shown pixels. A visit takes about 0.2 us, and 0.1 us more with
    /// occlusion. After a frame with more visits, the next frames raise target_error_rad by at least a tenth each. They lower it
    /// when there is room. 0: no limit.
    std::uint32_t max_visits = 18000;
    std::array<float, 3> sky = model::usual_sky;  ///< what is missing before it shows this colour
};

/// Prepares frames in its own oneTBB arena, level by level. The arrays are bit-equal at any worker count.
class Preparer {
public:
    Preparer(const model::Model& model, const model::CostModel& costs, const PrepareOptions& options);
    ~Preparer();
    Preparer(const Preparer&) = delete;
    Preparer& operator=(const Preparer&) = delete;

    /// Reserves the arrays of a frame so that run() does not allocate.
    void reserve(PreparedFrame& frame) const;
    /// Fills `out` for `region`. Non-finite numbers of the region are replaced; a position becomes the model's centre.
    /// Independent of earlier frames, unless one exceeded max_visits. speed_mps, turn_rps: of the eye, for the motion factor.
    /// out.resolution: of the picture that costs and detail are for, as a share of the viewport's width.
    /// out.full_factor, out.coarse_factor: on the costs of full detail and of all other forms. out.without: not in the costs.
    void run(const Region& region, model::Viewport viewport, std::uint64_t frame, double speed_mps, double turn_rps,
             PreparedFrame& out);
    /// The same frame's values and costs at another resolution, without a new search for what is visible.
    const ValueCurve& value_at(float resolution);
    /// Adds the time of the last value_at() to that of `out`.
    void add_value_time(PreparedFrame& out) const;

    /// Of the next run(): fills effect_value by these. At first there are none. What the spans hold must outlive the run.
    void set_effect_losses(const std::array<EffectLoss, max_effect_groups>& losses);

    /// Of the next runs: leaves out what PreparedFrame::covered covers. Null, as at first: nothing. It must outlive the preparer.
    void set_cover(const model::CoverTest* test);

    /// Predicts the costs of the choices.
    [[nodiscard]] const model::ItemCosts& item_costs() const;

    /// Ends the worker threads; run() then works on the caller alone. A destructor does it too.
    void end_workers();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::prepare
