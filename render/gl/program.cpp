// Compiling programs and binding their attributes (program.hpp).
#include "render/gl/program.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "render/model/model.hpp"

namespace surefoot::gl {

namespace {

constexpr GLuint vertex_binding = 0;
constexpr GLuint instance_binding = 1;
constexpr GLuint sun_seen_binding = 2;
constexpr GLuint lamp_binding = 3;
constexpr std::size_t sun_pair_bytes = 2;

/// An attribute that a program may read: GLSL name (without array index), place and form in its buffer.
struct Attribute {
    const char* name;
    GLuint binding;
    GLint components;
    GLenum type;
    GLboolean normalised;
    std::size_t offset;
    int locations;  ///< an array takes several
};

constexpr std::array<Attribute, 13> attributes{{
    {"position", vertex_binding, 3, GL_FLOAT, GL_FALSE, offsetof(model::Vertex, position), 1},
    {"normal", vertex_binding, 3, GL_BYTE, GL_TRUE, offsetof(model::Vertex, normal), 1},
    {"vertex_colour", vertex_binding, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(model::Vertex, colour), 1},
    {"uv", vertex_binding, 2, GL_FLOAT, GL_FALSE, offsetof(model::Vertex, uv), 1},
    {"hidden", vertex_binding, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(model::Vertex, hidden), 1},
    {"sun_seen", sun_seen_binding, 2, GL_UNSIGNED_BYTE, GL_TRUE, 0, 1},
    {"lamps_before", lamp_binding, 3, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(model::LampLight, before), 1},
    {"lamps_behind", lamp_binding, 3, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(model::LampLight, behind), 1},
    {"world_rows", instance_binding, 4, GL_FLOAT, GL_FALSE, offsetof(Instance, rows), 3},
    {"material_colour", instance_binding, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Instance, colour), 1},
    {"alpha_cutoff", instance_binding, 1, GL_FLOAT, GL_FALSE, offsetof(Instance, alpha_cutoff), 1},
    {"two_sided", instance_binding, 1, GL_FLOAT, GL_FALSE, offsetof(Instance, two_sided), 1},
    {"texture_layer", instance_binding, 1, GL_FLOAT, GL_FALSE, offsetof(Instance, texture_layer), 1},
}};

/// A shader object, deleted where it goes out of scope: a program that it is attached to keeps it as long as it needs it.
class Shader {
public:
    Shader(const Api& gl, GLenum kind) : gl_(gl), id_(gl.CreateShader(kind)) {}
    ~Shader() { gl_.DeleteShader(id_); }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    [[nodiscard]] GLuint id() const { return id_; }

private:
    const Api& gl_;
    GLuint id_;
};

Result<void> compile(const Api& gl, const Shader& shader, const std::string& text, const std::string& place) {
    const char* source = text.c_str();
    gl.ShaderSource(shader.id(), 1, &source, nullptr);
    gl.CompileShader(shader.id());
    GLint ok = GL_FALSE;
    gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &ok);
    if (ok == GL_TRUE) return {};
    std::string log(2048, ' ');
    GLsizei length = 0;
    gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return Error{place, "The shader does not compile: " + log, "Report this together with the driver's version",
                 ErrorKind::unsupported};
}

void make_vertex_array(const Api& gl, Program& program, const GeometryBuffers& buffers) {
    gl.GenVertexArrays(1, &program.vertex_array);
    gl.BindVertexArray(program.vertex_array);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers.indices);
    gl.BindVertexBuffer(vertex_binding, buffers.vertices, 0, sizeof(model::Vertex));
    gl.BindVertexBuffer(instance_binding, buffers.instances, 0, sizeof(Instance));
    gl.VertexBindingDivisor(instance_binding, 1);
    if (buffers.sun_seen != 0) gl.BindVertexBuffer(sun_seen_binding, buffers.sun_seen, 0, GLsizei{sun_pair_bytes});
    if (buffers.lamp_light != 0) gl.BindVertexBuffer(lamp_binding, buffers.lamp_light, 0, sizeof(model::LampLight));
    for (const Attribute& a : attributes) {
        const GLint first = gl.GetAttribLocation(program.id, a.name);
        if (first < 0) continue;
        if (a.binding == lamp_binding && buffers.lamp_light == 0) continue;  // pictures without lamps read zeros
        for (int i = 0; i < a.locations; ++i) {
            const auto location = static_cast<GLuint>(first + i);
            const auto offset = static_cast<GLuint>(a.offset + static_cast<std::size_t>(i) * 4 * sizeof(float));
            gl.VertexAttribFormat(location, a.components, a.type, a.normalised, offset);
            gl.VertexAttribBinding(location, a.binding);
            gl.EnableVertexAttribArray(location);
            program.attributes |= 1U << location;
        }
    }
    gl.BindVertexArray(0);
}

}  // namespace

Result<GLuint> link_program(const Api& gl, const ProgramSource& source) {
    const std::string place = "program '" + source.name + "'";
    const Shader vertex(gl, GL_VERTEX_SHADER), fragment(gl, GL_FRAGMENT_SHADER);
    if (auto ok = compile(gl, vertex, source.vertex, place); !ok) return ok.error();
    if (auto ok = compile(gl, fragment, source.fragment, place); !ok) return ok.error();
    const GLuint id = gl.CreateProgram();
    gl.AttachShader(id, vertex.id());
    gl.AttachShader(id, fragment.id());
    gl.LinkProgram(id);
    GLint ok = GL_FALSE;
    gl.GetProgramiv(id, GL_LINK_STATUS, &ok);
    if (ok == GL_TRUE) return id;
    std::string log(2048, ' ');
    GLsizei length = 0;
    gl.GetProgramInfoLog(id, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    gl.DeleteProgram(id);
    return Error{place, "The program does not link: " + log, "Report this together with the driver's version",
                 ErrorKind::unsupported};
}

Result<Program> make_program(const Api& gl, model::EffectMask mask, ProgramSource source, bool samples,
                             const GeometryBuffers& buffers) {
    Program program;
    program.mask = mask;
    program.coverage = samples && !source.fragment_samples.empty();
    if (program.coverage) source.fragment = source.fragment_samples;
    auto id = link_program(gl, source);
    if (!id) return id.error();
    program.source = std::move(source);
    program.id = *id;
    program.view_projection = gl.GetUniformLocation(program.id, "view_projection");
    for (const UniformSource& uniform : program.source.uniforms) {
        const GLint location = gl.GetUniformLocation(program.id, uniform.name);
        if (location >= 0) program.uniforms.push_back({location, uniform});
    }
    program.reads_sun_seen = gl.GetAttribLocation(program.id, "sun_seen") >= 0;
    for (const SamplerSource& sampler : program.source.samplers) {
        const GLint location = gl.GetUniformLocation(program.id, sampler.name);
        if (location < 0) continue;
        gl.UseProgram(program.id);
        gl.Uniform1i(location, sampler.unit);
    }
    make_vertex_array(gl, program, buffers);
    return program;
}

void write_uniforms(const Api& gl, const Program& program, const PictureMoment& moment) {
    for (const BoundUniform& uniform : program.uniforms) {
        std::array<float, 16> value{};
        uniform.source.write(moment, value.data());
        switch (uniform.source.components) {
            case 1:
                gl.Uniform1f(uniform.location, value[0]);
                break;
            case 3:
                gl.Uniform3f(uniform.location, value[0], value[1], value[2]);
                break;
            default:
                gl.UniformMatrix4fv(uniform.location, 1, GL_FALSE, value.data());
        }
    }
}

void set_sun_moment(const Api& gl, Program& program, const GeometryBuffers& buffers, std::uint32_t moment) {
    moment = std::min(moment, model::sun_moments - 1);  // and the one after it
    if (program.sun_moment == moment || buffers.sun_seen == 0) return;
    const std::size_t first_byte = moment * sun_pair_bytes * buffers.sun_vertices;
    gl.BindVertexBuffer(sun_seen_binding, buffers.sun_seen, static_cast<GLintptr>(first_byte), GLsizei{sun_pair_bytes});
    program.sun_moment = moment;
}

void delete_program(const Api& gl, Program& program) {
    gl.DeleteProgram(program.id);
    gl.DeleteVertexArrays(1, &program.vertex_array);
    program.id = 0;
    program.vertex_array = 0;
}

}  // namespace surefoot::gl
