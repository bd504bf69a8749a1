// Views: viewport, frustum of a pose or a region of poses, visibility of boxes, matrices. All in double.
#pragma once

#include <array>
#include <cstdint>

#include "rt/base/geometry.hpp"

namespace surefoot::model {

/// Size of the picture in pixels, and the window of an off-axis projection.
struct Viewport {
    std::uint32_t width = 1280, height = 720;
    /// Off-axis projection, for a screen that is not straight before the eye (a simulator channel). The image centre lies
    /// shift_x half widths to the right and shift_y half heights above the view direction. Clamped to +-8; NaN counts as 0.
    double shift_x = 0, shift_y = 0;
};

constexpr double near_plane_m = 0.05;  ///< reversed-Z, infinite far plane

/// Frustum without a far plane: five planes, and corners at distance far_m for the second test.
struct Frustum {
    std::array<dvec4, 5> planes;   ///< left, right, bottom, top, near; inside: dot(xyz, p) + w >= 0; unit normals
    std::array<dvec3, 5> corners;  ///< the eye and the four far corners (at far_m)
    bool open = false;             ///< a side of the region looks backwards: no corners, only planes are tested
};

/// Half fields of view across and up.
struct HalfAngles {
    double x = 0, y = 0;  ///< rad, below 89 degrees if angle_rad is 0
};
/// Half angles of the symmetric view in the pose's direction that contains its image, turned by up to angle_rad. With angle 0 and
/// no shift: those of the pose.
HalfAngles half_angles(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// The image on the plane at depth 1: half extents and centre. Within 89 degrees of the view direction.
struct PictureExtent {
    double half_x = 0, half_y = 0, middle_x = 0, middle_y = 0;  ///< tangents
};
PictureExtent picture_extent(const Pose& pose, Viewport viewport);

/// Angles between the view direction and the sides of the image, rad, widened by angle_rad. Angles of 89 degrees and more mean
/// only "at least 89 degrees".
struct SideAngles {
    double left = 0, right = 0, down = 0, up = 0;  ///< left and down negative, unless shifted past the middle
};
SideAngles side_angles(const Pose& pose, Viewport viewport, double angle_rad = 0.0);

/// By how much a view reaches further on any side than another in the same direction does, rad; 0 or more.
double widened_rad(const Pose& view, const Pose& other, Viewport viewport);

/// Distance of a frustum's corners in the second test: behind the whole model, from anywhere in or near it.
inline double far_corners_m(const Box& model) { return 2.0 * model.diagonal() + 1000.0; }

/// The frustum that contains the frusta of all poses of a region: widened by angle_rad on each side and moved back by radius_m.
/// radius 0 and angle 0: exactly the frustum of the pose. Sides beyond 89 degrees cull nothing.
Frustum make_frustum(const Pose& pose, Viewport viewport, double far_m, double radius_m = 0.0, double angle_rad = 0.0);

/// Conservative: never false for a box that touches the frustum. Tests the planes against the box, then the frustum's corners
/// against the faces of the box; for large boxes also the cross products of edges.
bool visible(const Frustum& frustum, const Box& box);

/// Rotation from world to view. Positions must be made relative to the eye in double first.
mat4 view_rotation(const Pose& pose);
/// Reversed-Z, infinite far, depth 1 at near_plane_m and 0 at infinity; clip space 0..1.
mat4 projection(const Pose& pose, Viewport viewport);

/// Angle of one pixel in view direction, rad: the largest in the image.
double pixel_angle(const Pose& pose, Viewport viewport);

}  // namespace surefoot::model
