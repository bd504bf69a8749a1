// The seat: how wide the screen is and how far away the eye. Both give the field of view, and what the eye can tell apart.
#pragma once

#include <optional>
#include <string>

#include "config/settings.hpp"

namespace surefoot::config {

/// The field of view of one screen, as seen from the seat straight before it. Pixels are square.
/// A screen of a row has the same, and is moved aside by Settings::shift_x.
struct Seat {
    double fov_x_rad = 0;  ///< 2 atan(width / 2 / distance)
    double fov_y_rad = 0;  ///< by the shape of the picture
};

/// Nothing where a length is not given: then poses bring their own field of view.
std::optional<Seat> seat_of(const Settings& settings);

/// The angle that the eye can tell apart, rad; 0: unknown, so pixels decide. With a seat it is one arcminute if not given. A
/// guaranteed accuracy may ask for less.
/// Source of that: Selcuk 1997, section 2.1.
double acuity_rad(const Settings& settings);

/// "46.4 x 27.1 degrees".
std::string seat_text(const Seat& seat);

/// What is wrong with the seat, by key and without origin: one length alone, or a picture that cannot be drawn.
struct SeatProblem {
    std::string_view key;
    std::string what, remedy;
};
/// Nothing if all is well.
std::optional<SeatProblem> seat_problem(const Settings& settings);

}  // namespace surefoot::config
