// Alpha-tested cards in clusters: crowns of many trees, the grass of a meadow. Vertex clustering would close them to dark
// solids; fewer, larger cards keep their look (cards.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Moves the parts of alpha-tested materials out of the geometry. `cut_out`: by material. They stay, with
/// baked colours and the proxy's material, if the cards cannot be thinned out. That is so with too few cards, with one card that
/// holds most triangles, or with a card of more than `largest_triangles`. Those of `hidden` materials never stay: nothing of them
/// may show.
std::vector<GeometryPart> take_cards(Geometry& g, const std::vector<bool>& cut_out, model::Index proxy_material,
                                     std::uint32_t largest_triangles, const std::vector<bool>& hidden = {});

/// Limits of the card levels of a cluster.
struct CardLimits {
    std::uint32_t max_triangles = 1000;  ///< triangles of cards in the finest level
    std::uint32_t min_triangles = 16;    ///< and in the coarsest
    float slack = 0.25F;                 ///< relative gap allowed between upper and lower bound
    std::vector<bool> hidden = {};       ///< by material: each triangle is a card, as nothing of it shows
};

/// Levels of cards, each with about half the triangles of the next finer one. The solid rest of a level is as coarse as the
/// cards' error allows. `chain`: levels of g without the cards, in g's frame; may be empty. Errors are bounded against g and
/// cards.
LodChain with_cards(LodChain chain, const Geometry& g, const std::vector<GeometryPart>& cards, const CardLimits& limits);

}  // namespace surefoot::bake
