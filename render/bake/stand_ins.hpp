// Stand-ins that an artist made, as levels of the chain of their object.
#pragma once

#include <span>
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

/// The usable ones of a mesh of the scene. `model` has its materials, `object` its geometry. Others get a line in `notes`. These
/// are empty, have as many triangles as the object, or reach beyond it by a tenth of its size.
std::vector<ArtistStandIn> stand_ins_of(const importer::Scene& scene, importer::Index mesh, const model::Model& model,
                                        const Geometry& object, std::vector<std::string>& notes);

/// Adds them to the object's levels, with the bound of their two-sided distance to full detail. It counts as at least
/// min_proxy_error, since distance says nothing of a picture. Made levels of about as many triangles go, and so do those that are
/// no better. Coarser made levels get errors above it. One that is off by a quarter of the object's size is left out, with a line
/// in `notes`.
void add_stand_ins(LodChain& chain, std::span<const ArtistStandIn> stand_ins, float slack, std::vector<std::string>& notes);

}  // namespace surefoot::bake
