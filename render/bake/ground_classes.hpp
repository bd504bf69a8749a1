// Which triangles of a scene block a walker.
//
//   * A node's `walk` rules: all of it blocks, or none.
//   * A triangle is solid if its material is opaque, or if its picture hides nothing of it. Any other is sheer.
//   * A solid triangle blocks, unless its part is smaller than a foot. A part: triangles joined by corners, or with corners that
//     are at most 2 mm apart. Its size: the longest side of its box along the node's axes.
//   * A sheer triangle blocks if its sheet is upright, at least 1 m wide, and spans 0.3 to 0.8 m above a floor beside it.
//     Such are fences and panes. A sheet: upright triangles joined by corners whose planes differ by up to 10 degrees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/import/scene.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::bake {

constexpr double foot_m = 0.3, join_m = 0.002;
constexpr double sheet_width_m = 1.0, sheet_low_m = 0.3, sheet_high_m = 0.8;
constexpr double upright_max_y = 0.5;            // |y| of an upright triangle's normal: within 30 degrees of vertical
constexpr double sheet_min_cos = 0.98480775301;  // of 10 degrees
constexpr double floor_min_y = 0.70710678118;    // of a floor's normal: up to 45 degrees

/// What the classes of a mesh's triangles follow from, whatever its placement. Triangles count through the mesh's primitives.
struct GroundFacts {
    std::vector<dvec3> points;                          ///< distinct corners, mesh frame
    std::vector<std::array<std::uint32_t, 3>> corners;  ///< by triangle
    std::vector<bool> solid;                            ///< by triangle
    std::vector<std::uint32_t> part;                    ///< by triangle: of the solid, its part by shared corners
    std::vector<Box> part_boxes;                        ///< mesh frame
    [[nodiscard]] bool all_solid() const;
};
GroundFacts ground_facts(const importer::Scene& scene, const importer::Mesh& mesh);

/// By triangle: whether it blocks in a node with this matrix, sheer triangles left out.
std::vector<bool> blocking_solids(const GroundFacts& facts, const dmat4& world);

/// Sheer triangles that make an upright sheet, with its outline in the world.
struct Sheet {
    std::vector<std::uint32_t> triangles;
    dvec3 centre{0.0};     ///< mean of its triangles by area
    dvec3 along{1, 0, 0};  ///< level, in which it is widest, of eight directions
    double width_m = 0, low_m = 0, high_m = 0;
};
/// Those at least 1 m wide and 0.5 m high.
std::vector<Sheet> upright_sheets(const GroundFacts& facts, const dmat4& world);

/// Where to look for floors beside a sheet: three places along it, each at its plane and 0.3 m to both sides.
std::vector<dvec3> places_beside(const Sheet& sheet);
/// Whether it spans 0.3 to 0.8 m above a floor of that height.
bool stands_on(const Sheet& sheet, double floor_m);

}  // namespace surefoot::bake
