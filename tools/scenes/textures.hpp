// Procedural pictures for generated scenes: all tile (but paintings), all are small, all come from a seed.
#pragma once

#include "tools/scenes/mesh_maker.hpp"

namespace surefoot::scenes {

image::Image brick(std::uint64_t seed, const Colour& colour);       ///< 1 m of wall
image::Image plaster(std::uint64_t seed, const Colour& colour);     ///< 2 m
image::Image roof_tiles(std::uint64_t seed, const Colour& colour);  ///< 2 m
image::Image planks(std::uint64_t seed, const Colour& colour);      ///< 1 m, grain along u
image::Image wood_grain(std::uint64_t seed, const Colour& colour);  ///< 1 m of one board, grain along u
image::Image paving(std::uint64_t seed, const Colour& colour);      ///< 2 m of slabs
image::Image cobbles(std::uint64_t seed, const Colour& colour);     ///< 2 m
image::Image speckle(std::uint64_t seed, const Colour& a, const Colour& b, const char* name);  ///< asphalt, grass, cloth
image::Image rug(std::uint64_t seed, const Colour& a, const Colour& b);                        ///< one rug
image::Image wallpaper(std::uint64_t seed, const Colour& a, const Colour& b);                  ///< 1 m
image::Image painting(std::uint64_t seed, int kind);  ///< landscape, abstract, still life, portrait of a house
image::Image glass();                                 ///< mostly clear
image::Image leaves(std::uint64_t seed, const Colour& dark, const Colour& light);  ///< a spray of leaves; clear between
image::Image frond(std::uint64_t seed, const Colour& dark, const Colour& light);   ///< of a fern, its root below; clear between
image::Image blades(std::uint64_t seed, const Colour& dark, const Colour& light);  ///< of grass, from below; clear between
image::Image petals(std::uint64_t seed, const Colour& dark, const Colour& light);  ///< one flower from the front; clear around
image::Image wire_mesh(const Colour& wire);                                        ///< four by four square meshes; clear between
image::Image book_spines(std::uint64_t seed);                                      ///< bands and lettering, to be tinted

}  // namespace surefoot::scenes
