// Making targets with several samples a pixel, and resolving them (sample_targets.hpp).
#include "render/gl/sample_targets.hpp"

#include <algorithm>

namespace surefoot::gl {

namespace {

bool make_steps(const Api& gl, model::Viewport viewport, GLsizei samples, SampleTargets& targets) {
    const auto storage = [&](GLuint& buffer, GLenum format, model::Viewport size) {
        gl.GenRenderbuffers(1, &buffer);
        gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
        gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, static_cast<GLsizei>(size.width),
                                          static_cast<GLsizei>(size.height));
    };
    storage(targets.depth, GL_DEPTH_COMPONENT32F, viewport);
    for (std::size_t step = 0; step < targets.steps.size(); ++step) {
        Target& target = targets.steps[step];
        const model::Viewport size = model::viewport_of_step(viewport, step);
        target.width = static_cast<GLsizei>(size.width);
        target.height = static_cast<GLsizei>(size.height);
        storage(target.colour, GL_RGBA8, size);
        gl.GenFramebuffers(1, &target.framebuffer);
        gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.colour);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, targets.depth);
        if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return false;
    }
    GLint drawn = 0;  // of the last step's colours
    gl.GetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_SAMPLES, &drawn);
    targets.samples = static_cast<std::uint32_t>(std::max(1, drawn));
    return drawn > 1;
}

}  // namespace

SampleTargets make_sample_targets(const Api& gl, model::Viewport viewport, std::uint32_t samples) {
    SampleTargets targets;
    GLint max_samples = 0;
    if (samples > 1) gl.GetIntegerv(GL_MAX_SAMPLES, &max_samples);
    for (auto count = std::min(static_cast<GLint>(samples), max_samples); count > 1; count /= 2) {
        const bool made = make_steps(gl, viewport, count, targets);
        if (take_errors(gl) == GL_NO_ERROR && made) break;
        free_sample_targets(gl, targets);
    }
    return targets;
}

void free_sample_targets(const Api& gl, SampleTargets& targets) {
    for (const Target& target : targets.steps) {
        gl.DeleteFramebuffers(1, &target.framebuffer);
        gl.DeleteRenderbuffers(1, &target.colour);
    }
    gl.DeleteRenderbuffers(1, &targets.depth);
    targets = {};
}

void resolve_samples(const Api& gl, const Target& from, const Target& to) {
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, from.framebuffer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, to.framebuffer);
    gl.BlitFramebuffer(0, 0, to.width, to.height, 0, 0, to.width, to.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, to.framebuffer);
}

}  // namespace surefoot::gl
