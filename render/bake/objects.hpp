// Conceptual objects with their geometry: meshes turned into geometry once, large ones cut into pieces, chains for all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// The chain of one mesh, or of one piece of a mesh that is too large to draw whole.
struct MeshForm {
    LodChain chain;
    std::uint64_t triangles = 0;
    Box box;  ///< in the mesh's frame
};

struct PlacedObject {
    std::uint32_t mesh = 0;  ///< in the list of forms
    dmat4 world{1};
    std::string name;
    float importance = 1;
    Box box;                   ///< world
    std::uint32_t object = 0;  ///< the conceptual object it is, or is a piece of
    bool piece = false;
};

struct CutLimits {
    std::uint32_t most_triangles = 8192;  ///< of a piece: the 1/16-frame rule
    double longest_m = 1e30;              ///< of a piece, mesh frame: no piece is drawn whole for one corner in view
    std::uint32_t least_triangles = 512;  ///< no piece is cut for its length alone below twice that: a draw costs as much as 50
    /// What is made of few triangles and is several layers deep (the walls of a storey) is cut for its length down to this: drawn
    /// whole, most of its pixels are behind its own front, and a layer costs more than the draws.
    std::uint32_t least_hidden = 32;
    std::uint32_t most_hidden = 4096;  ///< few
};

/// Largest factor by which `linear` stretches a length: what errors grow by. An upper bound, within 1e-8.
double largest_stretch(const dmat3& linear);

Geometry mesh_geometry(const importer::Mesh& mesh, const model::Model& model);
/// Cut at medians of the triangles' centres until every piece is within the limits; none where the whole is.
std::vector<Geometry> cut(const Geometry& whole, const CutLimits& limits);
/// One form, or several where the geometry is beyond the limits; pieces keep the borders that they share.
std::vector<MeshForm> make_forms(Geometry geometry, const CutLimits& limits, const ChainOptions& options);

}  // namespace surefoot::bake
