// Triangles in the world as the exact judge takes them: their boxes, and their heights over a place.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "rt/base/geometry.hpp"

namespace surefoot::exact {

/// Of a triangle in the world.
using Corners = std::array<dvec3, 3>;

inline bool is_finite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline bool is_finite(const Corners& corners) { return is_finite(corners[0]) && is_finite(corners[1]) && is_finite(corners[2]); }

inline Box box_of(const Corners& corners) {
    Box box;
    for (const dvec3& corner : corners) box.grow(corner);
    return box;
}

/// Height at which the upright line meets the triangle, rim included. None for upright triangles.
inline std::optional<double> height_at(const Corners& corners, double x, double z) {
    using Flat = std::array<long double, 2>;
    std::array<Flat, 3> to;
    for (std::size_t c = 0; c < 3; ++c)
        to[c] = {static_cast<long double>(corners[c].x) - x, static_cast<long double>(corners[c].z) - z};
    const auto turn = [](const Flat& a, const Flat& b) { return a[0] * b[1] - a[1] * b[0]; };
    const long double a = turn(to[1], to[2]), b = turn(to[2], to[0]), c = turn(to[0], to[1]);
    const bool inside = (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
    if (!inside || a + b + c == 0) return {};
    return static_cast<double>((a * corners[0].y + b * corners[1].y + c * corners[2].y) / (a + b + c));
}

/// Without ends.
inline Box upright_line(double x, double z) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {dvec3(x, -inf, z), dvec3(x, inf, z)};
}

}  // namespace surefoot::exact
