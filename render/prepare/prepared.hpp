// The prepared frame: visible candidates with cost, error and benefit for a region of poses, in flat arrays.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/model/view.hpp"

namespace surefoot::prepare {

using model::Index;
using model::none;

/// A representation that is legal in the whole region, with its predictions. Of a candidate's choices, coarse to fine: cost
/// rises and error falls strictly; the first is the cheapest legal one.
struct Choice {
    Index rep = 0;
    model::ItemCost cost;  ///< us, at the region's most expensive eye position
    float error_rad = 0;   ///< largest angular error over the region: error_m / max(distance, near)
    /// 0..1, of leaving this choice for the next finer one (or for the children): the node's own, held down to what its
    /// ancestors and coarser choices have, so monotone down the tree. What best-first searches by.
    float benefit = 0;
    /// 0..1, the same from what is visible below: seen from the nearest visible descendant, and at least the greatest of
    /// them; monotone down the tree. What two-stage best-first searches by (Maciel 3.5.3, figures 3.17 and 3.18).
    float subtree_benefit = 0;
    std::uint32_t triangles = 0;
};

/// A visible node. Visible children are contiguous candidates, in node order, after their parent; 0 is the root.
struct Candidate {
    Index node = 0;
    Index parent = none;
    Index first_child = none;  ///< candidate index; none: leaf, not worth refining, or cut off by a limit
    std::uint32_t child_count = 0;
    Index first_choice = 0;
    std::uint32_t choice_count = 0;  ///< >= 1
    model::ItemCost children_cost;   ///< sum of the visible children's first choices
    model::ItemCost floor_cost;      ///< of the cheapest legal cut of what is visible below
    float pixels = 0;                ///< projected box area in the view, clipped to it
    bool floor_open = false;         ///< the cheapest cut below goes through the children
};

/// Poses that the eye may have when the set is used.
struct Region {
    Pose centre;
    double radius_m = 0;
    double angle_rad = 0;
};

struct PreparedFrame {
    std::uint64_t frame = 0;  ///< the frame whose pose was newest when this was begun
    Region region;
    model::Viewport viewport;
    std::vector<Candidate> candidates;  ///< reserved at start; never grows after; empty: nothing is visible
    std::vector<Choice> choices;
    model::ItemCost full_cost;   ///< of every visible leaf's finest choice: full detail of what nothing hides
    std::uint32_t visits = 0;    ///< nodes looked at, invisible ones included
    std::uint32_t hidden = 0;    ///< of them, in the view but behind others; nodes below them were not looked at
    bool truncated = false;      ///< capacity reached: deeper detail left out, still a complete legal tree
    float target_error_rad = 0;  ///< nodes below it were not opened and their finer forms left out
    double cpu_us = 0;           ///< all workers together
    double wall_us = 0;
};

/// Called on worker threads, not on the one that calls run(); several at a time.
struct WorkerHooks {
    std::function<void(int number)> on_start;  ///< as a worker starts, before its first task; numbers from 1
    std::function<void()> on_first_task;       ///< then, once, within its first task
    [[nodiscard]] bool any() const { return on_start || on_first_task; }
};

/// Limits and weights of preparation, fixed when the Preparer is made.
struct PrepareOptions {
    double target_error_rad = 0;  ///< do not open nodes whose error is below this (0: an eighth of a pixel)
    std::uint32_t max_candidates = 1U << 18U;
    std::uint32_t max_choices = 1U << 20U;
    double focus_strength = 0.5;  ///< 0: periphery counts as the centre
    int workers = 1;              ///< the caller of run() among them
    WorkerHooks worker_hooks;     ///< where given, the workers start with the Preparer; else as they are first wanted
    bool occlusion = true;        ///< leave out what is hidden from the whole region
    bool full_depth = false;      ///< go down to the leaves, whatever their error (reference pictures, `flat`)
    /// Where a frame looked at more nodes than this, the next ones raise the error below which nodes are not opened, by a
    /// tenth a frame or more, and lower it again when there is room: bounds the CPU time on any model (a visit takes about
    /// 0.2 us, and 0.1 more where something may hide it, so that this is 4 to 6 ms). 0: no limit.
    std::uint32_t max_visits = 18000;
};

/// Prepares frames with a oneTBB arena of its own. Level by level, so the arrays are bit-equal at any worker count.
class Preparer {
public:
    Preparer(const model::Model& model, const model::CostModel& costs, const PrepareOptions& options);
    ~Preparer();
    Preparer(const Preparer&) = delete;
    Preparer& operator=(const Preparer&) = delete;

    /// Reserves the arrays of a frame so that run() does not allocate.
    void reserve(PreparedFrame& frame) const;
    /// Fills `out` for `region`. Numbers of the region that are not finite are replaced (position by the model's centre).
    /// Depends on the frames before only where one of them exceeded max_visits. speed: eye speed in m/s and turn rate rad/s for
    /// the motion term of the benefit.
    void run(const Region& region, model::Viewport viewport, std::uint64_t frame, double speed_mps, double turn_rps,
             PreparedFrame& out);

    /// What the choices' costs are predicted by.
    [[nodiscard]] const model::ItemCosts& item_costs() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::prepare
