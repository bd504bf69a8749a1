// Merges the requests of several devices into one, at most one full deflection.
#pragma once

#include <span>

#include "input/controls.hpp"

namespace surefoot::input {

/// Shortens the walk (forward, side, up) and the turning (turn, look) to length 1 each, clamps speed and zoom, sets non-finite
/// values to 0. True: all were finite.
bool bound(MotionRequest& request);

/// The bounded sum, with the edges of both. Opposite requests cancel out; with "strongest wins" they would not.
MotionRequest merge(std::span<const MotionRequest> requests);

}  // namespace surefoot::input
