// Conic ranges: where an eye may be for a form, a picture or a curve to be valid. Between two distances from a centre, and
// within an angle of a direction. Source: Pasman and Jansen 2002, section 3.5.
#pragma once

#include <limits>

#include "rt/base/geometry.hpp"

namespace surefoot::model {

constexpr double all_directions_rad = 3.14159265358979323846;

/// Points p with min_m <= |p - centre| <= max_m, and at most alpha_rad between p - centre and direction. The centre itself has
/// every direction. As it is made, it holds every point.
struct ConicRange {
    dvec3 centre{0.0};
    double min_m = 0, max_m = std::numeric_limits<double>::infinity();
    dvec3 direction{0, 0, 1};               ///< unit
    double alpha_rad = all_directions_rad;  ///< above 0; all_directions_rad: no limit

    [[nodiscard]] bool empty() const { return !(min_m <= max_m); }
};

/// A range that holds no point.
ConicRange empty_range();

bool contains(const ConicRange& range, const dvec3& point);
/// Whether the range holds a whole sphere: all eyes that a visitor may have soon.
bool contains(const ConicRange& range, const dvec3& centre, double radius_m);

/// Radius of the largest sphere round the point that lies in the range. Negative where the point is outside.
double inner_radius_m(const ConicRange& range, const dvec3& point);

/// A sphere as a range: a degenerate one.
ConicRange sphere_range(const dvec3& centre, double radius_m);
/// A sphere that holds the whole range: the smallest one, but for what min_m leaves out.
ConicRange enclosing_sphere(const ConicRange& range);

/// A range in which both ranges hold; never a point that one of them has not.
/// Exact where both have one centre and their cones nest, and where the enclosing sphere of one range lies in the other. Of two
/// other cones with one centre: the largest cone within both, if `eye` is in it. Else the largest sphere round `eye` within both.
/// Empty where `eye` is not in both, unless the result is exact.
ConicRange intersection(const ConicRange& a, const ConicRange& b, const dvec3& eye);

}  // namespace surefoot::model
