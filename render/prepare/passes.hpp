// The two passes over a prepared tree: sums and greatest benefits upwards, monotone benefits downwards.
#pragma once

#include <span>

#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Upwards: children_cost, floor_cost, floor_open, the frame's full_cost, and subtree_benefit from `weights` (one a candidate,
/// changed to those of the subtrees). Source: Maciel 1994, figure 3.18, with the cluster's error seen from its nearest visible
/// object.
void gather_up(const model::FrameCombine& combine, float pixel_angle_rad, std::span<Weight> weights, PreparedFrame& frame);

/// Downwards: no choice has more benefit than the one before it, nor than its parent's last.
void hold_down(PreparedFrame& frame);

}  // namespace surefoot::prepare
