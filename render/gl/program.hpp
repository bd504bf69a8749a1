// One compiled program of a state class, with the vertex array that enables exactly the attributes it reads.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/api.hpp"
#include "render/gl/device.hpp"
#include "render/model/daylight.hpp"

namespace surefoot::gl {

/// Data of one draw, fetched once an instance. std430-like, 64 bytes.
struct Instance {
    std::array<float, 12> rows;          ///< three rows of the eye-relative model matrix
    std::array<std::uint8_t, 4> colour;  ///< material colour
    float alpha_cutoff;
    float two_sided;  ///< 1: normals turn towards the eye
    float texture_layer;
};
static_assert(sizeof(Instance) == 64);

/// A uniform that a program reads, and its location.
struct BoundUniform {
    GLint location;
    UniformSource source;
};

/// A linked program for one set of effects, with the places of its uniforms.
struct Program {
    model::EffectMask mask = 0;
    ProgramSource source;
    GLuint id = 0, vertex_array = 0;
    GLint view_projection = -1;  ///< uniform location
    std::vector<BoundUniform> uniforms;
    std::uint64_t frame = 0;       ///< the frame whose uniforms it holds
    std::uint32_t attributes = 0;  ///< bit a location
    std::uint32_t sun_moment = 0;  ///< of SunSeen, from which its vertex array reads
    bool reads_sun_seen = false;   ///< it has to follow the moment
    bool coverage = false;         ///< its alpha says which samples of a pixel are drawn
};

/// Buffers that every vertex array reads.
struct GeometryBuffers {
    GLuint vertices = 0, indices = 0, instances = 0, commands = 0;
    GLuint sun_seen = 0, lamp_light = 0;  ///< 0: the model has none
    std::size_t sun_vertices = 0;         ///< sun_seen has so many pairs for each moment: of it and of the next one
};

/// Compiles and links; the error carries the compiler's message.
Result<GLuint> link_program(const Api& gl, const ProgramSource& source);
/// link_program(), and the vertex array. samples: pixels have several.
Result<Program> make_program(const Api& gl, model::EffectMask mask, ProgramSource source, bool samples,
                             const GeometryBuffers& buffers);
/// Sets the uniforms that it reads. It must be in use.
void write_uniforms(const Api& gl, const Program& program, const PictureMoment& moment);
/// Lets its vertex array, which must be bound, read the sun's visibility at this moment and the next.
void set_sun_moment(const Api& gl, Program& program, const GeometryBuffers& buffers, std::uint32_t moment);
void delete_program(const Api& gl, Program& program);

}  // namespace surefoot::gl
