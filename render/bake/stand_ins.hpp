// Stand-ins that an artist made, as levels of the chain of their object.
#pragma once

#include <string>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/import/scene.hpp"

namespace surefoot::bake {

/// A stand-in of one mesh, in the frame of that mesh.
struct ArtistStandIn {
    std::string name;
    Geometry geometry;
};

/// Those of one mesh of the scene. `model` has its materials.
std::vector<ArtistStandIn> stand_ins_of(const importer::Scene& scene, importer::Index mesh, const model::Model& model);

/// Why it can be no form of the object: it is empty, as large as the object or larger. Empty if it can.
std::string why_no_stand_in(const Geometry& stand_in, const Geometry& object);

/// Adds it to the object's levels, with the bound of its two-sided distance to full detail. Levels of about as many triangles go,
/// and so do those that it beats. Of the others, coarser ones get errors above it: an artist's stand-in looks better than its
/// distance says. Its error counts as at least min_proxy_error, since distance says nothing of its picture.
void add_stand_in(LodChain& chain, const Geometry& stand_in, float slack);

}  // namespace surefoot::bake
