// Targets of a frame: the shown picture, a smaller one for each step of resolution, and the pass that enlarges a smaller one.
#pragma once

#include <array>

#include "render/gl/api.hpp"
#include "render/model/resolution.hpp"
#include "render/model/view.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// A colour texture with a framebuffer. 8 bits a channel in the order B, G, R, A: llvmpipe copies and enlarges this order
/// fastest.
struct Target {
    GLuint framebuffer = 0, colour = 0;
    GLsizei width = 0, height = 0;
};

/// All targets of a device. They share one 32-bit float depth buffer of the full size.
struct Targets {
    std::array<Target, model::resolution_steps.size()> steps;  ///< in the order of resolution_steps: the first is the shown one
    GLuint depth = 0;
    GLuint program = 0, vertex_array = 0;  ///< of the enlarging pass
};

/// Makes a colour texture of this size with the depth buffer, and binds it. False: the driver cannot draw into it.
bool make_target(const Api& gl, model::Viewport size, GLuint depth, Target& target);
void free_target(const Api& gl, Target& target);

/// Makes all of it or nothing. The shown target is bound for drawing.
Result<Targets> make_targets(const Api& gl, model::Viewport viewport);
void free_targets(const Api& gl, Targets& targets);

/// Enlarges the picture of a step into the shown target: bilinear, pixel centres in their places, edges from inside the picture.
/// Leaves the shown target bound, and depth test and culling off.
void enlarge(const Api& gl, const Targets& targets, std::size_t step);

}  // namespace surefoot::gl
