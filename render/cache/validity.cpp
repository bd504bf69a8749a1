// Planes and errors of pictures.
#include "render/cache/validity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace surefoot::cache {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int range_halvings = 60;

std::array<dvec3, 8> corners_of(const Box& box) {
    std::array<dvec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] = {(i & 1U) != 0 ? box.max.x : box.min.x, (i & 2U) != 0 ? box.max.y : box.min.y,
                      (i & 4U) != 0 ? box.max.z : box.min.z};
    return corners;
}

double plane_depth(double near, double far, PlanePlace place) {
    switch (place) {
        case PlanePlace::harmonic_mean:
            return 2 * near * far / (near + far);
        case PlanePlace::middle:
            return 0.5 * (near + far);
        case PlanePlace::near_face:
            return near;
        case PlanePlace::far_face:
            return far;
    }
    return near;
}

/// A movement of the eye in the picture's frame.
struct EyeMove {
    double approach_m = 0, sideways_m = 0;  ///< along forward, signed; across it
};

EyeMove move_of(const Picture& picture, const dvec3& eye) {
    const dvec3 by = eye - picture.eye;
    const double approach = glm::dot(by, picture.forward);
    return {approach, glm::length(by - approach * picture.forward)};
}

/// Largest |1/d - 1/plane| over the depths d of the box, as they are after an approach: per metre across a ray.
double parallax_per_m(const Picture& picture, double approach_m) {
    const double near = picture.near_m - approach_m, far = picture.far_m - approach_m, plane = picture.plane_m - approach_m;
    if (!(near >= model::near_plane_m)) return infinite;
    return std::max((picture.plane_m - picture.near_m) / (near * plane), (picture.far_m - picture.plane_m) / (far * plane));
}

PictureErrors errors_after(const Picture& picture, const EyeMove& move) {
    const double per_m = parallax_per_m(picture, move.approach_m);
    if (!std::isfinite(per_m) || !std::isfinite(move.sideways_m)) return {infinite, infinite, infinite};
    return {move.sideways_m * per_m, picture.tangent * std::abs(move.approach_m) * per_m,
            picture.inherited * picture.plane_m / (picture.plane_m - move.approach_m)};
}

double texel_after(const Picture& picture, double approach_m) {
    const double plane = picture.plane_m - approach_m;
    if (picture.texels == 0 || !(plane >= model::near_plane_m)) return infinite;
    return picture.side_m / (picture.texels * plane);
}

}  // namespace

PixelAngles pixel_angles(const Pose& pose, model::Viewport viewport) {
    const model::PictureExtent extent = model::picture_extent(pose, viewport);
    const double columns = std::max(viewport.width, 1U), rows = std::max(viewport.height, 1U);
    const double pixel = std::min(2 * extent.half_x / columns, 2 * extent.half_y / rows);
    const double corner = std::hypot(extent.half_x + std::abs(extent.middle_x), extent.half_y + std::abs(extent.middle_y));
    return {std::atan(corner) - std::atan(corner - pixel), 2 * std::atan(0.5 * pixel), 2 * std::atan(extent.half_y) / rows};
}

ViewPixels view_pixels(const Pose& pose, model::Viewport viewport, double turn_rad) {
    const model::PictureExtent extent = model::picture_extent(pose, viewport);
    const double columns = std::max(viewport.width, 1U), rows = std::max(viewport.height, 1U);
    return {pose.position, pose.forward(), std::min(2 * extent.half_x / columns, 2 * extent.half_y / rows),
            std::hypot(extent.half_x + std::abs(extent.middle_x), extent.half_y + std::abs(extent.middle_y)), turn_rad};
}

// A pixel covers a smaller angle the farther it is from the view direction, and no box is seen beyond the corner.
double ViewPixels::smallest_rad(const Box& box) const {
    const dvec3 to = box.centre() - eye;
    const double distance = glm::length(to), radius = 0.5 * box.diagonal();
    double tangent = corner;
    if (distance > radius) {
        const double from_axis = std::acos(std::clamp(glm::dot(to, forward) / distance, -1.0, 1.0));
        const double farthest = from_axis + std::asin(radius / distance) + turn_rad;
        if (farthest < std::atan(corner)) tangent = std::tan(farthest);
    }
    return std::atan(tangent) - std::atan(tangent - pixel);
}

std::optional<Picture> picture_of(const Box& box, const dvec3& eye, PlanePlace place) {
    const dvec3 to_middle = box.centre() - eye;
    const double distance = glm::length(to_middle);
    if (box.empty() || !std::isfinite(distance) || !(distance >= model::near_plane_m)) return std::nullopt;
    Picture picture;
    picture.eye = eye;
    picture.forward = to_middle / distance;
    const dvec3 upright = std::abs(picture.forward.y) < 0.99 ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
    picture.right = glm::normalize(glm::cross(picture.forward, upright));
    picture.up = glm::cross(picture.right, picture.forward);
    const auto corners = corners_of(box);
    picture.near_m = infinite;
    for (const dvec3& corner : corners) {
        const double depth = glm::dot(corner - eye, picture.forward);
        picture.near_m = std::min(picture.near_m, depth);
        picture.far_m = std::max(picture.far_m, depth);
    }
    if (!(picture.near_m >= model::near_plane_m) || !std::isfinite(picture.far_m)) return std::nullopt;
    picture.plane_m = plane_depth(picture.near_m, picture.far_m, place);
    dvec2 low(infinite), high(-infinite);
    for (const dvec3& corner : corners) {
        const dvec3 at = corner - eye;
        const dvec2 ray = dvec2(glm::dot(at, picture.right), glm::dot(at, picture.up)) / glm::dot(at, picture.forward);
        picture.tangent = std::max(picture.tangent, glm::length(ray));
        low = glm::min(low, ray * picture.plane_m);
        high = glm::max(high, ray * picture.plane_m);
    }
    picture.low_m = low;
    picture.side_m = std::max(high.x - low.x, high.y - low.y);
    return picture;
}

PictureErrors picture_errors(const Picture& picture, const dvec3& eye) { return errors_after(picture, move_of(picture, eye)); }

// The parallax grows with an approach, so none is worse than an eye as far ahead and as far aside as any.
PictureErrors picture_errors(const Picture& picture, const dvec3& eye, double radius_m) {
    const EyeMove move = move_of(picture, eye);
    const double ahead = move.approach_m + radius_m, per_m = parallax_per_m(picture, ahead);
    const double aside = move.sideways_m + radius_m, along = std::abs(move.approach_m) + radius_m;
    if (!std::isfinite(per_m) || !std::isfinite(aside)) return {infinite, infinite, infinite};
    return {aside * per_m, picture.tangent * along * per_m, picture.inherited * picture.plane_m / (picture.plane_m - ahead)};
}

bool valid_around(const Picture& picture, const dvec3& eye, double radius_m, double max_rad) {
    return picture_errors(picture, eye, radius_m).total() <= max_rad &&
           texel_after(picture, move_of(picture, eye).approach_m + radius_m) <= max_rad;
}

double texel_rad(const Picture& picture, const dvec3& eye) { return texel_after(picture, move_of(picture, eye).approach_m); }

double needed_texels(const Picture& picture, double max_texel_rad) {
    return max_texel_rad > 0 ? std::ceil(picture.side_m / (picture.plane_m * max_texel_rad)) : infinite;
}

double inherited_error(double error, double tangent) {
    if (!(error < model::all_directions_rad / 2)) return infinite;
    const double by = std::tan(error), left = 1 - tangent * by;
    return left > 0 ? by * (1 + tangent * tangent) / left : infinite;
}

double faces_sr(const Box& box, const dvec3& eye) {
    double sum = 0;
    const dvec3 side = box.max - box.min;
    for (int axis = 0; axis < 3; ++axis) {
        const bool below = eye[axis] < box.min[axis];
        if (!below && !(eye[axis] > box.max[axis])) continue;
        dvec3 middle = box.centre();
        middle[axis] = below ? box.min[axis] : box.max[axis];
        const dvec3 to = middle - eye;
        const double distance = glm::length(to), area = side[(axis + 1) % 3] * side[(axis + 2) % 3];
        sum += area * std::abs(to[axis]) / (distance * distance * distance);
    }
    return sum;
}

model::ConicRange valid_range(const Picture& picture, double max_rad) {
    // Of all eyes at a distance none is worse than one that is as far ahead and as far aside.
    const auto holds = [&](double distance) {
        return errors_after(picture, {distance, distance}).total() <= max_rad && texel_after(picture, distance) <= max_rad;
    };
    if (!holds(0)) return model::empty_range();
    double within = 0, beyond = picture.near_m;
    for (int i = 0; i < range_halvings; ++i) {
        const double middle = 0.5 * (within + beyond);
        (holds(middle) ? within : beyond) = middle;
    }
    return model::sphere_range(picture.eye, within);
}

PublishedErrors published_errors(const Picture& picture, const dvec3& eye) {
    const EyeMove move = move_of(picture, eye);
    const double near = picture.near_m - move.approach_m, far = picture.far_m - move.approach_m;
    const double plane = picture.plane_m - move.approach_m;
    if (!(near > 0)) return {infinite, infinite};
    const double on_plane = picture.plane_m / plane;
    return {0.5 * move.sideways_m * (1 / picture.near_m - 1 / picture.far_m),
            picture.tangent * std::max(std::abs(picture.near_m / near - on_plane), std::abs(picture.far_m / far - on_plane))};
}

bool published_valid(const Picture& picture, const dvec3& eye, double max_rad) {
    const PublishedErrors errors = published_errors(picture, eye);
    return errors.translation <= max_rad && errors.approach <= max_rad;
}

}  // namespace surefoot::cache
