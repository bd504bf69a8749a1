// The best picture that a box could get now, for an eye on its way. It is seen from a place ahead, so that it serves before and
// after.
#pragma once

#include <optional>

#include "render/cache/validity.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::cache {

/// Where the eye is, and where it goes.
struct EyeCourse {
    dvec3 eye{0.0};
    dvec3 step_m{0.0};    ///< in a frame
    double radius_m = 0;  ///< by which eyes may miss their course
    double max_frames = 90;
};

/// A picture that is not made yet.
struct Prospect {
    Picture picture;         ///< of the grown box
    Box box;                 ///< grown by an angle of max_rad at its far depth: neighbours may err by a pixel each
    double grown_m = 0;      ///< at each face
    double life_frames = 0;  ///< from now on, on the course; at most EyeCourse::max_frames
};

/// The window of a picture leaves a texel free at each rim, since the outermost half texel of a slot is not sampled.
/// max_rad: of error and texels. Nothing where no picture of 64, 128 or 256 texels is fine enough, or none is valid now.
std::optional<Prospect> prospect_of(const Box& box, const EyeCourse& course, double max_rad);

/// By how much a prospect's box is grown at each face: an angle of max_rad at its far depth.
double grown_for(const Box& box, const dvec3& eye, double max_rad);

/// How many frames on the course a picture stays valid: 0 to max_frames. Below 0: it is not valid now.
double life_of(const Picture& picture, const EyeCourse& course, double max_rad);

}  // namespace surefoot::cache
