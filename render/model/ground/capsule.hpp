// A vertical capsule against triangles: how far apart they are, and where a straight move first touches.
#pragma once

#include "rt/base/geometry.hpp"

namespace surefoot::model {

/// A triangle in the world, metres. Both sides block.
struct GroundTriangle {
    dvec3 a{0.0}, b{0.0}, c{0.0};
};

/// All points within `radius` of the segment from `low` straight up by `length`.
struct Capsule {
    dvec3 low{0.0};
    double length = 0, radius = 0;
};

/// How far the axis is from a triangle, and the unit vector from the triangle's nearest point to the axis. Where they meet, the
/// distance is 0 and the vector is the triangle's normal.
struct Separation {
    double distance = 0;
    dvec3 away{0.0};
};
Separation separation(const Capsule& capsule, const GroundTriangle& triangle);

/// A distance that the axis is not nearer than to the triangle, by its plane and by the sphere around it; may be below 0. Takes a
/// tenth of the time of separation().
double min_separation(const Capsule& capsule, const GroundTriangle& triangle);

/// Where a move first touches.
struct Contact {
    double share = 2;  ///< of the move; above 1: it does not touch
    dvec3 away{0.0};   ///< from the triangle to the axis then, unit
};
/// The distance to a convex set along a line is convex, so Newton's method from the start never steps past the first contact.
/// A capsule that overlaps at the start touches at once if the move goes deeper, and never if it does not. A contact after the
/// share `until` of the move need not be found.
Contact first_contact(const Capsule& capsule, const dvec3& move, const GroundTriangle& triangle, double until = 1);

/// Where the vertical line at (x, z) meets the triangle, or minus infinity. Edges belong to both of their triangles.
double height_at(const GroundTriangle& triangle, double x, double z);

/// Where a line meets a triangle, as a share of its way; above 1: nowhere.
struct Crossing {
    double share = 2;
    bool back = false;  ///< the triangle turns its back to where the line comes from
};
Crossing crossing_of(const dvec3& from, const dvec3& way, const GroundTriangle& triangle);

}  // namespace surefoot::model
