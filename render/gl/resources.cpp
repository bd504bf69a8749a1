// Uploading a model; the mapped buffers of a frame (resources.hpp).
#include "render/gl/resources.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "render/draw/texture_arrays.hpp"
#include "render/gl/undone.hpp"

namespace surefoot::gl {

namespace {

GLint mip_filter(bool trilinear) { return trilinear ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_NEAREST; }

/// By moment, and in it by vertex: its share and that of the next moment. A frame reads two bytes a vertex. Side by side with the
/// shares of all other moments, they would take a line of the cache for every four vertices.
std::vector<std::uint8_t> pairs_by_moment(std::span<const model::SunSeen> seen) {
    std::vector<std::uint8_t> pairs;
    pairs.reserve(2 * model::sun_moments * seen.size());
    for (std::uint32_t moment = 0; moment < model::sun_moments; ++moment)
        for (const model::SunSeen& vertex : seen) pairs.insert(pairs.end(), {vertex.share[moment], vertex.share[moment + 1]});
    return pairs;
}

/// Uploads an array of textures of equal size, levels and wrap.
Result<GLuint> upload_array(const Api& gl, const model::Model& model, const draw::TextureArray& array, bool trilinear) {
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(array.width, array.height) > static_cast<std::uint32_t>(largest)) {
        return Error{"texture of " + std::to_string(array.width) + " x " + std::to_string(array.height),
                     "The texture is larger than the device's limit", "Scale the image down to " + std::to_string(largest),
                     ErrorKind::out_of_limits};
    }
    GLuint id = 0;
    gl.GenTextures(1, &id);
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, id);
    const auto levels = static_cast<GLsizei>(array.levels);
    gl.TexStorage3D(GL_TEXTURE_2D_ARRAY, levels, GL_RGBA8, static_cast<GLsizei>(array.width), static_cast<GLsizei>(array.height),
                    static_cast<GLsizei>(array.layers.size()));
    for (std::size_t layer = 0; layer < array.layers.size(); ++layer) {
        std::uint64_t byte = model.textures[array.layers[layer]].first_byte;
        for (GLsizei level = 0; level < levels; ++level) {
            const std::uint32_t w = std::max(1U, array.width >> static_cast<unsigned>(level));
            const std::uint32_t h = std::max(1U, array.height >> static_cast<unsigned>(level));
            gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, static_cast<GLint>(layer), static_cast<GLsizei>(w),
                             static_cast<GLsizei>(h), 1, GL_RGBA, GL_UNSIGNED_BYTE, model.texels.data() + byte);
            byte += 4ULL * w * h;
        }
    }
    const GLint smaller = levels == 1 ? GL_LINEAR : mip_filter(trilinear);
    const GLint wrap = array.clamp ? GL_CLAMP_TO_EDGE : GL_REPEAT;
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, smaller);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, wrap);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, wrap);
    return id;
}

constexpr GLbitfield mapped_bits = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

/// A mapped buffer is unmapped as it is deleted.
void free_frame_buffers(const Api& gl, FrameBuffers& frame) {
    const std::array<GLuint, 2> buffers{frame.instance_buffer, frame.command_buffer};
    gl.DeleteBuffers(2, buffers.data());
}

template <class T>
Result<std::span<T>> make_mapped(const Api& gl, GLenum target, GLuint& buffer, std::uint32_t count) {
    void* memory = make_mapped_buffer(gl, target, buffer, static_cast<std::size_t>(count) * sizeof(T));
    if (memory == nullptr)
        return Error{"frame buffers", "The buffers cannot be mapped", "Lower max_items, or free memory", ErrorKind::no_memory};
    return std::span<T>(static_cast<T*>(memory), count);
}

GLuint make_static(const Api& gl, GLenum target, const void* data, std::size_t bytes) {
    GLuint buffer = 0;
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(target, buffer);
    const std::uint64_t nothing = 0;
    gl.BufferStorage(target, static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, sizeof nothing)), bytes == 0 ? &nothing : data,
                     0);
    return buffer;
}

}  // namespace

Result<void> check_errors(const Api& gl, const std::string& place, const std::string& remedy) {
    const GLenum error = take_errors(gl);
    if (error == GL_NO_ERROR) return {};
    if (error == GL_OUT_OF_MEMORY) return Error{place, "The device is out of memory", remedy, ErrorKind::no_memory};
    return Error{place, "The driver reports GL error " + std::to_string(error), remedy, ErrorKind::no_device};
}

void* make_mapped_buffer(const Api& gl, GLenum target, GLuint& buffer, std::size_t bytes) {
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(target, buffer);
    gl.BufferStorage(target, static_cast<GLsizeiptr>(bytes), nullptr, mapped_bits);
    void* memory = gl.MapBufferRange(target, 0, static_cast<GLsizeiptr>(bytes), mapped_bits);
    if (memory != nullptr) std::fill_n(static_cast<std::byte*>(memory), bytes, std::byte{0});
    return memory;
}

Result<FrameBuffers> make_frame_buffers(const Api& gl, std::uint32_t max_items) {
    Undone<FrameBuffers> made(gl, free_frame_buffers);
    FrameBuffers& buffers = made.value;
    auto instances = make_mapped<Instance>(gl, GL_ARRAY_BUFFER, buffers.instance_buffer, max_items);
    if (!instances) return instances.error();
    auto commands = make_mapped<DrawCommand>(gl, GL_DRAW_INDIRECT_BUFFER, buffers.command_buffer, max_items);
    if (!commands) return commands.error();
    buffers.instances = *instances;
    buffers.commands = *commands;
    return made.keep();
}

Result<Resources> load_resources(const Api& gl, const model::Model& model, std::span<const model::EffectMask> masks,
                                 const draw::TextureLayout& layout, const ProgramFactory& programs, const FrameBuffers& frame,
                                 const LoadOptions& options) {
    Undone<Resources> made(gl, free_resources);
    Resources& resources = made.value;
    gl.BindVertexArray(0);  // the index buffer's binding belongs to the vertex array
    resources.vertices = make_static(gl, GL_ARRAY_BUFFER, model.vertices.data(), model.vertices.size() * sizeof(model::Vertex));
    resources.indices = make_static(gl, GL_ARRAY_BUFFER, model.indices.data(), model.indices.size() * sizeof(std::uint32_t));
    resources.sun_vertices = model.sun_seen.size();
    if (!model.sun_seen.empty()) {
        const std::vector<std::uint8_t> pairs = pairs_by_moment(model.sun_seen);
        resources.sun_seen = make_static(gl, GL_ARRAY_BUFFER, pairs.data(), pairs.size());
    }
    if (!model.lamp_light.empty())
        resources.lamp_light =
            make_static(gl, GL_ARRAY_BUFFER, model.lamp_light.data(), model.lamp_light.size() * sizeof(model::LampLight));
    const std::string remedy = "Bake a smaller part: the model's geometry does not fit the device";
    if (auto fine = check_errors(gl, "uploading geometry", remedy); !fine) return fine.error();
    for (const draw::TextureArray& array : layout.arrays) {
        auto texture = upload_array(gl, model, array, options.trilinear);
        if (!texture) return texture.error();
        resources.textures.push_back(*texture);
    }
    const std::string smaller = "Scale the textures down: they do not fit the device";
    if (auto fine = check_errors(gl, "uploading textures", smaller); !fine) return fine.error();
    const GeometryBuffers buffers{resources.vertices, resources.indices,    frame.instance_buffer, frame.command_buffer,
                                  resources.sun_seen, resources.lamp_light, resources.sun_vertices};
    for (const model::EffectMask mask : masks) {
        auto program = make_program(gl, mask, programs(mask), options.samples, buffers);
        if (!program) return program.error();
        resources.programs.push_back(std::move(*program));
    }
    return made.keep();
}

void set_mip_levels(const Api& gl, const draw::TextureLayout& layout, const Resources& resources, bool two) {
    for (std::size_t i = 0; i < resources.textures.size(); ++i) {
        if (layout.arrays[i].levels < 2) continue;
        gl.BindTexture(GL_TEXTURE_2D_ARRAY, resources.textures[i]);
        gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, mip_filter(two));
    }
}

void set_mip_bias(const Api& gl, const draw::TextureLayout& layout, const Resources& resources, float levels) {
    for (std::size_t i = 0; i < resources.textures.size(); ++i) {
        if (layout.arrays[i].levels < 2) continue;
        gl.BindTexture(GL_TEXTURE_2D_ARRAY, resources.textures[i]);
        gl.TexParameterf(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_LOD_BIAS, levels);
    }
}

void free_resources(const Api& gl, Resources& resources) {
    for (Program& program : resources.programs) delete_program(gl, program);
    if (!resources.textures.empty())
        gl.DeleteTextures(static_cast<GLsizei>(resources.textures.size()), resources.textures.data());
    const std::array<GLuint, 4> buffers{resources.vertices, resources.indices, resources.sun_seen, resources.lamp_light};
    gl.DeleteBuffers(4, buffers.data());
    resources = {};
}

}  // namespace surefoot::gl
