// Frustum, visibility and projection: double precision, never losing a box that encloses the frustum.
#include "render/model/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::model {

namespace {

constexpr double large_share = 16;  ///< a box is large from a quarter of its distance on (squared)
constexpr double widest_half_angle_rad = 89.0 / 180.0 * 3.14159265358979323846 - 1e-6;

// A ray at elevation e on a side plane is only cos(e) * sin(w) away from the plane turned outwards by w: the corner rays decide.
double widen(double half, double other, double angle_rad) {
    const double cos_corner = 1.0 / std::sqrt(1.0 + std::pow(std::tan(other) * std::cos(half), 2));
    const double by = std::asin(std::min(1.0, std::sin(std::min(angle_rad, widest_half_angle_rad)) / cos_corner));
    return std::min(half + by, widest_half_angle_rad);
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

double half_angle_y(const Pose& pose) {
    const double fov = std::isnan(pose.fov_y_rad) ? Pose{}.fov_y_rad : pose.fov_y_rad;  // clamp hands a NaN on
    return std::clamp(0.5 * fov, 1e-4, widest_half_angle_rad);
}

HalfAngles half_angles(const Pose& pose, Viewport viewport, double angle_rad) {
    const double y = half_angle_y(pose);
    const double aspect = static_cast<double>(std::max(viewport.width, 1U)) / static_cast<double>(std::max(viewport.height, 1U));
    const double x = std::min(std::atan(std::tan(y) * aspect), widest_half_angle_rad);
    if (!(angle_rad > 0)) return {x, y};
    return {widen(x, y, angle_rad), widen(y, x, angle_rad)};
}

Frustum make_frustum(const Pose& pose, Viewport viewport, double far_m, double radius_m, double angle_rad) {
    const HalfAngles half = half_angles(pose, viewport, angle_rad);
    const dvec3 forward = pose.forward(), up = pose.up(), right = pose.right();
    // Seen from this apex, the same angles hold the whole ball of eyes.
    const double pull = radius_m > 0 ? radius_m / std::sin(std::min(half.x, half.y)) : 0.0;
    const dvec3 apex = pose.position - pull * forward;

    const auto plane = [](const dvec3& normal, const dvec3& through) { return dvec4(normal, -glm::dot(normal, through)); };
    const double sx = std::sin(half.x), cx = std::cos(half.x), sy = std::sin(half.y), cy = std::cos(half.y);
    const bool exact = !(radius_m > 0) && !(angle_rad > 0);
    // A turned near plane sweeps towards the eye: every region but a single pose keeps all that is in front of the ball.
    const dvec3 near_point = pose.position + (exact ? near_plane_m : -radius_m) * forward;
    Frustum frustum;
    frustum.planes = {plane(cx * right + sx * forward, apex), plane(-cx * right + sx * forward, apex),
                      plane(cy * up + sy * forward, apex), plane(-cy * up + sy * forward, apex), plane(forward, near_point)};
    frustum.corners[0] = apex;
    const double reach = std::max(far_m, 1.0) + pull;
    for (int i = 0; i < 4; ++i) {
        const double side = (i & 1) != 0 ? 1.0 : -1.0, lift = (i & 2) != 0 ? 1.0 : -1.0;
        frustum.corners[static_cast<std::size_t>(i) + 1] =
            apex + reach * (forward + side * std::tan(half.x) * right + lift * std::tan(half.y) * up);
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
    if (inside) return true;
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
    const HalfAngles half = half_angles(pose, viewport);
    mat4 m(0.0F);
    m[0][0] = static_cast<float>(1.0 / std::tan(half.x));
    m[1][1] = static_cast<float>(1.0 / std::tan(half.y));
    m[2][3] = -1.0F;
    m[3][2] = static_cast<float>(near_plane_m);
    return m;
}

double pixel_angle(const Pose& pose, Viewport viewport) {
    return std::atan(2.0 * std::tan(half_angles(pose, viewport).y) / static_cast<double>(std::max(viewport.height, 1U)));
}

}  // namespace surefoot::model
