// Bars by kind of control.
#include "tools/cli/bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

constexpr std::array<const char*, 8> directions = {"north", "north-east", "east", "south-east",
                                                   "south", "south-west", "west", "north-west"};

}  // namespace

std::string bar(const input::ControlInfo& c, std::int32_t value, std::size_t width) {
    const double range = static_cast<double>(c.logical_max) - c.logical_min;
    const double at = range > 0 ? std::clamp((static_cast<double>(value) - c.logical_min) / range, 0.0, 1.0) : 0.0;
    return report::deflection_bar(at, width);
}

std::vector<std::string> control_lines(std::span<const input::ControlInfo> controls, const input::DeviceState& state,
                                       std::size_t width) {
    std::vector<std::string> lines;
    std::string pressed;
    bool buttons = false;
    for (std::size_t i = 0; i < controls.size() && i < input::max_controls; ++i) {
        const input::ControlInfo& c = controls[i];
        const bool has = state.has_value.test(i);
        if (c.kind == input::ControlKind::button) {
            buttons = true;
            if (has && state.value[i] != 0) pressed += " " + c.name;
        } else if (c.kind == input::ControlKind::hat) {
            const auto at = static_cast<std::size_t>(state.value[i]);
            lines.push_back(fmt::format("{:<16} {}", c.name, has && at < directions.size() ? directions[at] : "centre"));
        } else {
            const std::size_t cells = std::clamp<std::size_t>(width > 60 ? width - 40 : 20, 20, 61) | 1U;
            lines.push_back(has ? fmt::format("{:<16} [{}] {:>7}", c.name, bar(c, state.value[i], cells), state.value[i])
                                : fmt::format("{:<16} [{}] {:>7}", c.name, std::string(cells, ' '), "-"));
        }
    }
    if (buttons) lines.push_back(fmt::format("{:<16}{}", "pressed", pressed.empty() ? " none" : pressed));
    for (std::string& line : lines) line = report::cut_to(line, width);
    return lines;
}

}  // namespace surefoot::cli
