// Making the targets, and enlarging (targets.hpp).
#include "render/gl/targets.hpp"

#include <string>

#include "render/gl/program.hpp"
#include "render/gl/undone.hpp"

namespace surefoot::gl {

namespace {

// One triangle that covers the target. The texture is as large as what was drawn, so clamping keeps edges clean.
constexpr const char* enlarge_vertex = R"(#version 430 core
out vec2 at;
void main() {
    vec2 corner = vec2(float((gl_VertexID & 1) * 4 - 1), float((gl_VertexID & 2) * 2 - 1));
    at = corner * 0.5 + 0.5;
    gl_Position = vec4(corner, 0.0, 1.0);
}
)";
// Nothing but the sample: llvmpipe has a fast path for this, and any arithmetic on the coordinates leaves it.
constexpr const char* enlarge_fragment = R"(#version 430 core
in vec2 at;
out vec4 colour;
uniform sampler2D picture;
void main() { colour = texture(picture, at); }
)";

}  // namespace

bool make_target(const Api& gl, model::Viewport size, GLuint depth, Target& target) {
    target.width = static_cast<GLsizei>(size.width);
    target.height = static_cast<GLsizei>(size.height);
    gl.GenTextures(1, &target.colour);
    gl.BindTexture(GL_TEXTURE_2D, target.colour);
    // The format and type of the (absent) pixels choose the channels' order.
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, target.width, target.height, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.GenFramebuffers(1, &target.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target.colour, 0);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void free_target(const Api& gl, Target& target) {
    gl.DeleteTextures(1, &target.colour);
    gl.DeleteFramebuffers(1, &target.framebuffer);
    target = {};
}

void free_targets(const Api& gl, Targets& targets) {
    for (Target& target : targets.steps) free_target(gl, target);
    gl.DeleteRenderbuffers(1, &targets.depth);
    gl.DeleteProgram(targets.program);
    gl.DeleteVertexArrays(1, &targets.vertex_array);
    targets = {};
}

Result<Targets> make_targets(const Api& gl, model::Viewport viewport) {
    Undone<Targets> made(gl, free_targets);
    Targets& targets = made.value;
    gl.GenRenderbuffers(1, &targets.depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, targets.depth);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, static_cast<GLsizei>(viewport.width),
                           static_cast<GLsizei>(viewport.height));
    for (std::size_t step = targets.steps.size(); step-- > 0;) {  // the shown one last: it stays bound
        if (make_target(gl, model::viewport_of_step(viewport, step), targets.depth, targets.steps[step])) continue;
        return Error{"frame of " + std::to_string(viewport.width) + " x " + std::to_string(viewport.height),
                     "The device cannot draw into this frame (RGBA8 with 32-bit float depth)", "Give a smaller --size",
                     ErrorKind::unsupported};
    }
    gl.BindTexture(GL_TEXTURE_2D, 0);
    auto program = link_program(gl, {enlarge_vertex, enlarge_fragment, "enlarging"});
    if (!program) return program.error();
    targets.program = *program;
    gl.UseProgram(targets.program);
    gl.Uniform1i(gl.GetUniformLocation(targets.program, "picture"), 0);
    gl.GenVertexArrays(1, &targets.vertex_array);
    return made.keep();
}

void enlarge(const Api& gl, const Targets& targets, std::size_t step) {
    const Target& shown = targets.steps.front();
    gl.BindFramebuffer(GL_FRAMEBUFFER, shown.framebuffer);
    gl.Viewport(0, 0, shown.width, shown.height);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_CULL_FACE);
    gl.UseProgram(targets.program);
    gl.BindVertexArray(targets.vertex_array);
    gl.BindTexture(GL_TEXTURE_2D, targets.steps[step].colour);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace surefoot::gl
