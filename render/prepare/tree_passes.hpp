// Passes over the tree: plane masks for culling, sums and maximum benefits upwards, monotone benefits downwards.
#pragma once

#include <cstdint>
#include <span>

#include "render/model/view.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

// ---- visibility: if a parent lies inside a plane, its children are not tested against it ----

/// Which planes of a frustum a box may still cross: bit i for plane i. 0: wholly inside.
using PlaneMask = std::uint8_t;
constexpr PlaneMask all_planes = 0x1f;
constexpr PlaneMask culled = 0xff;

/// The planes of `parent` that `box` crosses, or `culled`. Conservative like model::visible(): a box that touches the frustum is
/// never culled. Requires that the box lies in its parent's box.
PlaneMask cull_planes(const model::Frustum& frustum, const Box& box, PlaneMask parent);

// ---- the two passes over a prepared tree ----

/// Upwards: fills children_cost, floor_cost, floor_open, subtree_benefit, and the frame's full_cost.
/// weights: one a candidate; replaced by the weights of the subtrees. Source: Maciel 1994, figure 3.18; here the error of a
/// cluster is seen from its nearest visible object.
void propagate_up(const model::FrameCombine& combine, float resolved_rad, std::span<Weight> weights, PreparedFrame& frame);

/// Downwards: limits each benefit to that of the choice before it, and to that of the parent's last choice.
void enforce_monotone_benefit(PreparedFrame& frame);

}  // namespace surefoot::prepare
