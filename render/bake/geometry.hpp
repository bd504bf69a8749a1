// Geometry inside the bake: vertices, parts by material, and the chain of levels made from them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::bake {

/// The triangles of one material; three indices a triangle.
struct GeometryPart {
    model::Index material = 0;
    std::vector<std::uint32_t> indices;
};

/// One vertex array and one part of triangles a material. Positions are relative to `centre`, which is in the mesh's frame.
struct Geometry {
    dvec3 centre{0};
    std::vector<model::Vertex> vertices;
    std::vector<std::array<std::uint8_t, 4>> baked;  ///< by vertex: its colour with material and texture, for coarse levels
    std::vector<GeometryPart> parts;
    [[nodiscard]] std::size_t triangles() const;
    [[nodiscard]] Box box() const;  ///< relative to centre
};

inline vec3 position_of(const model::Vertex& v) { return {v.position[0], v.position[1], v.position[2]}; }

/// One level of detail: parts over the chain's vertices. The error is against the full detail, in the mesh's frame.
struct Level {
    std::vector<GeometryPart> parts;
    std::uint32_t triangles = 0;
    float error_m = 0;
};

/// Levels from coarse to fine; the last is the full detail with error 0. Errors fall and triangles rise, both strictly. Only the
/// full detail may have fewer triangles than the level before it, which is cut to what its masks show.
struct LodChain {
    Geometry full;
    std::vector<Level> levels;
};

/// Errors that do not fall from coarse to fine are raised by a thousandth above the next finer one: they stay apart in any
/// placement.
void raise_errors(std::vector<Level>& levels);

/// Minimum error of levels with baked colours, as a share of their size. Such a level has lost its texture, so it may only be
/// shown small. At an accepted error of 1/8 pixel, the object is 8 pixels large.
constexpr double min_proxy_error = 1.0 / 64;

/// The texture of a material, and how it wraps.
enum class Picture : std::uint8_t { none, repeats, clamped };

/// Settings of a chain.
struct ChainOptions {
    bool is_piece = false;        ///< of a cut object: its borders stay as long as that gives levels, and no box ends the chain
    std::uint32_t smallest = 16;  ///< triangles at which the chain ends
    float slack = 0.25F;          ///< relative gap allowed between upper and lower bound
    model::Index proxy_material = 0;  ///< material of the coarsest levels (vertex colours only); none: they keep their materials
    std::uint32_t proxy_below = 40;   ///< triangles; coarser levels have baked colours in one part
    std::vector<Picture> pictures;    ///< by material: the texture that baked colours lose
    std::vector<bool> cut_out;        ///< by material: its alpha test cuts shapes out of triangles
    std::vector<bool> hidden;         ///< by material: its alpha test hides all of it, so no coarse form may show it
    const model::Model* looks = nullptr;  ///< with complete materials and textures; none: no stacks of prisms
    double ratio = 0.45;  ///< of triangles, from a level to the next coarser; solids beside cards use its square root
};

/// Edge collapses propose levels, mesh_distance bounds their errors. One level if no coarser one is worth keeping.
LodChain make_chain(Geometry full, const ChainOptions& options);

/// Drops vertices that no part uses, and orders triangles and vertices for the caches.
void optimise(Geometry& geometry);

}  // namespace surefoot::bake
