// What the image cache is studied on: scenes, trees and walks like those of Schaufler and Stuerzlinger 1996, section 5.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "render/cache/boxes.hpp"
#include "rt/base/named.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cache_study {

/// Colours of the corners of a triangle, sRGB-encoded.
using CornerColours = std::array<std::array<std::uint8_t, 3>, 3>;

/// A scene as triangles, its boxes, and the eye of each frame.
struct StudyScene {
    std::vector<cache::Triangle> triangles;
    std::vector<CornerColours> colours;  ///< one a triangle
    std::vector<std::uint32_t> objects;  ///< one a triangle: what it belongs to
    std::vector<bool> two_sided;         ///< one a triangle
    cache::BoxTree tree;
    std::vector<dvec3> eyes;          ///< evenly, on a straight way
    dvec3 forward{0, 0, -1};          ///< where all of them look, unit
    double walked_m = 0, step_m = 0;  ///< in all, and from a frame to the next
};

/// Names and help of the studies.
std::span<const Named> studies();

/// Frames that the paper shows of a study.
std::uint32_t usual_frames(std::string_view study);

/// The way is the same for any number of frames; its steps are not. frames: 1 or more. Error: unknown name.
Result<StudyScene> make_study(std::string_view study, std::uint32_t frames);

}  // namespace surefoot::cache_study
