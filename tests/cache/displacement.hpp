// Random pictures of boxes, moved eyes, and by how many pixels a point is drawn beside its place. Shares no formula with the
// cache.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/cache/validity.hpp"
#include "rt/base/random.hpp"
#include "tests/random_direction.hpp"

namespace surefoot::cache {

using test::any_direction;

/// A point of the box; every other one is a corner, where errors are largest.
inline dvec3 any_point(Random& random, const Box& box) {
    dvec3 p = any_in(random, box.min, box.max);
    if (random.below(2) == 0) return p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.below(2) == 0 ? box.min[axis] : box.max[axis];
    return p;
}

/// A box, near-cubic or flat, 1.5 to 60 times its size away from the origin.
inline Box any_box(Random& random) {
    dvec3 half = any_in(random, dvec3(0.3), dvec3(1));
    if (random.below(4) == 0) half[static_cast<int>(random.below(3))] = 0;
    half *= std::exp(random.range(-3, 4));
    const dvec3 at = any_direction(random) * glm::length(half) * std::exp(random.range(0.4, 4.1));
    return {at - half, at + half};
}

/// A view of any width, and where on its picture a point stands.
struct AnyView {
    model::Viewport viewport;
    Pose pose;
    PixelAngles pixels;

    explicit AnyView(Random& random) {
        viewport.width = 160 + random.below(1200);
        viewport.height = 120 + random.below(800);
        pose.fov_y_rad = random.range(0.3, 1.7);
        pixels = pixel_angles(pose, viewport);
    }
};

/// Distance on the picture, in pixels, between the point and its image. The view is turned so that the point stands anywhere on
/// it.
inline double displacement_px(Random& random, const AnyView& view, const dvec3& eye, const dvec3& point, const dvec3& image) {
    const model::PictureExtent extent = model::picture_extent(view.pose, view.viewport);
    const double pixel_x = 2 * extent.half_x / view.viewport.width, pixel_y = 2 * extent.half_y / view.viewport.height;
    const auto place = [&](double half, double pixel) {  // every third one at the very side
        const double max_out = half - 1.5 * pixel;
        const std::uint32_t where = random.below(6);
        return where == 0 ? -max_out : where == 1 ? max_out : random.range(-max_out, max_out);
    };
    const double u = place(extent.half_x, pixel_x), v = place(extent.half_y, pixel_y);
    const auto frame_of = [](const dvec3& along, const dvec3& hint) {
        const dvec3 side = glm::normalize(glm::cross(along, hint));
        return dmat3(side, glm::cross(along, side), along);
    };
    const dvec3 hint = any_direction(random), camera_hint = any_direction(random);
    const dmat3 world = frame_of(glm::normalize(point - eye), hint);
    const dmat3 camera = frame_of(glm::normalize(dvec3(u, v, 1)), camera_hint);
    const dvec3 at = camera * (glm::transpose(world) * (image - eye));
    return std::hypot((at.x / at.z - u) / pixel_x, (at.y / at.z - v) / pixel_y);
}

/// Where a picture shows a point that is seen from `from`, on a plane at the depth plane_m.
inline dvec3 image_on(const Picture& picture, const dvec3& from, const dvec3& point, double plane_m) {
    const double depth = glm::dot(point - picture.eye, picture.forward), start = glm::dot(from - picture.eye, picture.forward);
    return from + (point - from) * ((plane_m - start) / (depth - start));
}

/// The farthest eye along a direction for which the test still holds, to a billionth. `holds`: true at the picture's own eye.
inline dvec3 last_eye(const Picture& picture, const dvec3& direction, const std::function<bool(const dvec3&)>& holds) {
    double within = 0, beyond = 4 * picture.far_m;
    for (int i = 0; i < 34; ++i) {
        const double middle = 0.5 * (within + beyond);
        (holds(picture.eye + direction * middle) ? within : beyond) = middle;
    }
    return picture.eye + direction * within;
}

}  // namespace surefoot::cache
