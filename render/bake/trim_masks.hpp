// Cuts triangles of masked materials down to where the mask shows something.
//
// Most of a leaf's card is hole, and each of its pixels takes time: the mask is read before it is known that nothing shows.
// Source of the idea: Persson 2009, "Particle trimming": the convex hull of what shows. Here it is divided where that pays.
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Where the picture of a masked material shows something: at full size, or in one of the next three mip levels.
struct MaskShape {
    std::uint32_t width = 0, height = 0;  ///< texels; 0: nothing is cut with this material
    std::vector<bool> shows;              ///< by texel, row by row
};
/// Empty: it has no mask, or one that does not repeat.
MaskShape mask_shape(const model::Model& model, const model::Material& material);

/// What more triangles are worth: one costs as much as this share of a card's pixels.
struct TrimPrice {
    double of_card = 0.02;
};

/// The same parts, with masked triangles cut down. Appends vertices to `g`. Empty if that would save less than a tenth of the
/// masked area: then `g` is as it was. Pieces of one card overlap by a quarter of a texel, so that no gap opens between them.
std::vector<GeometryPart> trimmed(Geometry& g, const std::vector<GeometryPart>& parts, const std::vector<MaskShape>& shapes,
                                  const TrimPrice& price);

/// Cuts the levels of a chain. Full detail stays, and a level before it shows the same for less, where it fills many pixels.
void trim_levels(LodChain& chain, const std::vector<MaskShape>& shapes);

}  // namespace surefoot::bake
