// GL objects of a loaded model: buffers, textures, programs; and a frame's buffers. Made at load, freed together.
// Each function makes all of it or nothing: if a step fails, what the earlier steps made is freed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/draw/texture_arrays.hpp"
#include "render/gl/api.hpp"
#include "render/gl/program.hpp"
#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// As glMultiDrawElementsIndirect reads it.
struct DrawCommand {
    std::uint32_t index_count, instances, first_index;
    std::int32_t base_vertex;
    std::uint32_t first_instance;
};
static_assert(sizeof(DrawCommand) == 20);

/// Makes a buffer of this size that is mapped for its life, and touches every page of it. Null: it cannot be mapped.
void* make_mapped_buffer(const Api& gl, GLenum target, GLuint& buffer, std::size_t bytes);

/// Instance and command buffers, mapped for the device's life, so that the frame writes them without a GL call.
struct FrameBuffers {
    GLuint instance_buffer = 0, command_buffer = 0;
    std::span<Instance> instances;
    std::span<DrawCommand> commands;
};
Result<FrameBuffers> make_frame_buffers(const Api& gl, std::uint32_t max_items);

/// Buffers and textures of one model in the GL context.
struct Resources {
    GLuint vertices = 0, indices = 0;
    GLuint sun_seen = 0, lamp_light = 0;  ///< 0: the model has none
    std::size_t sun_vertices = 0;         ///< that sun_seen has a pair of, for each moment
    std::vector<GLuint> textures;         ///< in the order of TextureLayout::arrays
    std::vector<Program> programs;        ///< in the order of DrawTables::masks, then their variants without switched effects
};
/// How everything is drawn. trilinear: else from the nearest mip level. samples: pixels have several.
struct LoadOptions {
    bool trilinear = false, samples = false;
};
Result<Resources> load_resources(const Api& gl, const model::Model& model, std::span<const model::EffectMask> masks,
                                 const draw::TextureLayout& layout, const ProgramFactory& programs, const FrameBuffers& frame,
                                 const LoadOptions& options);
void free_resources(const Api& gl, Resources& resources);
/// Textures are read from their two nearest mip levels, or from the nearest one. Leaves another texture bound.
void set_mip_levels(const Api& gl, const draw::TextureLayout& layout, const Resources& resources, bool two);
/// Mip levels are chosen as for a picture of 2^-levels times the size. Leaves another texture bound.
void set_mip_bias(const Api& gl, const draw::TextureLayout& layout, const Resources& resources, float levels);

/// An Error naming `place` if GL has recorded an error since the last check.
Result<void> check_errors(const Api& gl, const std::string& place, const std::string& remedy);

}  // namespace surefoot::gl
