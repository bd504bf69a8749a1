// The geometry of the seat.
#include "config/seat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::config {

namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double usual_acuity_arcmin = 1;
constexpr double widest_side_deg = 89, min_fov_deg = 0.1;  // what projections hold

}  // namespace

std::optional<Seat> seat_of(const Settings& s) {
    if (!(s.screen_width_cm > 0) || !(s.eye_distance_cm > 0)) return std::nullopt;
    const double half_x = 0.5 * s.screen_width_cm / s.eye_distance_cm;
    const double half_y = half_x * static_cast<double>(s.height) / static_cast<double>(s.width);
    return Seat{2 * std::atan(half_x), 2 * std::atan(half_y)};
}

double acuity_rad(const Settings& s) {
    constexpr double arcmin_per_rad = 60 * degrees;
    const double arcmin = s.acuity_arcmin > 0 ? s.acuity_arcmin : seat_of(s) ? usual_acuity_arcmin : 0;
    const double acuity = arcmin / arcmin_per_rad;
    return s.min_accuracy > 0 ? std::min(acuity, 1 / s.min_accuracy) : acuity;
}

std::string seat_text(const Seat& seat) {
    return fmt::format("{:.1f} x {:.1f} degrees", seat.fov_x_rad * degrees, seat.fov_y_rad * degrees);
}

std::optional<SeatProblem> seat_problem(const Settings& s) {
    const bool width = s.screen_width_cm > 0, distance = s.eye_distance_cm > 0;
    if (width != distance) {
        const std::string_view given = width ? "screen_width_cm" : "eye_distance_cm",
                               other = width ? "eye_distance_cm" : "screen_width_cm";
        return SeatProblem{given, fmt::format("The field of view needs {} too", other),
                           fmt::format("Set {} as well, or remove {}", other, given)};
    }
    const auto seat = seat_of(s);
    if (!seat) return std::nullopt;
    const double side = std::max((1 + std::abs(s.shift_x)) * std::tan(0.5 * seat->fov_x_rad),
                                 (1 + std::abs(s.shift_y)) * std::tan(0.5 * seat->fov_y_rad));
    if (side > std::tan(widest_side_deg / degrees))
        return SeatProblem{"eye_distance_cm",
                           fmt::format("The picture reaches {:.2f} degrees to one side, and at most {:g} can be drawn",
                                       std::atan(side) * degrees, widest_side_deg),
                           "Raise the distance, or lower screen_width_cm or the shift"};
    if (std::min(seat->fov_x_rad, seat->fov_y_rad) < min_fov_deg / degrees)
        return SeatProblem{"eye_distance_cm",
                           fmt::format("The field of view is {}, and at least {:g} can be drawn", seat_text(*seat), min_fov_deg),
                           "Lower the distance, or raise screen_width_cm"};
    return std::nullopt;
}

}  // namespace surefoot::config
