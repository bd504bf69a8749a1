// Geometry of the image cache's pictures: how a capture sees its box, and what shows a picture in a frame. No GL in here.
// README.md has the formulas.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "render/gl/device.hpp"

namespace surefoot::gl {

/// Whether a place is a square inside so many layers.
bool lies_within(const PicturePlace& place, std::uint32_t layers);

/// From positions relative to the picture's eye to clip space: -1..1 is the picture's square. Depth is reversed, and 1 just
/// before the box.
mat4 capture_projection(const CachePicture& picture);

/// The nearest depth of that projection, along the picture's forward: a depth that it gives, over this, is 1 / depth, 1/m.
double nearest_depth_m(const CachePicture& picture);

/// A corner of what shows a picture. As a driver reads it.
struct PictureVertex {
    std::array<float, 4> place;  ///< relative to the eye of the frame, homogeneous
    std::array<float, 3> at;     ///< in the texture array
};
static_assert(sizeof(PictureVertex) == 28);

/// A picture has no more of them: three faces that the square cuts to eight corners each.
constexpr std::size_t max_picture_vertices = 3 * 6 * 3;

/// Triangles that show a picture to an eye: the faces of its box that look at it, as far as the square reaches. Returns their
/// corners, at most max_picture_vertices. 0: the box holds the eye, or a corner that is seen or the plane is not ahead of it.
std::size_t add_picture(const CachePicture& picture, const dvec3& eye, std::span<PictureVertex> to);

}  // namespace surefoot::gl
