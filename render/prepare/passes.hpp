// What goes up and down the tree: planes that a box may still cross, sums and greatest benefits upwards, monotone benefits
// downwards.
#pragma once

#include <cstdint>
#include <span>

#include "render/model/view.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

// ---- visibility: a box that its parent has proven inside a plane is not tested against it again ----

/// Which planes of a frustum a box may still cross: bit i for plane i. 0: wholly inside.
using PlaneMask = std::uint8_t;
constexpr PlaneMask all_planes = 0x1f;
constexpr PlaneMask culled = 0xff;

/// The planes that `box`, inside a parent with mask `parent`, crosses; or `culled`. Conservative like model::visible(): never
/// culled when some point of the frustum touches the box. Requires the box to lie in its parent's.
PlaneMask narrow(const model::Frustum& frustum, const Box& box, PlaneMask parent);

// ---- the two passes over a prepared tree ----

/// Upwards: children_cost, floor_cost, floor_open, the frame's full_cost, and subtree_benefit from `weights` (one a candidate,
/// changed to those of the subtrees). Source: Maciel 1994, figure 3.18, with the cluster's error seen from its nearest visible
/// object.
void gather_up(const model::FrameCombine& combine, float pixel_angle_rad, std::span<Weight> weights, PreparedFrame& frame);

/// Downwards: no choice has more benefit than the one before it, nor than its parent's last.
void hold_down(PreparedFrame& frame);

}  // namespace surefoot::prepare
