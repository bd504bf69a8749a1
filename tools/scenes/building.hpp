// Walls with openings, windows, doors, stairs, railings: the parts of rooms and houses.
#pragma once

#include <span>

#include "tools/scenes/furniture.hpp"

namespace surefoot::scenes {

/// A hole in a wall: metres along it from its first end, and above its base.
struct Opening {
    double from = 0, to = 1, low = 0, high = 2.1;
};

/// What the two sides of a wall and the edges of its openings are made of, and how often their textures repeat a metre.
struct WallStyle {
    Index outer = 0, inner = 0, reveal = 0;
    double outer_uv = 1.0, inner_uv = 0.5;
    Colour outer_colour{255, 255, 255, 255}, inner_colour{255, 255, 255, 255}, reveal_colour{255, 255, 255, 255};
};

/// A straight wall.
struct WallRun {
    dvec2 from{0}, to{1, 0};  ///< centre line in x, z; its outside lies to the right (from +x looking: +z)
    double base = 0, height = 2.6, thickness = 0.2;
};

/// Openings must lie apart, in order, inside the wall.
void wall(MeshMaker& maker, const WallRun& run, std::span<const Opening> openings, const WallStyle& style);

/// In the brush's frame: 0..width by 0..height in the plane z = 0, frame 0.1 deep; sill towards +z.
void window(MeshMaker& maker, const Stuff& stuff, double width, double height, int panes_across, int panes_up,
            const Colour& frame);
/// Lining of a doorway, and a leaf hinged at x = 0 that extends to x = width (give the brush's frame the swing).
void door_lining(MeshMaker& maker, const Stuff& stuff, double width, double height, double depth, const Colour& colour);
importer::Mesh door_leaf(const Stuff& stuff, double width, double height, const Colour& colour, const Detail& detail);
/// Steps along +z from (0, 0, 0), `width` across x.
void stairs(MeshMaker& maker, double width, double rise, double run, int steps);
/// Turned balusters and a handrail from a to b (base of the railing).
void balustrade(MeshMaker& maker, const dvec3& from, const dvec3& to, double height, double spacing, const Detail& detail);

}  // namespace surefoot::scenes
