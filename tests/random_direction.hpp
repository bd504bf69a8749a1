// Random directions for tests.
#pragma once

#include "rt/base/geometry.hpp"
#include "rt/base/random.hpp"

namespace surefoot::test {

/// Uniform, unit.
inline dvec3 any_direction(Random& random) {
    for (;;) {
        const dvec3 p = any_in(random, dvec3(-1), dvec3(1));
        const double length = glm::length(p);
        if (length > 0.05 && length < 1) return p / length;
    }
}

}  // namespace surefoot::test
