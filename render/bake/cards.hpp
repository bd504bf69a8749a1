// Levels of what many cards make up whose shape is cut out by their picture's alpha (leaves, grass): some of the cards, larger.
//
// Collapsing edges of cards, or colouring them, fills what is cut out: a bush becomes a dark solid. Fewer and larger ones keep
// its look and its coverage. Source: Cook, Halstead, Planck & Ryu 2007, stochastic simplification of aggregate detail.
#pragma once

#include <cstdint>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Fewer are not thinned out.
constexpr std::size_t fewest_cards = 8;
/// Nor what is one large thing and crumbs: none may be more of the whole.
constexpr double largest_card_share = 0.25;

/// Each card's indices, three a triangle.
using Cards = std::vector<std::vector<std::uint32_t>>;

/// The part's triangles by card: what hangs together by edges, each from place to place. Bunches of twigs that touch in a point
/// come apart; the panels of a fence, each with the whole picture, do not.
Cards cards_of(const Geometry& g, const GeometryPart& part);

/// The same if the part is one to be thinned out, else none.
Cards thinnable_cards(const Geometry& g, const GeometryPart& part);

/// Orders cards, as far as `most_triangles` reach: the middle one, then always the one that is farthest from those before it, by
/// the square root of its triangles (many small ones for one large one). A few then stand for all, out to the tips. Time: cards
/// times those that are ordered. Source: Gonzalez 1985, farthest-point clustering.
void spread(const Geometry& g, Cards& cards, std::size_t most_triangles);

/// The first cards, with about `share` of the triangles, at least one: those of a small share are among those of every larger
/// one, so that none comes and goes.
std::vector<std::uint32_t> some_cards(const Cards& cards, double share);

constexpr double largest_card = 1.6;  ///< times its size
/// Draws each card of the part out about its own middle, so that their areas sum to `area_m2`; at most to `largest` times its
/// size. `part`: as some_cards() gave it of `cards`; its indices may be into other vertices.
void enlarge_cards(Geometry& g, GeometryPart& part, const Cards& cards, double area_m2, double largest = largest_card);

/// Of the triangles of indices.
double area_of(const Geometry& g, const std::vector<std::uint32_t>& indices);

}  // namespace surefoot::bake
