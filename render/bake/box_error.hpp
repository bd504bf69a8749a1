// The geometric error of a box impostor: how far its captured faces lie from the surface.
#pragma once

#include "render/bake/emit.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Upper bound: the larger of parallax and distance, plus one texel. Parallax: the deepest captured point behind its face.
/// Distance: two-sided, between opaque texels and surface. `shown` is relative to the box's centre. `slack`: as in ChainOptions.
float box_error(const BoxForm& form, const Geometry& shown, const vec3& half, float slack);

}  // namespace surefoot::bake
