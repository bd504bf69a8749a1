// A display's clock, followed by its stamps (display_clock.hpp).
#include "rt/clock/display_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace surefoot::rt {

namespace {

constexpr double phase_share = 0.25;     // of an error, that the next point is moved by
constexpr double period_share = 0.03;    // of an error a refresh, that the period changes by
constexpr double max_difference = 2e-3;  // of the period by the mode: more is another mode
constexpr double rate_tolerance = 5e-3;  // 59.94 is 60

}  // namespace

Result<std::uint32_t> refreshes_per_slot(const Refreshes& display, double rate_hz) {
    const double refresh_hz = 1e9 / static_cast<double>(display.period_ns);
    const double wanted = refresh_hz / rate_hz, whole = std::max(1.0, std::round(wanted));
    if (std::isfinite(wanted) && std::abs(wanted / whole - 1) <= rate_tolerance) return static_cast<std::uint32_t>(whole);
    std::string rates;
    for (const int n : {1, 2, 3, 4}) rates += fmt::format("{}{:.4g}", n == 1 ? "" : n == 4 ? " or " : ", ", refresh_hz / n);
    return Error{"frame rate", fmt::format("The rate of {:.4g} Hz does not divide the display's {:.4g} Hz", rate_hz, refresh_hz),
                 fmt::format("Choose {} Hz, or another mode of the display", rates), ErrorKind::misuse};
}

DisplayClock::DisplayClock(const Refreshes& display, std::uint32_t refreshes_per_slot)
    : display_(display),
      per_slot_(std::max(1U, refreshes_per_slot)),
      refresh_ns_(static_cast<double>(std::max<std::int64_t>(1, display.period_ns))) {}

Grid DisplayClock::grid_from(std::int64_t earliest_ns) const {
    const auto ahead = static_cast<double>(earliest_ns - display_.one_ns);
    const double refreshes = std::ceil(ahead / refresh_ns_);
    Grid grid;
    grid.t0_ns = display_.one_ns + std::llround(refreshes * refresh_ns_);
    grid.period_ns = std::llround(refresh_ns_ * per_slot_);
    return grid;
}

Grid DisplayClock::follow(const Grid& grid, std::int64_t shown_ns, std::uint64_t next_slot) {
    const std::int64_t due_ns = grid.due_ns(next_slot);
    const auto distance = static_cast<double>(shown_ns - due_ns);
    const double refreshes = std::round(distance / refresh_ns_), error_ns = distance - refreshes * refresh_ns_;
    const auto by_mode = static_cast<double>(display_.period_ns);
    refresh_ns_ = std::clamp(refresh_ns_ + period_share * error_ns / per_slot_, by_mode * (1 - max_difference),
                             by_mode * (1 + max_difference));
    Grid moved;
    moved.slot0 = next_slot;
    moved.t0_ns = due_ns + std::llround(phase_share * error_ns);
    moved.period_ns = std::llround(refresh_ns_ * per_slot_);
    return moved;
}

}  // namespace surefoot::rt
