// Which boxes of a tree are in view. Only planes that a box's parent lies across are tested, and nothing in a box that is whole
// in view, or out of it.
#pragma once

#include <bit>
#include <cmath>

#include "render/model/view.hpp"

namespace surefoot::cache {

constexpr unsigned all_planes = 31;   ///< bits of Frustum::planes
constexpr unsigned out_of_view = 32;  ///< of planes_across()

/// Planes that the box lies across; only those of `among` are tested: its parent lies across no other. Or out_of_view, where
/// model::visible() is false. A box that is before all planes but one, and lies across that one, is in view.
inline unsigned planes_across(const model::Frustum& frustum, const Box& box, unsigned among) {
    if (box.empty() || among == out_of_view) return out_of_view;
    if (among == 0) return 0;
    const dvec3 centre = box.centre(), half = box.half();
    unsigned across = 0;
    for (unsigned i = 0; i < frustum.planes.size(); ++i) {
        if ((among >> i & 1U) == 0) continue;
        const dvec4& p = frustum.planes[i];
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        const double away = p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w;
        if (away + reach < -1e-9 * (std::abs(p.w) + reach)) return out_of_view;  // as visible() has it
        if (!(away >= reach)) across |= 1U << i;
    }
    return std::popcount(across) > 1 && !model::visible(frustum, box) ? out_of_view : across;
}

}  // namespace surefoot::cache
