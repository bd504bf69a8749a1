// Targets with several samples a pixel, one a step of resolution, and the pass that makes a shown picture of them.
#pragma once

#include <array>
#include <cstdint>

#include "render/gl/api.hpp"
#include "render/gl/targets.hpp"

namespace surefoot::gl {

/// Target::colour names a renderbuffer here. All share one 32-bit float depth buffer of the full size.
struct SampleTargets {
    std::array<Target, model::resolution_steps.size()> steps;  ///< in the order of resolution_steps
    GLuint depth = 0;
    std::uint32_t samples = 1;  ///< of a pixel; 1: there are no such targets
};

/// Makes targets with `samples` a pixel, or with what the driver has: drivers round up to a number of theirs. Without any, or
/// where memory ends, fewer samples; then none, and the frame is drawn without. Leaves no GL error.
SampleTargets make_sample_targets(const Api& gl, model::Viewport viewport, std::uint32_t samples);
void free_sample_targets(const Api& gl, SampleTargets& targets);

/// Each pixel of `to` becomes the mean of its samples. Both have one size. Leaves `to` bound.
void resolve_samples(const Api& gl, const Target& from, const Target& to);

}  // namespace surefoot::gl
