// Spheres and cylinders: recognised by their triangles, and made again with any number of sides. Their errors are known without
// measuring. Source: Pasman & Jansen 2002, 3.2: "for some primitives this curve can be derived mathematically".
#pragma once

#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Levels from fine to coarse, full detail left out. Each has at most `ratio` times the triangles of the one before, down to
/// `smallest`. Their vertices are added to the geometry. Empty: it is no whole sphere, and no whole cylinder along an axis of its
/// frame. Round shapes have one material and one colour, no picture, and the normals of their shape.
/// Errors bound the two-sided distance to the geometry. Both have their vertices on one shape, and lie within the larger of two
/// sags of it.
std::vector<Level> round_levels(Geometry& geometry, const ChainOptions& options);

}  // namespace surefoot::bake
