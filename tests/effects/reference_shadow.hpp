// The reference for shadows of what moves: a ray from a point of the floor to the sun, and a box that stands anywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/effects/reference_picture.hpp"

namespace surefoot::reference {

/// A box about its middle, turned about the vertical.
struct TurnedBox {
    dvec3 middle{0.0}, half{1.0};
    double angle_rad = 0;

    /// Into the box's own axes.
    [[nodiscard]] dvec3 own(const dvec3& v) const {
        const double c = std::cos(angle_rad), s = std::sin(angle_rad);
        return {c * v.x - s * v.z, v.y, s * v.x + c * v.z};
    }
    /// Whether a ray meets it, a box that is larger by `grown_m` on each side.
    [[nodiscard]] bool is_met(const dvec3& from, const dvec3& towards, double grown_m = 0) const {
        const dvec3 o = own(from - middle), d = own(towards), size = half + grown_m;
        double in = 0, out = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 3; ++i) {
            if (d[i] == 0) {
                if (std::abs(o[i]) > size[i]) return false;
                continue;
            }
            const double a = (-size[i] - o[i]) / d[i], b = (size[i] - o[i]) / d[i];
            in = std::max(in, std::min(a, b));
            out = std::min(out, std::max(a, b));
        }
        return in <= out;
    }
};

/// Where the pixel of a picture looks, along the axes of the world. Its part along the view direction is 1.
inline dvec3 ray_of(const View& view, std::uint32_t x, std::uint32_t y) {
    const double width = view.viewport.width, height = view.viewport.height;
    const double half_y = std::tan(0.5 * view.pose.fov_y_rad), half_x = half_y * width / height;
    return view.pose.forward() + view.pose.right() * (half_x * (2 * (x + 0.5) / width - 1)) -
           view.pose.up() * (half_y * (2 * (y + 0.5) / height - 1));
}

/// The point that a pixel shows.
inline dvec3 point_of(const View& view, const Picture& picture, std::uint32_t x, std::uint32_t y) {
    return view.pose.position + ray_of(view, x, y) / picture.nearness[std::size_t{y} * picture.width + x];
}

}  // namespace surefoot::reference
