// Bars, and drawing in place: plain escape sequences, so that nothing but the cursor has to be put back.
#include "tools/cli/bars.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace surefoot::cli {

namespace {

constexpr std::array<const char*, 8> directions = {"north", "north-east", "east", "south-east",
                                                   "south", "south-west", "west", "north-west"};

winsize terminal_size() {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
        size.ws_col = 80;
        size.ws_row = 24;
    }
    return size;
}

}  // namespace

std::string bar(const input::ControlInfo& c, std::int32_t value, std::size_t width) {
    const double range = static_cast<double>(c.logical_max) - c.logical_min;
    const double at = range > 0 ? std::clamp((static_cast<double>(value) - c.logical_min) / range, 0.0, 1.0) : 0.0;
    std::string text(width, '-');
    const std::size_t middle = width / 2;
    const auto cell = std::min(width - 1, static_cast<std::size_t>(at * static_cast<double>(width)));
    for (std::size_t i = std::min(middle, cell); i <= std::max(middle, cell); ++i) text[i] = '#';
    text[middle] = '|';
    if (cell != middle) text[cell] = '#';
    return text;
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
    for (std::string& line : lines)
        if (line.size() > width) line.resize(width);
    return lines;
}

Redraw::Redraw() {
    (void)std::fputs("\033[?25l", stdout);
    std::fflush(stdout);
}

Redraw::~Redraw() {
    (void)std::fputs("\033[?25h", stdout);
    std::fflush(stdout);
}

std::size_t Redraw::width() { return terminal_size().ws_col; }

void Redraw::draw(std::span<const std::string> lines) {
    const winsize size = terminal_size();
    const std::size_t room = size.ws_row - 1U;
    std::string out;
    if (drawn_ > 0) out += fmt::format("\033[{}F", drawn_);
    std::size_t n = 0;
    for (const std::string& line : lines) {
        if (n + 1 == room && lines.size() > room) {
            out += fmt::format("\033[K... and {} more lines: make the window higher\n", lines.size() - n);
            ++n;
            break;
        }
        out += "\033[K" + line.substr(0, size.ws_col) + "\n";
        ++n;
    }
    out += "\033[J";
    drawn_ = n;
    (void)std::fputs(out.c_str(), stdout);
    std::fflush(stdout);
}

}  // namespace surefoot::cli
