// A random point of a box, drawn in one order by every compiler: that of a call's arguments is the compiler's.
#pragma once

#include "rt/base/geometry.hpp"
#include "rt/base/random.hpp"

namespace surefoot {

/// Uniform in [low, high), component by component, z first; one that has no room to vary draws nothing.
inline dvec3 any_in(Random& random, const dvec3& low, const dvec3& high) {
    dvec3 point = low;
    for (int axis = 2; axis >= 0; --axis)
        if (low[axis] < high[axis]) point[axis] = random.range(low[axis], high[axis]);
    return point;
}

}  // namespace surefoot
