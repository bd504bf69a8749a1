// The two choices of a walk that the core itself knows: what happens to a late frame, and which clock is kept. Enums, and the
// names by which settings and figures call them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "rt/base/named.hpp"

namespace surefoot::rt {

/// What happens to a frame that is late, named as in OpenGL Performer (research/realtime.md 2).
/// lock:     a picture is shown on grid points only. A late frame is shown on the first grid point after it is done, and the
///           next frame starts there; the slots that it ran over are skipped whole. Latency is a whole number of periods.
/// floating: (`float`) a late frame is shown when it is done, and the next frame starts at once, in the slot that has begun.
///           Only slots that have passed entirely are skipped.
/// A frame that is in time is shown at its deadline (lock) or when done (floating); the next starts on the next grid point.
enum class LatePolicy : std::uint8_t { lock, floating };

/// Whose time frames are counted in: the machine's, or one that only predicted costs advance.
enum class ClockKind : std::uint8_t { real, virtual_time };

/// In the enums' order.
inline constexpr std::array late_policies = {
    Named{"lock", "whole slots are skipped: pictures appear on the grid alone"},
    Named{"float", "it is shown when it is done"},
};
inline constexpr std::array clock_kinds = {
    Named{"real", "the machine's"},
    Named{"virtual", "predicted costs are charged instead of waiting: the same frames wherever the cost table is the same"},
};

constexpr std::string_view name_of(LatePolicy late) { return late_policies[static_cast<std::size_t>(late)].name; }
constexpr std::string_view name_of(ClockKind clock) { return clock_kinds[static_cast<std::size_t>(clock)].name; }

}  // namespace surefoot::rt
