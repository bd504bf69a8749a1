// Live values as lines of text: a bar an axis, the pressed buttons by name. Pure functions; and the terminal they are drawn on.
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

/// Redraws some lines in place on stdout; the cursor is hidden as long as it lives.
class Redraw {
public:
    Redraw();
    ~Redraw();
    Redraw(const Redraw&) = delete;
    Redraw& operator=(const Redraw&) = delete;
    /// Cut to the terminal's size; the last line counts what does not fit.
    void draw(std::span<const std::string> lines);
    [[nodiscard]] static std::size_t width();

private:
    std::size_t drawn_ = 0;
};

}  // namespace surefoot::cli
