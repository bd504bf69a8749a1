// Objects with their geometry: converts each mesh once, cuts large meshes into pieces, makes a chain for each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/geometry.hpp"
#include "render/bake/sky_sides.hpp"
#include "render/bake/stand_ins.hpp"

namespace surefoot::bake {

/// The chain of one mesh, or of one piece of a mesh that is too large to draw whole.
struct MeshForm {
    LodChain chain;
    std::uint64_t triangles = 0;
    Box box;                        ///< in the mesh's frame
    bool closed = false;            ///< sees no sky in any place that it serves; set by share_places()
    std::vector<bool> closed_in{};  ///< by place of the mesh: whether it sees no sky there. Empty: it does in all
    /// By place of the mesh: whether this form stands there. Empty: in all. Where only some places are closed, two forms share
    /// them.
    std::vector<bool> serves;
};

/// One placement of a mesh, or of one piece of it.
struct PlacedObject {
    std::uint32_t mesh = 0;  ///< in the list of forms
    dmat4 world{1};
    std::string name;
    float importance = 1;
    Box box;                   ///< world
    std::uint32_t object = 0;  ///< number of the object; pieces of one object share it
    bool piece = false;
    model::Index motion = model::none;
};

/// Limits above which a mesh is cut into pieces.
struct CutLimits {
    std::uint32_t max_triangles = 8192;  ///< of a piece; keeps its cost below 1/16 of a frame
    double longest_m = 1e30;             ///< of a piece, mesh frame; limits what is drawn for one corner in view
    /// Geometry below twice this is not cut for length alone: a draw costs as much as 50 triangles.
    std::uint32_t min_triangles = 512;
    /// Replaces min_triangles for few triangles in several layers (the walls of a storey). Drawn whole, most of its pixels
    /// lie behind its own front, and an extra layer costs more than extra draws.
    std::uint32_t min_hidden = 32;
    std::uint32_t max_hidden = 4096;  ///< triangles that count as few
    double stretch = 1;               ///< largest_stretch of the mesh's placements
};

/// Largest factor by which `linear` stretches a length; errors grow by it. An upper bound, within 1e-8.
double largest_stretch(const dmat3& linear);

Geometry mesh_geometry(const importer::Mesh& mesh, const model::Model& model);
/// Whether any of its materials has a texture. options.pictures: one a material.
bool has_pictures(const Geometry& geometry, const ChainOptions& options);

/// A mesh in its scene.
struct MeshInScene {
    double scene_m = 0;                  ///< longest side of the scene
    double stretch = 1;                  ///< largest_stretch of its placements
    std::uint64_t placed_triangles = 0;  ///< of all placements
    bool textured = false;               ///< its pixels are dear, and its triangles are not
    std::uint32_t max_triangles = 8192;  ///< CutLimits::max_triangles
    bool has_stand_ins = false;          ///< they stand for the whole, so it is cut only if it has too many triangles
};
/// Cut finely, only what shows of a mesh has to be drawn. That is done for meshes with textures, unless the pieces of all
/// placements would be too many.
CutLimits cut_limits(const MeshInScene& mesh);
/// Pieces within the limits, cut at medians of the triangle centres. Empty if the whole is within the limits.
std::vector<Geometry> cut(const Geometry& whole, const CutLimits& limits);
/// One form, or one a piece if the geometry exceeds the limits. Pieces meet in full detail, and in
/// coarser levels as long as possible. `notes`: why stand-ins are left out, one line each. `sides`: what sees no sky anywhere is
/// in pieces apart from the rest, if it is walls of a room; closed_in is by these.
std::vector<MeshForm> make_forms(Geometry geometry, const CutLimits& limits, const ChainOptions& options,
                                 std::span<const ArtistStandIn> stand_ins = {}, std::vector<std::string>* notes = nullptr,
                                 const SkySides& sides = {});
/// Of each form that sees no sky in some of its places alone, two: one serves those places, and one the others.
std::vector<MeshForm> share_places(std::vector<MeshForm> forms);
/// Every object with the forms that serve its place; of several, each is a piece. world boxes included.
std::vector<PlacedObject> with_forms(const std::vector<PlacedObject>& objects, const std::vector<MeshForm>& forms,
                                     std::span<const std::uint32_t> first, std::span<const std::uint32_t> count);
/// A box round the placed corners of `box`.
Box placed_box(const Box& box, const dmat4& world);

}  // namespace surefoot::bake
