// A random point of a box. Draws its components in a fixed order; the order of call arguments depends on the compiler.
#pragma once

#include "rt/base/geometry.hpp"
#include "rt/base/random.hpp"

namespace surefoot {

/// Uniform in [low, high), component by component, z first. A component with low >= high is low and draws no number.
inline dvec3 any_in(Random& random, const dvec3& low, const dvec3& high) {
    dvec3 point = low;
    for (int axis = 2; axis >= 0; --axis)
        if (low[axis] < high[axis]) point[axis] = random.range(low[axis], high[axis]);
    return point;
}

}  // namespace surefoot
