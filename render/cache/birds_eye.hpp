// Bird's-eye views of the image cache, as in figure 9 of Schaufler and Stuerzlinger 1996: of studies and of walks.
#pragma once

#include <cstdint>
#include <vector>

#include "render/cache/update.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::cache {

/// A box as a bird sees it.
struct SeenBox {
    Box box;
    BoxUse use = BoxUse::unused;
    bool drawn = true;  ///< else it got a picture that this frame does not draw
};

/// A view from above, RGBA8, side_px on each side; row 0 has the smallest z. It shows what is within `bounds`. The highest boxes
/// cover others. Red: a new picture of triangles. Green: one combined from the children's. White: reused. Black: not replaceable,
/// or drawn as triangles. Small squares: new pictures that the frame does not draw. Grey: nothing there. Blue: the eye.
/// Allocates.
std::vector<std::uint8_t> birds_eye_view(std::vector<SeenBox> boxes, const Box& bounds, const dvec3& eye, std::uint32_t side_px);

}  // namespace surefoot::cache
