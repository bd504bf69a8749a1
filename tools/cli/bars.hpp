// Live values as lines of text: a bar an axis, the pressed buttons by name. Pure functions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "input/controls.hpp"

namespace surefoot::cli {

/// From the bar's rest (its middle, where logical minimum is below zero or `centred`; else its left end) to `value`.
/// `width` cells of '#', '-' and one '|' at the middle.
std::string bar(const input::ControlInfo& control, std::int32_t value, std::size_t width);
/// Axes one a line, hats by direction, all pressed buttons in one line; each at most `width` characters.
std::vector<std::string> control_lines(std::span<const input::ControlInfo> controls, const input::DeviceState& state,
                                       std::size_t width);

}  // namespace surefoot::cli
