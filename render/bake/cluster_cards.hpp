// Cards in clusters: crowns of many trees, a meadow's grass. A grid would close them to dark solids; a few of them, larger, keep
// their look (cards.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Takes out of the geometry the parts of materials that are cut out (by material). Where these are too few to be thinned out, or
/// one of them is most of it or of more triangles than `largest_triangles`, they stay, in baked colours and the proxy's material.
std::vector<GeometryPart> take_cards(Geometry& g, const std::vector<bool>& cut_out, model::Index proxy_material,
                                     std::uint32_t largest_triangles);

struct CardLimits {
    std::uint32_t most = 1000;  ///< triangles of cards in the finest level
    std::uint32_t least = 16;   ///< and in the coarsest
    float slack = 0.25F;        ///< how far, relative, the bound may lie over what is proven
};

/// Levels of cards, each about half of the next finer one, with what is solid beside them as coarse as their error allows.
/// `chain`: of what is left of g, in its frame; it may be without levels. Errors are bounded against all of g and the cards.
LodChain with_cards(LodChain chain, const Geometry& g, const std::vector<GeometryPart>& cards, const CardLimits& limits);

}  // namespace surefoot::bake
