// The prepared frame: visible candidates with cost, error and benefit for a region of poses, in flat arrays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/model/view.hpp"

namespace surefoot::prepare {

using model::Index;
using model::none;

/// A representation that is legal in the whole region, with its predictions. Of a candidate's choices, coarse to fine:
/// error falls strictly; the first is the cheapest legal one.
struct Choice {
    Index rep = 0;
    model::ItemCost cost;       ///< us, at the region's most expensive pose
    float error_rad = 0;        ///< largest angular error over the region: error_m / max(distance, near)
    float benefit = 0;          ///< 0..1, of leaving this choice for the next finer one (or for the children); monotone down the tree
};

/// A visible node. Visible children are contiguous candidates, in node order, after their parent; 0 is the root.
struct Candidate {
    Index node = 0;
    Index parent = none;
    Index first_child = none;        ///< candidate index; none: leaf, not worth refining, or cut off by a limit
    std::uint32_t child_count = 0;
    Index first_choice = 0;
    std::uint32_t choice_count = 0;  ///< >= 1
    model::ItemCost children_cost;   ///< sum of the visible children's first choices
    float pixels = 0;                ///< projected box area in the view, clipped to it
};

/// Poses that the eye may have when the set is used.
struct Region {
    Pose centre;
    double radius_m = 0;
    double angle_rad = 0;
};

struct PreparedFrame {
    std::uint64_t frame = 0;          ///< the frame whose pose was newest when this was begun
    Region region;
    model::Viewport viewport;
    std::vector<Candidate> candidates;  ///< reserved at start; never grows after
    std::vector<Choice> choices;
    std::uint32_t visits = 0;         ///< nodes looked at, invisible ones included
    bool truncated = false;           ///< capacity reached: deeper detail left out, still a complete legal tree
    double cpu_us = 0;                ///< all workers together
    double wall_us = 0;
};

/// What the last frames taught: previous cut's refinement, for hysteresis. Written by the frame thread, one byte a node.
struct PrepareOptions {
    double target_error_rad = 0;      ///< do not open nodes whose error is below this (0: half a pixel)
    std::uint32_t max_candidates = 1U << 18U;
    std::uint32_t max_choices = 1U << 20U;
    double focus_strength = 0.5;      ///< 0: periphery counts as the centre
    int workers = 1;
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
    /// Fills `out` for `region`. speed: eye speed in m/s and turn rate rad/s for the motion term of the benefit.
    void run(const Region& region, model::Viewport viewport, std::uint64_t frame, double speed_mps, double turn_rps, PreparedFrame& out);

private:
    struct Impl;
    Impl* impl_;
};

}  // namespace surefoot::prepare
