// Conic ranges: points, spheres and other ranges inside of them.
#include "render/model/conic_range.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace surefoot::model {

namespace {

constexpr double right_angle_rad = all_directions_rad / 2, half_right_angle_rad = all_directions_rad / 4;
constexpr double rounded_rad = 1e-9;     ///< taken from what is only nearly exact
constexpr double rounded_share = 1e-9;   ///< the same, of a radius
constexpr double rounded_place = 1e-12;  ///< the same, of the coordinates

/// Without the loss of acos() near its ends.
double angle_between(const dvec3& a, const dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

/// The directions of `inner` are among those of `outer`.
bool cone_nests(const ConicRange& inner, const ConicRange& outer) {
    return outer.alpha_rad >= all_directions_rad ||
           angle_between(inner.direction, outer.direction) + inner.alpha_rad <= outer.alpha_rad;
}

/// The largest cone in both, of two that do not nest: its axis lies between theirs. Not wider than 0: there is none.
ConicRange cone_within(const ConicRange& a, const ConicRange& b) {
    const double apart = angle_between(a.direction, b.direction);
    ConicRange cone = a;
    cone.alpha_rad = 0.5 * (a.alpha_rad + b.alpha_rad - apart) - rounded_rad;
    const double from_a = 0.5 * (a.alpha_rad - b.alpha_rad + apart);
    dvec3 across = b.direction - glm::dot(a.direction, b.direction) * a.direction;
    const double length = glm::length(across);
    if (!(length > 1e-6)) {  // equal or opposite: many planes hold both, and none of them is chosen
        cone.alpha_rad = -1;
        return cone;
    }
    cone.direction = glm::normalize(std::cos(from_a) * a.direction + std::sin(from_a) * (across / length));
    return cone;
}

ConicRange sphere_within(const ConicRange& a, const ConicRange& b, const dvec3& eye) {
    const double inner = std::min(inner_radius_m(a, eye), inner_radius_m(b, eye));
    if (!std::isfinite(inner)) return inner > 0 ? ConicRange{} : empty_range();
    const double scale = glm::length(eye) + glm::length(eye - a.centre) + glm::length(eye - b.centre);
    const double radius = inner * (1 - rounded_share) - rounded_place * scale;
    return radius >= 0 ? sphere_range(eye, radius) : empty_range();
}

}  // namespace

ConicRange empty_range() {
    ConicRange range;
    range.min_m = 1;
    range.max_m = 0;
    return range;
}

bool contains(const ConicRange& range, const dvec3& point) {
    const dvec3 from_centre = point - range.centre;
    const double distance = glm::length(from_centre);
    if (!(distance >= range.min_m && distance <= range.max_m)) return false;
    if (range.alpha_rad >= all_directions_rad || distance == 0) return true;
    return angle_between(from_centre, range.direction) <= range.alpha_rad;
}

double inner_radius_m(const ConicRange& range, const dvec3& point) {
    if (range.empty()) return -1;
    const dvec3 from_centre = point - range.centre;
    const double distance = glm::length(from_centre);
    double radius = range.max_m - distance;
    if (range.min_m > 0) radius = std::min(radius, distance - range.min_m);
    if (range.alpha_rad >= all_directions_rad) return radius;
    if (distance == 0) return std::min(radius, 0.0);
    const double left_rad = range.alpha_rad - angle_between(from_centre, range.direction);
    // The nearest point of the cone's side, or its tip.
    return std::min(radius, left_rad >= right_angle_rad ? distance : distance * std::sin(std::max(left_rad, -right_angle_rad)));
}

bool contains(const ConicRange& range, const dvec3& centre, double radius_m) {
    return radius_m >= 0 && radius_m <= inner_radius_m(range, centre);
}

ConicRange sphere_range(const dvec3& centre, double radius_m) {
    ConicRange range;
    range.centre = centre;
    range.max_m = radius_m;
    return range;
}

ConicRange enclosing_sphere(const ConicRange& range) {
    const double alpha = range.alpha_rad, far = range.max_m;
    if (range.empty() || !std::isfinite(far) || alpha >= right_angle_rad) return sphere_range(range.centre, far);
    if (alpha >= half_right_angle_rad)  // through the rim of its end
        return sphere_range(range.centre + far * std::cos(alpha) * range.direction, far * std::sin(alpha));
    const double radius = far / (2 * std::cos(alpha));  // through its tip and that rim
    return sphere_range(range.centre + radius * range.direction, radius);
}

ConicRange intersection(const ConicRange& a, const ConicRange& b, const dvec3& eye) {
    if (a.empty() || b.empty()) return empty_range();
    if (a.centre == b.centre) {
        const bool a_nests = cone_nests(a, b);
        if (a_nests || cone_nests(b, a)) {
            ConicRange exact = a_nests ? a : b;
            exact.min_m = std::max(a.min_m, b.min_m);
            exact.max_m = std::min(a.max_m, b.max_m);
            return exact;
        }
        ConicRange cone = cone_within(a, b);
        cone.min_m = std::max(a.min_m, b.min_m);
        cone.max_m = std::min(a.max_m, b.max_m);
        if (cone.alpha_rad > 0 && contains(cone, eye)) return cone;
        return sphere_within(a, b, eye);
    }
    for (const auto& [inner, outer] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
        const ConicRange around = enclosing_sphere(*inner);
        if (std::isfinite(around.max_m) && contains(*outer, around.centre, around.max_m * (1 + rounded_share))) return *inner;
        if (outer->min_m <= 0 && !std::isfinite(outer->max_m) && outer->alpha_rad >= all_directions_rad) return *inner;
    }
    return sphere_within(a, b, eye);
}

}  // namespace surefoot::model
