// Plane masks handed down the tree (the frustum test of DESIGN 8, as filament's Culler does it).
#include "render/prepare/visibility.hpp"

#include <cmath>

namespace surefoot::prepare {

PlaneMask narrow(const model::Frustum& frustum, const Box& box, PlaneMask parent) {
    if (box.empty()) return culled;
    if (parent == 0) return 0;
    const dvec3 centre = box.centre(), half = box.half();
    unsigned mask = parent;
    for (unsigned i = 0; i < frustum.planes.size(); ++i) {
        if ((mask >> i & 1U) == 0) continue;
        const dvec4& p = frustum.planes[i];
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        const double away = p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w;
        const double slack = 1e-9 * (std::abs(p.w) + reach);  // rounding far from the origin, as in model::visible
        if (away + reach < -slack) return culled;
        if (away - reach > slack) mask &= ~(1U << i);
    }
    // Crossing boxes may still lie beside the frustum's edges: the second test decides, and only they pay for it.
    if (mask != 0 && !model::visible(frustum, box)) return culled;
    return static_cast<PlaneMask>(mask);
}

}  // namespace surefoot::prepare
