// Box impostors: six orthographic captures of the actual objects, one a face (Maciel 1994, 3.4.2 and 3.6).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::bake {

/// A triangle to be captured, with a colour at each corner.
struct ColouredTriangle {
    std::array<vec3, 3> corners;  ///< relative to the box's centre
    std::array<std::array<std::uint8_t, 4>, 3> colours;
    float shown = 1;  ///< share that passes the alpha test; that share of its texels is painted, scattered
};

/// One face, as an orthographic camera on its axis sees it. Row 0 lies at the low end of the second in-plane axis.
struct FaceCapture {
    std::vector<std::uint8_t> rgba;      ///< pixels x pixels; alpha 0 where nothing is
    std::array<std::uint8_t, 4> mean{};  ///< of the covered texels
    float depth_m = 0;                   ///< the deepest captured point behind the face
    float covered = 0;                   ///< share of the face
};

/// Faces in the order -x, +x, -y, +y, -z, +z; in-plane axes are (axis + 1) % 3 and (axis + 2) % 3.
std::array<FaceCapture, 6> capture_faces(std::span<const ColouredTriangle> triangles, const vec3& half, std::uint32_t pixels);

}  // namespace surefoot::bake
