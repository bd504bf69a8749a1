// How far the pictures on a level lie from where they belong: a plate may be exact in form with its picture moved or squeezed.
#pragma once

#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Metres along the surface, at the 90 % quantile of the level's area in parts whose material is in `textured` (by material);
/// 0 without such parts. Sampled: no bound. Against the nearest place of the full detail in the same material; whole repeats of a
/// picture count as none. The quantile leaves out seams, where the nearest place is at times the other side's.
float picture_shift(const Geometry& full, const Level& level, const std::vector<bool>& textured);

}  // namespace surefoot::bake
