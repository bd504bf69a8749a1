// Uploading a model; the frame's target and mapped buffers (resources.hpp).
#include "render/gl/resources.hpp"

#include <algorithm>
#include <string>

#include "render/gl/texture_upload.hpp"

namespace surefoot::gl {

namespace {

constexpr GLbitfield mapped_bits = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

template <class T>
Result<std::span<T>> make_mapped(const Api& gl, GLenum target, GLuint& buffer, std::uint32_t count) {
    const auto bytes = static_cast<GLsizeiptr>(static_cast<std::size_t>(count) * sizeof(T));
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(target, buffer);
    gl.BufferStorage(target, bytes, nullptr, mapped_bits);
    void* memory = gl.MapBufferRange(target, 0, bytes, mapped_bits);
    if (memory == nullptr)
        return Error{"frame buffers", "The buffers cannot be mapped", "Lower max_items, or free memory", ErrorKind::no_memory};
    std::fill_n(static_cast<std::byte*>(memory), static_cast<std::size_t>(bytes), std::byte{0});  // touch every page now
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
    const GLenum error = gl.GetError();
    if (error == GL_NO_ERROR) return {};
    while (gl.GetError() != GL_NO_ERROR) {
    }
    if (error == GL_OUT_OF_MEMORY) return Error{place, "The device is out of memory", remedy, ErrorKind::no_memory};
    return Error{place, "The driver reports GL error " + std::to_string(error), remedy, ErrorKind::no_device};
}

Result<Target> make_target(const Api& gl, model::Viewport viewport) {
    Target target;
    const auto w = static_cast<GLsizei>(viewport.width);
    const auto h = static_cast<GLsizei>(viewport.height);
    gl.GenFramebuffers(1, &target.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    gl.GenRenderbuffers(1, &target.colour);
    gl.BindRenderbuffer(GL_RENDERBUFFER, target.colour);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, w, h);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.colour);
    gl.GenRenderbuffers(1, &target.depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, target.depth);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, w, h);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        return Error{"frame of " + std::to_string(viewport.width) + " x " + std::to_string(viewport.height),
                     "The device cannot draw into this frame (RGBA8 with 32-bit float depth)", "Give a smaller --size",
                     ErrorKind::unsupported};
    }
    return target;
}

Result<FrameBuffers> make_frame_buffers(const Api& gl, std::uint32_t max_items) {
    FrameBuffers buffers;
    auto instances = make_mapped<Instance>(gl, GL_ARRAY_BUFFER, buffers.instance_buffer, max_items);
    if (!instances) return instances.error();
    auto commands = make_mapped<DrawCommand>(gl, GL_DRAW_INDIRECT_BUFFER, buffers.command_buffer, max_items);
    if (!commands) return commands.error();
    buffers.instances = *instances;
    buffers.commands = *commands;
    return buffers;
}

Result<Resources> load_resources(const Api& gl, const model::Model& model, std::span<const model::EffectMask> masks,
                                 const draw::TextureLayout& layout, const ProgramFactory& programs, const FrameBuffers& frame,
                                 bool soft) {
    Resources resources;
    gl.BindVertexArray(0);  // the index buffer's binding belongs to the vertex array
    resources.vertices = make_static(gl, GL_ARRAY_BUFFER, model.vertices.data(), model.vertices.size() * sizeof(model::Vertex));
    resources.indices = make_static(gl, GL_ARRAY_BUFFER, model.indices.data(), model.indices.size() * sizeof(std::uint32_t));
    const std::string remedy = "Bake a smaller part: the model's geometry does not fit the device";
    if (auto fine = check_errors(gl, "uploading geometry", remedy); !fine) return fine.error();
    for (const draw::TextureArray& array : layout.arrays) {
        auto made = upload_array(gl, model, array, soft);
        if (!made) return made.error();
        resources.textures.push_back(*made);
    }
    const std::string smaller = "Scale the textures down: they do not fit the device";
    if (auto fine = check_errors(gl, "uploading textures", smaller); !fine) return fine.error();
    const GeometryBuffers buffers{resources.vertices, resources.indices, frame.instance_buffer, frame.command_buffer};
    for (const model::EffectMask mask : masks) {
        auto program = make_program(gl, mask, programs(mask), buffers);
        if (!program) return program.error();
        resources.programs.push_back(std::move(*program));
    }
    return resources;
}

void free_resources(const Api& gl, Resources& resources) {
    for (Program& program : resources.programs) delete_program(gl, program);
    if (!resources.textures.empty())
        gl.DeleteTextures(static_cast<GLsizei>(resources.textures.size()), resources.textures.data());
    const std::array<GLuint, 2> buffers{resources.vertices, resources.indices};
    gl.DeleteBuffers(2, buffers.data());
    resources = {};
}

}  // namespace surefoot::gl
