// Making the targets of a picture at rest, and its passes (rest_targets.hpp).
#include "render/gl/rest_targets.hpp"

#include "render/gl/program.hpp"

namespace surefoot::gl {

namespace {

// One triangle that covers the target.
constexpr const char* vertex = R"(#version 430 core
void main() { gl_Position = vec4(float((gl_VertexID & 1) * 4 - 1), float((gl_VertexID & 2) * 2 - 1), 0.0, 1.0); }
)";
constexpr const char* add_fragment = R"(#version 430 core
out vec4 colour;
uniform sampler2D picture;
void main() { colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
)";
constexpr const char* mean_fragment = R"(#version 430 core
out vec4 colour;
uniform sampler2D picture;
uniform int samples;
void main() { colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0) / float(samples); }
)";

bool make_sum(const Api& gl, const Target& shown, Target& sum) {
    sum.width = shown.width;
    sum.height = shown.height;
    gl.GenTextures(1, &sum.colour);
    gl.BindTexture(GL_TEXTURE_2D, sum.colour);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, sum.width, sum.height, 0, GL_RGBA, GL_FLOAT, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.GenFramebuffers(1, &sum.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, sum.framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, sum.colour, 0);
    return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

GLuint make_pass(const Api& gl, const char* fragment, const char* name) {
    auto program = link_program(gl, {vertex, fragment, name});
    if (!program) return 0;
    gl.UseProgram(*program);
    gl.Uniform1i(gl.GetUniformLocation(*program, "picture"), 0);
    return *program;
}

void free_sum(const Api& gl, RestTargets& rest) {
    free_target(gl, rest.sum);
    gl.DeleteProgram(rest.add);
    gl.DeleteProgram(rest.mean);
    gl.DeleteVertexArrays(1, &rest.vertex_array);
    rest.add = rest.mean = rest.vertex_array = 0;
}

void draw_pass(const Api& gl, const RestTargets& rest, GLuint program, const Target& from, const Target& to) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, to.framebuffer);
    gl.Viewport(0, 0, to.width, to.height);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_CULL_FACE);
    gl.UseProgram(program);
    gl.BindVertexArray(rest.vertex_array);
    gl.BindTexture(GL_TEXTURE_2D, from.colour);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace

RestTargets make_rest_targets(const Api& gl, const Targets& targets) {
    RestTargets rest;
    const Target& shown = targets.steps.front();
    const model::Viewport size{static_cast<std::uint32_t>(shown.width), static_cast<std::uint32_t>(shown.height)};
    if (!make_target(gl, size, targets.depth, rest.picture) || gl.GetError() != GL_NO_ERROR) {
        free_rest_targets(gl, rest);
    } else {
        bool made = make_sum(gl, shown, rest.sum);
        rest.add = make_pass(gl, add_fragment, "adding a sample");
        rest.mean = make_pass(gl, mean_fragment, "showing the mean of samples");
        rest.samples = gl.GetUniformLocation(rest.mean, "samples");
        gl.GenVertexArrays(1, &rest.vertex_array);
        made = made && rest.add != 0 && rest.mean != 0 && gl.GetError() == GL_NO_ERROR;
        if (!made) free_sum(gl, rest);
    }
    gl.BindTexture(GL_TEXTURE_2D, 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, shown.framebuffer);
    return rest;
}

void free_rest_targets(const Api& gl, RestTargets& rest) {
    free_sum(gl, rest);
    free_target(gl, rest.picture);
    rest = {};
}

void add_to_sum(const Api& gl, const RestTargets& rest, bool first) {
    if (first) {
        gl.Disable(GL_BLEND);
    } else {
        gl.Enable(GL_BLEND);
        gl.BlendFuncSeparate(GL_ONE, GL_ONE, GL_ONE, GL_ONE);
    }
    draw_pass(gl, rest, rest.add, rest.picture, rest.sum);
    gl.Disable(GL_BLEND);
}

void show_picture(const Api& gl, const RestTargets& rest, const Target& shown) {
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, rest.picture.framebuffer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, shown.framebuffer);
    gl.BlitFramebuffer(0, 0, shown.width, shown.height, 0, 0, shown.width, shown.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, shown.framebuffer);
}

void show_mean(const Api& gl, const RestTargets& rest, const Target& shown, std::uint32_t samples) {
    gl.UseProgram(rest.mean);
    gl.Uniform1i(rest.samples, static_cast<GLint>(samples));
    gl.Disable(GL_BLEND);
    draw_pass(gl, rest, rest.mean, rest.sum, shown);
}

}  // namespace surefoot::gl
