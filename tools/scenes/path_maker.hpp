// From a few places to pass and things to look at to a smooth camera path, 30 samples a second.
#pragma once

#include <functional>
#include <span>

#include "rt/base/path.hpp"

namespace surefoot::scenes {

/// A point that the path goes through.
struct Waypoint {
    dvec3 eye{0.0};
    dvec3 look{0.0};       ///< the point looked at when there; unused when `ahead`
    bool ahead = true;     ///< looks where it goes
    double pause_s = 0.0;  ///< stands there
    double pace = 1.0;     ///< speed from here on, relative to that of the other stretches
};

/// Centripetal Catmull-Rom through the eyes at even speed but for their pace, eased; lasts duration_s with its pauses. Head turns
/// are smoothed over about a second. Needs two waypoints. With `ground` (height at x, z) the eyes' y are heights above it.
Path make_path(std::span<const Waypoint> waypoints, double duration_s, const std::function<double(double, double)>& ground = {});

/// The same curve in the plane, about `step_m` apart: to keep trees off it before heights are known.
std::vector<dvec3> curve_points(std::span<const Waypoint> waypoints, double step_m);

}  // namespace surefoot::scenes
