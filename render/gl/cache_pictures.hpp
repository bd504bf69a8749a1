// The image cache's pictures in GL: a texture array with a framebuffer a layer, and what draws pictures into a frame.
// Source: Schaufler and Stuerzlinger 1996, with faces of boxes in place of squares: README.md has the reasons.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/api.hpp"
#include "render/gl/picture_faces.hpp"
#include "render/gl/program.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// Objects of the pictures, made by load(). Without framebuffers there is no picture.
struct CachePictures {
    GLuint texture = 0, depth = 0;
    std::vector<GLuint> framebuffers;             ///< one a layer; they share the depth buffer
    GLuint scratch = 0, scratch_framebuffer = 0;  ///< of a layer's size: what is made of pictures is drawn here, then copied
    GLuint program = 0, vertex_array = 0, vertex_buffer = 0;
    GLint view_projection = -1;         ///< uniform location
    std::span<PictureVertex> vertices;  ///< mapped: written without a GL call
};

/// Makes all of it or nothing. The texture is bound to its unit; unit 0 is the active one after it.
Result<CachePictures> make_cache_pictures(const Api& gl, std::uint32_t layers);
void free_cache_pictures(const Api& gl, CachePictures& pictures);

/// The program of a state class that draws captures: it cuts off what is outside of PictureMoment::box_low to box_high.
ProgramSource capture_source(ProgramSource source);

}  // namespace surefoot::gl
