// Frustum, visibility and projection: double precision, never losing a box that encloses the frustum.
#include "render/model/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::model {

namespace {

constexpr double large_share = 16;  ///< a box is large from a quarter of its distance on (squared)
constexpr double widest_half_angle_rad = 89.0 / 180.0 * 3.14159265358979323846 - 1e-6;

double held(double shift) { return std::isnan(shift) ? 0.0 : std::clamp(shift, -8.0, 8.0); }

/// So that the farther side stays within the widest.
double widest_half(double shift) {
    return shift == 0 ? widest_half_angle_rad : std::atan(std::tan(widest_half_angle_rad) / (1.0 + std::abs(shift)));
}

// A ray at elevation e on a side plane is only cos(e) * sin(w) away from the plane turned outwards by w: the corner rays decide.
double widen(double half, double other, double angle_rad) {
    const double cos_corner = 1.0 / std::sqrt(1.0 + std::pow(std::tan(other) * std::cos(half), 2));
    const double by = std::asin(std::min(1.0, std::sin(std::min(angle_rad, widest_half_angle_rad)) / cos_corner));
    return half + by;
}

/// Across an edge of the box and one of the pyramid: what is left for large boxes beside the view. Source: Gottschalk, Lin &
/// Manocha 1996 (OBBTree), for a pyramid without end.
bool separated_across_edges(const Frustum& frustum, const dvec3& centre, const dvec3& half) {
    const auto& at = frustum.corners;
    const std::array<dvec3, 6> edges = {glm::normalize(at[1] - at[0]), glm::normalize(at[2] - at[0]),
                                        glm::normalize(at[3] - at[0]), glm::normalize(at[4] - at[0]),
                                        glm::normalize(at[2] - at[1]), glm::normalize(at[3] - at[1])};
    const dvec3 to_apex = at[0] - centre;
    // The box lies within `scale` of the apex: up to there an edge that seems parallel, but for rounding, stays within the slack.
    const double scale = glm::length(to_apex) + glm::length(half);
    const double slack = 1e-9 * scale + 1e-14 * glm::length(at[0]), parallel = -1e-10;
    for (const dvec3& e : edges) {
        for (const dvec3& axis : {dvec3(0, -e.z, e.y), dvec3(e.z, 0, -e.x), dvec3(-e.y, e.x, 0)}) {
            const double along = glm::dot(axis, to_apex);
            if (!(std::abs(along) > glm::dot(glm::abs(axis), half) + slack)) continue;
            const dvec3 away = along > 0 ? axis : -axis;
            if (glm::dot(away, edges[0]) >= parallel && glm::dot(away, edges[1]) >= parallel &&
                glm::dot(away, edges[2]) >= parallel && glm::dot(away, edges[3]) >= parallel)
                return true;
        }
    }
    return false;
}

}  // namespace

PictureExtent picture_extent(const Pose& pose, Viewport viewport) {
    const double fov = std::isnan(pose.fov_y_rad) ? Pose{}.fov_y_rad : pose.fov_y_rad;  // clamp hands a NaN on
    const double aspect = static_cast<double>(std::max(viewport.width, 1U)) / static_cast<double>(std::max(viewport.height, 1U));
    const double shift_x = held(viewport.shift_x), shift_y = held(viewport.shift_y);
    const double y = std::clamp(0.5 * fov, 1e-4, widest_half(shift_y));
    const double x = std::min(std::atan(std::tan(y) * aspect), widest_half(shift_x));
    const double half_x = std::tan(x), half_y = std::tan(y);
    return {half_x, half_y, shift_x * half_x, shift_y * half_y};
}

SideAngles side_angles(const Pose& pose, Viewport viewport, double angle_rad) {
    const PictureExtent at = picture_extent(pose, viewport);
    SideAngles sides{-std::atan(at.half_x - at.middle_x), std::atan(at.half_x + at.middle_x), -std::atan(at.half_y - at.middle_y),
                     std::atan(at.half_y + at.middle_y)};
    if (!(angle_rad > 0)) return sides;
    const double farther_x = std::max(-sides.left, sides.right), farther_y = std::max(-sides.down, sides.up);
    return {-widen(-sides.left, farther_y, angle_rad), widen(sides.right, farther_y, angle_rad),
            -widen(-sides.down, farther_x, angle_rad), widen(sides.up, farther_x, angle_rad)};
}

double widened_rad(const Pose& view, const Pose& other, Viewport viewport) {
    const SideAngles now = side_angles(view, viewport), then = side_angles(other, viewport);
    return std::max({0.0, now.right - then.right, then.left - now.left, now.up - then.up, then.down - now.down});
}

HalfAngles half_angles(const Pose& pose, Viewport viewport, double angle_rad) {
    const SideAngles sides = side_angles(pose, viewport, angle_rad);
    return {std::max(-sides.left, sides.right), std::max(-sides.down, sides.up)};
}

Frustum make_frustum(const Pose& pose, Viewport viewport, double far_m, double radius_m, double angle_rad) {
    const SideAngles sides = side_angles(pose, viewport, angle_rad);
    const dvec3 forward = pose.forward(), up = pose.up(), right = pose.right();
    const auto plane = [](const dvec3& normal, const dvec3& through) { return dvec4(normal, -glm::dot(normal, through)); };
    const auto inwards = [&](double angle, const dvec3& axis) { return std::cos(angle) * axis - std::sin(angle) * forward; };
    const bool exact = !(radius_m > 0) && !(angle_rad > 0);
    // A turned near plane sweeps towards the eye: every region but a single pose keeps all that is in front of the ball.
    const dvec3 near_point = pose.position + (exact ? near_plane_m : -radius_m) * forward;
    Frustum frustum;
    const std::array<double, 4> angles = {-sides.left, sides.right, -sides.down, sides.up};
    if (!exact && *std::max_element(angles.begin(), angles.end()) > widest_half_angle_rad) {
        const std::array<dvec3, 4> outwards = {-right, right, -up, up};
        const dvec4 all(0, 0, 0, 1);
        for (std::size_t i = 0; i < 4; ++i) {  // each clears the ball of eyes by itself
            const dvec3 normal = inwards(-angles[i], -outwards[i]);
            frustum.planes[i] = angles[i] > widest_half_angle_rad ? all : plane(normal, pose.position - radius_m * normal);
        }
        frustum.planes[4] = all;  // what is seen over that side may lie behind the middle's eye
        frustum.corners.fill(pose.position);
        frustum.open = true;
        return frustum;
    }
    // The eye is pulled back along the middle of the view: seen from there, the same angles hold the whole ball of eyes.
    const double middle_x = std::tan(0.5 * (sides.left + sides.right)), middle_y = std::tan(0.5 * (sides.down + sides.up));
    const dvec3 middle = forward + middle_x * right + middle_y * up;
    const double clears = std::min(
        {std::sin(sides.right) - std::cos(sides.right) * middle_x, std::cos(sides.left) * middle_x - std::sin(sides.left),
         std::sin(sides.up) - std::cos(sides.up) * middle_y, std::cos(sides.down) * middle_y - std::sin(sides.down)});
    const double pull = radius_m > 0 ? radius_m / clears : 0.0;
    const dvec3 apex = pose.position - pull * middle;

    frustum.planes = {plane(inwards(sides.left, right), apex), plane(inwards(-sides.right, -right), apex),
                      plane(inwards(sides.down, up), apex), plane(inwards(-sides.up, -up), apex), plane(forward, near_point)};
    frustum.corners[0] = apex;
    const double reach = std::max(far_m, 1.0) + pull;
    for (int i = 0; i < 4; ++i) {
        const double across = std::tan((i & 1) != 0 ? sides.right : sides.left),
                     rise = std::tan((i & 2) != 0 ? sides.up : sides.down);
        frustum.corners[static_cast<std::size_t>(i) + 1] = apex + reach * (forward + across * right + rise * up);
    }
    return frustum;
}

bool visible(const Frustum& frustum, const Box& box) {
    if (box.empty()) return false;
    const dvec3 centre = box.centre(), half = box.half();
    bool inside = true;
    for (const dvec4& p : frustum.planes) {
        const double reach = std::abs(p.x) * half.x + std::abs(p.y) * half.y + std::abs(p.z) * half.z;
        const double away = p.x * centre.x + p.y * centre.y + p.z * centre.z + p.w;
        if (away + reach < -1e-9 * (std::abs(p.w) + reach)) return false;  // the slack covers rounding far from the origin
        inside = inside && away >= reach;
    }
    if (inside || frustum.open) return true;
    // The far plane is infinite: a face separates only if the apex is beyond it and no edge ray comes back.
    for (int axis = 0; axis < 3; ++axis) {
        const double apex = frustum.corners[0][axis];
        bool below = apex<box.min[axis], above = apex> box.max[axis];
        for (std::size_t i = 1; i < 5 && (below || above); ++i) {
            const double step = frustum.corners[i][axis] - apex;
            below = below && step <= 0;
            above = above && step >= 0;
        }
        if (below || above) return false;
    }
    // Small boxes hardly ever pass so far from outside, and the time is better spent on their children.
    const dvec3 to_centre = centre - frustum.corners[0];
    const bool large = large_share * glm::dot(half, half) > glm::dot(to_centre, to_centre);
    return !(large && separated_across_edges(frustum, centre, half));
}

mat4 view_rotation(const Pose& pose) { return mat4(glm::mat4_cast(glm::conjugate(glm::normalize(pose.orientation)))); }

mat4 projection(const Pose& pose, Viewport viewport) {
    const PictureExtent at = picture_extent(pose, viewport);
    mat4 m(0.0F);
    m[0][0] = static_cast<float>(1.0 / at.half_x);
    m[1][1] = static_cast<float>(1.0 / at.half_y);
    m[2][0] = static_cast<float>(at.middle_x / at.half_x);
    m[2][1] = static_cast<float>(at.middle_y / at.half_y);
    m[2][3] = -1.0F;
    m[3][2] = static_cast<float>(near_plane_m);
    return m;
}

double pixel_angle(const Pose& pose, Viewport viewport) {
    return std::atan(2.0 * picture_extent(pose, viewport).half_y / static_cast<double>(std::max(viewport.height, 1U)));
}

}  // namespace surefoot::model
