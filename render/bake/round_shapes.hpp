// Spheres and cylinders: recognised by their triangles, and made again with any number of sides. Their errors are known without
// measuring. Source: Pasman & Jansen 2002, 3.2: "for some primitives this curve can be derived mathematically".
#pragma once

#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Levels from fine to coarse, full detail left out, each of at most `ratio` times the triangles of the one before, down to
/// `smallest`; empty: the geometry is no whole sphere, and no whole cylinder along an axis of its frame, of one material and one
/// colour, without a picture, with the normals of its shape. Their vertices are added to the geometry. Errors bound the two-sided distance to it: both surfaces
/// have their vertices on one round shape, and lie within the larger of two sags of it.
std::vector<Level> round_levels(Geometry& geometry, const ChainOptions& options);

}  // namespace surefoot::bake
