// The room: chairs pushed under a laid table, books pressed into shelves, cushions into each other. At larger scales a row
// of such rooms, door after door.
#pragma once

#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {

GeneratedScene make_room(double scale, std::uint64_t seed);

}  // namespace surefoot::scenes
