// How far a box with captured faces is from what it shows.
#pragma once

#include "render/bake/emit.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Upper bound: the parallax of a picture (the deepest captured point behind its face), the two-sided distance between the
/// opaque texels and the surface, whichever is more, and a texel. `shown` is about the box's centre.
float box_error(const BoxForm& form, const Geometry& shown, const vec3& half, float slack);

}  // namespace surefoot::bake
