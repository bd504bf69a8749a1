// A view: pose, viewport and the frustum they make; visibility of boxes; pixels of things. All in double.
#pragma once

#include <array>
#include <cstdint>

#include "rt/base/geometry.hpp"

namespace surefoot::model {

struct Viewport {
    std::uint32_t width = 1280, height = 720;
    /// Off axis, for a screen that is not straight before the eye (a channel of a simulator): the middle of the picture lies so
    /// many of its half widths to the right, half heights above, of where the pose looks. Held within 8 either way; 0 if not a
    /// number.
    double shift_x = 0, shift_y = 0;
};

constexpr double near_plane_m = 0.05;  ///< reversed-Z, infinite far plane

/// Six-plane frustum, infinite far (five planes and the near one), with its corners up to `far_m` for the second test.
struct Frustum {
    std::array<dvec4, 5> planes;   ///< left, right, bottom, top, near; inside: dot(xyz, p) + w >= 0; unit normals
    std::array<dvec3, 5> corners;  ///< the eye and the four far corners (at far_m)
    bool open = false;             ///< of a region turned so far that a side looks backwards: no corners, the planes alone decide
};

/// Half fields of view across and up.
struct HalfAngles {
    double x = 0, y = 0;  ///< rad, below 89 degrees unless turned
};
/// Of the upright view about the pose's own direction that holds its picture, turned by angle_rad any way. 0 and no shift: its
/// own.
HalfAngles half_angles(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// The picture on the plane at depth 1: its half extents and its middle. Within 89 degrees of where the pose looks.
struct PictureExtent {
    double half_x = 0, half_y = 0, middle_x = 0, middle_y = 0;  ///< tangents
};
PictureExtent picture_extent(const Pose& pose, Viewport viewport);

/// Angles between where the pose looks and the picture's sides, rad; turned by angle_rad any way, it lies within them. From 89
/// degrees on a side says no more than that it is out there.
struct SideAngles {
    double left = 0, right = 0, down = 0, up = 0;  ///< left and down negative, unless shifted past the middle
};
SideAngles side_angles(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// Where a frustum's corners lie for the second test: behind all of the model, seen from anywhere in or near it.
inline double far_corners_m(const Box& model) { return 2.0 * model.diagonal() + 1000.0; }

/// The frustum that holds every pose of a region: widened by angle_rad on each side and pulled back by radius_m.
/// radius 0 and angle 0: exactly the pose's own. Sides turned beyond 89 degrees hold nothing back.
Frustum make_frustum(const Pose& pose, Viewport viewport, double far_m, double radius_m = 0.0, double angle_rad = 0.0);

/// Conservative: never false for a box that some point of the frustum touches. Planes against the box, then the frustum's
/// corners against the box's faces (DESIGN 8), then, of large boxes, edges across edges.
bool visible(const Frustum& frustum, const Box& box);

/// Eye-relative view matrix (rotation only: positions are made relative to the eye in double first).
mat4 view_rotation(const Pose& pose);
/// Reversed-Z, infinite far, depth 1 at near_plane_m and 0 at infinity; clip space 0..1.
mat4 projection(const Pose& pose, Viewport viewport);

/// Angle of one pixel where the pose looks, rad: nowhere in the picture is it larger.
double pixel_angle(const Pose& pose, Viewport viewport);

}  // namespace surefoot::model
