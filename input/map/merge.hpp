// Several wishes made one, never asking for more than one full deflection.
#pragma once

#include <span>

#include "input/controls.hpp"

namespace surefoot::input {

/// The walk (forward, side, up) and the turning (turn, look) each shortened to length 1, speed clamped, what is not finite
/// made 0. True: it was finite.
bool bound(Wish& wish);

/// The sum, bounded; edges of any. Sums cancel: two hands that pull apart stand still, which a "strongest wins" would not do.
Wish merge(std::span<const Wish> wishes);

}  // namespace surefoot::input
