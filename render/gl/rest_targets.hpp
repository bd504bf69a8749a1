// Targets of a picture at rest: a second picture, drawn beside the shown one, and the sum of its samples.
#pragma once

#include <cstdint>

#include "render/gl/api.hpp"
#include "render/gl/targets.hpp"

namespace surefoot::gl {

/// Zero names where the driver lacks a target. `picture` shares the depth buffer of the other targets: no frame is drawn between
/// the parts of a picture at rest.
struct RestTargets {
    Target picture;            ///< as the shown target
    Target sum;                ///< 32-bit floats: 64 samples of 8 bits add up exactly
    GLuint add = 0, mean = 0;  ///< programs
    GLint samples = -1;        ///< uniform of `mean`
    GLuint vertex_array = 0;
};

/// Makes what the driver can draw into: all, the picture alone, or nothing. Leaves the shown target bound.
RestTargets make_rest_targets(const Api& gl, const Targets& targets);
void free_rest_targets(const Api& gl, RestTargets& rest);

/// Adds the second picture to the sum; the first one replaces it.
void add_to_sum(const Api& gl, const RestTargets& rest, bool first);
/// The shown target becomes the second picture, to the bit.
void show_picture(const Api& gl, const RestTargets& rest, const Target& shown);
/// The shown target becomes the sum divided by the number of samples.
void show_mean(const Api& gl, const RestTargets& rest, const Target& shown, std::uint32_t samples);

}  // namespace surefoot::gl
