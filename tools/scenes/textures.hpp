// Procedural pictures for generated scenes: all tile (but paintings), all are small, all come from a seed.
#pragma once

#include "tools/scenes/mesh_maker.hpp"

namespace surefoot::scenes {

importer::Image brick(std::uint64_t seed, const Colour& colour);       ///< 1 m of wall
importer::Image plaster(std::uint64_t seed, const Colour& colour);     ///< 2 m
importer::Image roof_tiles(std::uint64_t seed, const Colour& colour);  ///< 2 m
importer::Image planks(std::uint64_t seed, const Colour& colour);      ///< 1 m, grain along u
importer::Image wood_grain(std::uint64_t seed, const Colour& colour);  ///< 1 m of one board, grain along u
importer::Image paving(std::uint64_t seed, const Colour& colour);      ///< 2 m of slabs
importer::Image cobbles(std::uint64_t seed, const Colour& colour);     ///< 2 m
importer::Image speckle(std::uint64_t seed, const Colour& a, const Colour& b, const char* name);  ///< asphalt, grass, cloth
importer::Image rug(std::uint64_t seed, const Colour& a, const Colour& b);                        ///< one rug
importer::Image wallpaper(std::uint64_t seed, const Colour& a, const Colour& b);                  ///< 1 m
importer::Image painting(std::uint64_t seed, int kind);  ///< landscape, abstract, still life, portrait of a house
importer::Image glass();                                 ///< mostly clear
importer::Image leaves(std::uint64_t seed, const Colour& dark, const Colour& light);  ///< a spray of leaves; clear between
importer::Image book_spines(std::uint64_t seed);                                      ///< bands and lettering, to be tinted

}  // namespace surefoot::scenes
