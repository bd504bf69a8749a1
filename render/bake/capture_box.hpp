// Faces of box impostors: each is a picture of full detail, seen along its axis without perspective (Maciel 1994, 3.4.2, 3.6).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/bake/form_picture.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::bake {

/// The light of a face: all but lamps, and lamps at the corners of shown_texels(), as PictureLight has them. Corners: low, high
/// along the first in-plane axis, then the same at the high end of the second.
struct FaceLight {
    effects::PictureLight of_all{};
    std::array<std::array<std::uint8_t, 3>, 4> lamps{};
};

/// One face, as an orthographic camera on its axis sees the near half of the box. Row 0 lies at the low end of the second
/// in-plane axis, column 0 at the low end of the first. They are (axis + 1) % 3 and (axis + 2) % 3.
struct FaceCapture {
    std::vector<std::uint8_t> rgba;  ///< pixels x pixels, lit. As many texels are opaque (alpha >= opaque_alpha) as are covered.
    std::array<std::uint8_t, 4> mean{};  ///< of what is covered
    float depth_m = 0;                   ///< the deepest captured point behind the face
    float covered = 0;                   ///< share of the face; 0: it has no opaque texel
    bool whole = true;                   ///< false: the face is too long for the picture that it was captured from
    FaceLight light{};                   ///< of BoxForm::lit boxes: what rgba was divided by in the model's own light
};
constexpr std::uint8_t opaque_alpha = 128;

/// The texels of a face that show something: first column and row, and those after the last.
std::array<std::uint32_t, 4> shown_texels(const FaceCapture& face, std::uint32_t pixels);

/// Faces in the order -x, +x, -y, +y, -z, +z.
constexpr std::uint32_t box_faces = 6;
/// Where a face is seen from.
Direction direction_of_face(std::uint32_t face);

/// A sample that a face shows, and in which of its texels.
struct FaceSample {
    std::uint32_t sample = 0, texel = 0;
};

/// seen: full detail from direction_of_face(face), of about 2 * pixels samples across. The far half is left to the opposite face,
/// which shows it through this one's holes. That halves the parallax. shown: takes the samples.
FaceCapture capture_face(const FormPicture& seen, const Box& box, std::uint32_t face, std::uint32_t pixels,
                         std::vector<FaceSample>* shown = nullptr);

}  // namespace surefoot::bake
