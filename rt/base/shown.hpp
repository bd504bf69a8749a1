// What a display tells of itself and of the pictures that it shows. Plain data that the rooms exchange.
#pragma once

#include <cstdint>

#include "rt/base/modes.hpp"

namespace surefoot::rt {

/// A display's refreshes: their period by its mode, and one of them by its clock.
struct Refreshes {
    std::int64_t period_ns = 16'666'667;  ///< > 0
    std::int64_t one_ns = 0;              ///< when one was; CLOCK_MONOTONIC
};

/// What became of a picture that was presented.
struct Shown {
    ShownBy by = ShownBy::nothing;
    std::int64_t time_ns = 0;    ///< when the display showed it, where it tells (`display`)
    std::int64_t queued_ns = 0;  ///< when the display had it, and only waited for its refresh; 0: not known
};

}  // namespace surefoot::rt
