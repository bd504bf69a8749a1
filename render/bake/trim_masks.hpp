// Cuts triangles of masked materials down to where the mask shows something.
//
// Most of a leaf's card is hole, and each of its pixels takes time: the mask is read before it is known that nothing shows.
// Source of the idea: Persson 2009, "Particle trimming": the convex hull of what shows. Here it is divided where that pays.
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/bake/mask_shapes.hpp"

namespace surefoot::bake {

/// What more triangles are worth: one costs as much as this share of a card's pixels.
struct TrimPrice {
    double of_card = 0.02;
};

/// The same parts, with masked triangles cut down. Appends vertices to `g`. Empty if that would save less than a tenth of the
/// masked area: then `g` is as it was. Pieces of one card overlap by half a texel, so that no gap opens between them.
std::vector<GeometryPart> trimmed(Geometry& g, const std::vector<GeometryPart>& parts, const MaskShapes& shapes,
                                  const TrimPrice& price);

/// Cuts the levels of a chain but for the coarsest. Full detail stays: a new level before it shows the same for less, where it
/// fills many pixels. Triangles still rise from level to level, up to the new one. What is cut away counts in a level's error,
/// and errors still fall: coarser ones rise where need be. The new level before full detail has model::trimmed_error_m.
void trim_levels(LodChain& chain, const MaskShapes& shapes);

}  // namespace surefoot::bake
