// The forest: trees on rolling ground, a footpath among them, a hill to look back from.
#pragma once

#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {

/// 1050 triangles a tree in all: 960 of the tree itself, the rest ground and undergrowth; 100 * scale trees.
GeneratedScene make_forest(double scale, std::uint64_t seed);

}  // namespace surefoot::scenes
