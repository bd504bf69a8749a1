// The shape of a stack of prisms: sections of an object at a few heights, each as wide as what shows there. Trees, posts and
// houses keep their outlines and the area that they cover, by a few dozen triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/bake/form_picture.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

constexpr std::size_t profile_views = 8;  ///< azimuths, evenly spread, at no elevation

/// One height of the object. Lengths in metres, in the geometry's frame.
struct ProfileRow {
    double height = 0;
    std::array<double, profile_views> width{};  ///< that is covered, by view
    double mean_width = 0;
    dvec2 centre{0.0};  ///< x and z, of what is covered
};

/// How an object looks from all round, row by row from below. The rows are equally high, and there are at least eight.
struct Profile {
    Box box;
    std::array<FormPicture, profile_views> plain;  ///< without light
    std::vector<ProfileRow> rows;
    bool square = false;  ///< its sections are rectangles along x and z, rather than round
};
/// `full`: the object's triangles, with `looks` for their materials and textures. No rows: nothing shows, or it is flat.
Profile profile_of(const Geometry& g, const std::vector<GeometryPart>& full, const model::Model& looks);

/// A horizontal section: a polygon inside a rectangle or ellipse.
struct PrismRing {
    double height = 0;
    dvec2 centre{0.0}, half{0.0};            ///< along x and z
    std::size_t first_row = 0, end_row = 0;  ///< whose colours it shows
};
/// Neighbours are joined by quadrangles. Wide ends are closed.
struct PrismStack {
    std::vector<PrismRing> rings;  ///< from below
    std::uint32_t sides = 4;
    bool square = false;
};
/// The heights at which the outline bends most: straight lines between them are off the profile by the smallest area.
PrismStack stack_of(const Profile& profile, std::size_t rings, std::uint32_t sides);

/// Appends the stack's vertices to the geometry, in the profile's colours times `brightness`, inside the object's box. The level
/// has no error yet.
Level emit_stack(Geometry& g, const PrismStack& stack, const Profile& profile, model::Index material, const dvec3& brightness);

}  // namespace surefoot::bake
