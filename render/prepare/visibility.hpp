// Visibility down a hierarchy: a box that its parent has proven inside a plane is not tested against it again.
#pragma once

#include <cstdint>

#include "render/model/view.hpp"

namespace surefoot::prepare {

/// Which planes of a frustum a box may still cross: bit i for plane i. 0: wholly inside.
using PlaneMask = std::uint8_t;
constexpr PlaneMask all_planes = 0x1f;
constexpr PlaneMask culled = 0xff;

/// The planes that `box`, inside a parent with mask `parent`, crosses; or `culled`. Conservative like model::visible(): never
/// culled when some point of the frustum touches the box. Requires the box to lie in its parent's.
PlaneMask narrow(const model::Frustum& frustum, const Box& box, PlaneMask parent);

}  // namespace surefoot::prepare
