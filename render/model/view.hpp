// A view: pose, viewport and the frustum they make; visibility of boxes; pixels of things. All in double.
#pragma once

#include <array>
#include <cstdint>

#include "rt/base/geometry.hpp"

namespace surefoot::model {

struct Viewport {
    std::uint32_t width = 1280, height = 720;
};

constexpr double near_plane_m = 0.05;  ///< reversed-Z, infinite far plane

/// Six-plane frustum, infinite far (five planes and the near one), with its corners up to `far_m` for the second test.
struct Frustum {
    std::array<dvec4, 5> planes;   ///< left, right, bottom, top, near; inside: dot(xyz, p) + w >= 0; unit normals
    std::array<dvec3, 5> corners;  ///< the eye and the four far corners (at far_m)
};

/// Half of the field of view up and down as every part of the renderer takes it: capped below 89 degrees, at least 1e-4 rad; the
/// default's where the pose's is not a number.
double half_angle_y(const Pose& pose);

/// Half fields of view across and up.
struct HalfAngles {
    double x = 0, y = 0;  ///< rad, below 89 degrees
};
/// Of the upright view that holds the pose's own turned by angle_rad any way. 0: its own.
HalfAngles half_angles(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// The frustum that holds every pose of a region: widened by angle_rad on each side and pulled back by radius_m.
/// radius 0 and angle 0: exactly the pose's own. Half angles are capped below 89 degrees.
Frustum make_frustum(const Pose& pose, Viewport viewport, double far_m, double radius_m = 0.0, double angle_rad = 0.0);

/// Conservative: never false for a box that some point of the frustum touches. Planes against the box, then the frustum's
/// corners against the box's faces (DESIGN 8), then, of large boxes, edges across edges.
bool visible(const Frustum& frustum, const Box& box);

/// Eye-relative view matrix (rotation only: positions are made relative to the eye in double first).
mat4 view_rotation(const Pose& pose);
/// Reversed-Z, infinite far, depth 1 at near_plane_m and 0 at infinity; clip space 0..1.
mat4 projection(const Pose& pose, Viewport viewport);

/// Angle of one pixel at the centre of the view, rad.
double pixel_angle(const Pose& pose, Viewport viewport);

}  // namespace surefoot::model
