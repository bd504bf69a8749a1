// Levels of detail for alpha-tested cards (leaves, grass): fewer cards, drawn larger.
//
// Edge collapse and baked colours fill the holes of cards, so that a bush becomes a dark solid. Fewer, larger cards keep its
// look and its coverage. Source: Cook, Halstead, Planck & Ryu 2007, stochastic simplification of aggregate detail.
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Parts with fewer cards are not thinned out.
constexpr std::size_t fewest_cards = 8;
/// Nor are parts in which one card has a larger share of the triangles.
constexpr double largest_card_share = 0.25;

/// Each card's indices, three a triangle.
using Cards = std::vector<std::vector<std::uint32_t>>;

/// The triangles of the part by card. A card is a set of triangles connected by edges; an edge joins two positions. Twigs that
/// touch in one point are separate cards. The panels of a fence are one card, although each shows the whole texture.
Cards cards_of(const Geometry& g, const GeometryPart& part);

/// cards_of() if the part can be thinned out, else none.
Cards thinnable_cards(const Geometry& g, const GeometryPart& part);

/// Each triangle a card by itself. For materials that show nothing: any of them stand for all, and must not become solid.
Cards single_triangles(const GeometryPart& part);

/// Orders cards up to a sum of `max_triangles`: the middle card first, then always the farthest from all before it. Distances
/// are divided by the square root of a card's triangles, so that many small cards replace a large one. The first few then
/// represent all, out to the tips. Time: cards x ordered cards. Source: Gonzalez 1985, farthest-point clustering.
void spread(const Geometry& g, Cards& cards, std::size_t max_triangles);

/// The first cards that hold about `share` of the triangles; at least one. A smaller share is a subset of a larger one, so
/// that no card comes and goes between levels.
std::vector<std::uint32_t> some_cards(const Cards& cards, double share);

constexpr double largest_card = 1.6;  ///< factor on its size
/// Scales each card of the part about its own centre, so that the areas sum to `area_m2`; by at most `largest`.
/// `part`: the result of some_cards(cards); its indices may refer to other vertices.
void enlarge_cards(Geometry& g, GeometryPart& part, const Cards& cards, double area_m2, double largest = largest_card);

/// Sum of the triangles' areas, m2. indices: three a triangle.
double area_of(const Geometry& g, const std::vector<std::uint32_t>& indices);

}  // namespace surefoot::bake
