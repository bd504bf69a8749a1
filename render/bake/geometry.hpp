// Geometry on its way through the bake: vertices and material parts, and the chain of levels made from them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::bake {

struct GeometryPart {
    model::Index material = 0;
    std::vector<std::uint32_t> indices;
};

/// Triangles by material (a part each) over one vertex array; positions relative to `centre`, which is in the mesh's frame.
struct Geometry {
    dvec3 centre{0};
    std::vector<model::Vertex> vertices;
    std::vector<std::array<std::uint8_t, 4>> baked;  ///< a vertex: its colour with material and texture in it, for coarse forms
    std::vector<GeometryPart> parts;
    [[nodiscard]] std::size_t triangles() const;
    [[nodiscard]] Box box() const;  ///< relative to centre
};

inline vec3 position_of(const model::Vertex& v) { return {v.position[0], v.position[1], v.position[2]}; }

/// One level of detail: parts over the chain's vertices; error against the full detail, in the mesh's frame.
struct Level {
    std::vector<GeometryPart> parts;
    std::uint32_t triangles = 0;
    float error_m = 0;
};

/// Levels coarse to fine; the last is the full detail with error 0. Errors fall strictly, triangles rise strictly.
struct LodChain {
    Geometry full;
    std::vector<Level> levels;
};

/// What replaces pictures and materials by baked colours may stand for them only where it is small: its error counts as at
/// least this share of its size, so that an error of an eighth of a pixel is a thing of 8 pixels.
constexpr double least_proxy_error = 1.0 / 64;

/// What a material shows beside its colour.
enum class Picture : std::uint8_t { none, repeats, clamped };

struct ChainOptions {
    bool lock_border = false;         ///< pieces of one object: their common borders stay equal
    std::uint32_t smallest = 16;      ///< triangles at which the chain ends
    float slack = 0.25F;              ///< how far, relative, the bound may lie over what is proven
    model::Index proxy_material = 0;  ///< vertex colours only: for the coarsest levels; none: they keep their materials
    std::uint32_t proxy_below = 40;   ///< triangles; coarser levels carry baked colours in one part
    std::vector<Picture> pictures;    ///< by material: what baked colours at a few vertices lose
    std::vector<bool> cut_out;        ///< by material: its picture's alpha cuts the shape out of its triangles
    double ratio = 0.45;  ///< of triangles from one level to the next coarser; its root for what is solid beside many cards
};

/// meshoptimizer proposes, mesh_distance bounds. A chain of one level where nothing coarser is worth keeping.
LodChain make_chain(Geometry full, const ChainOptions& options);

/// Drops vertices that no part uses, and orders triangles and vertices for the caches.
void optimise(Geometry& geometry);

}  // namespace surefoot::bake
