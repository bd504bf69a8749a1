// One compiled program of a state class, with the vertex array that enables exactly the attributes it reads.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "render/gl/api.hpp"
#include "render/gl/device.hpp"

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

/// A linked program for one set of effects, with the places of its uniforms.
struct Program {
    model::EffectMask mask = 0;
    ProgramSource source;
    GLuint id = 0, vertex_array = 0;
    GLint view_projection = -1, sun_direction = -1;  ///< uniform locations, -1: not used
    std::uint64_t frame = 0;                         ///< the frame whose uniforms it holds
    std::uint32_t attributes = 0;                    ///< bit a location
    bool coverage = false;                           ///< its alpha says which samples of a pixel are drawn
};

/// Buffers that every vertex array reads.
struct GeometryBuffers {
    GLuint vertices = 0, indices = 0, instances = 0, commands = 0;
};

/// Compiles and links; the error carries the compiler's message.
Result<GLuint> link_program(const Api& gl, const ProgramSource& source);
/// link_program(), and the vertex array. samples: pixels have several.
Result<Program> make_program(const Api& gl, model::EffectMask mask, ProgramSource source, bool samples,
                             const GeometryBuffers& buffers);
void delete_program(const Api& gl, Program& program);

}  // namespace surefoot::gl
