// Triangulates simple polygons: a fan if convex, else ear clipping with exact orientation tests.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::importer {

/// Sign of the area of the triangle a, b, c: exact for all finite doubles that do not overflow when multiplied.
/// > 0: counter-clockwise. Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic (1997), without the middle stages.
int orientation(const dvec2& a, const dvec2& b, const dvec2& c);

/// Appends triples of corner numbers to `out`: n - 2 triangles for n corners, with the polygon's winding.
/// False: the polygon crosses or touches itself, or is too large for clipping. The rest is then a fan.
bool triangulate(std::span<const dvec3> corners, std::vector<std::uint32_t>& out);

}  // namespace surefoot::importer
