// The garden: masked plants of five kinds on a lawn, picket and wire-mesh fences, wires on poles, a shed. What is thin or full of
// holes is here without any data.
#pragma once

#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {

/// Four fifths of it are leaf cards; 40 m a side at scale 1.
GeneratedScene make_garden(double scale, std::uint64_t seed);

}  // namespace surefoot::scenes
