// How much of a ground is seen from a point: the measure by which default paths choose where to go.
#pragma once

#include <cstddef>

#include "render/model/ground.hpp"

namespace surefoot::bake {

/// Different blocks of triangles that level rays and rising rays from `eye` hit on their front, `reach_m` away at most. Houses
/// and rooms with things in them give many, a bare rock few, and the inside of something solid none: it shows backs only.
std::size_t blocks_seen(const model::Ground& ground, const dvec3& eye, double reach_m);

}  // namespace surefoot::bake
