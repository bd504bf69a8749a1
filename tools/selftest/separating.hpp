// Whether a box and a camera's pyramid touch, decided by every separating axis: the slow, sure oracle for visibility.
#pragma once

#include <array>

#include "render/model/view.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::selftest {

/// The pyramid that the picture shows, its angles read off the projection matrix that draws it, not from the planes under test;
/// without end.
struct Pyramid {
    dvec3 eye{0};
    dvec3 forward{0, 0, -1}, right{1, 0, 0}, up{0, 1, 0};
    double tan_x = 1, tan_y = 1;          ///< half extents at depth 1
    double middle_x = 0, middle_y = 0;    ///< of the picture there
    double near_m = model::near_plane_m;  ///< where it begins; 0: at the eye
};
Pyramid pyramid_of(const Pose& pose, model::Viewport viewport);

/// Overlap of the two along the axis that separates them best, relative to the box's distance and size. > 0: they overlap;
/// < 0: they are apart. Accurate to about 1e-7, because the matrix is float.
double overlap(const Pyramid& pyramid, const Box& box);

}  // namespace surefoot::selftest
