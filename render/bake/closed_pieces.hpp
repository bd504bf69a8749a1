// Pieces of cut meshes that see no sky in some place, by themselves: rays start from their own triangles.
#pragma once

#include <span>
#include <vector>

#include "render/bake/objects.hpp"
#include "render/bake/scene_light.hpp"

namespace surefoot::bake {

/// Sets MeshForm::closed_in of pieces, where it is not set. Before a mesh is cut, a vertex on the border between what sees sky
/// and what does not counts for both. Not where the mesh moves. by_mesh: all forms of each mesh. objects: their places, by mesh.
/// On all cores of the calling arena. False: stopped.
bool find_closed_pieces(std::vector<std::vector<MeshForm>>& by_mesh, std::span<const PlacedObject> objects,
                        const model::Model& model, const LightRays& rays, const Progress& progress);

}  // namespace surefoot::bake
