// Pictures on meshes: their objects, the depths of captures, and drawing (picture_meshes.hpp, gl_device.hpp).
#include "render/gl/picture_meshes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "render/gl/gl_device.hpp"
#include "render/gl/resources.hpp"
#include "render/gl/undone.hpp"

namespace surefoot::gl {

namespace {

constexpr std::uint32_t corners_of_triangle = 3;

constexpr const char* mesh_vertex = R"(#version 430 core
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 at;
uniform mat4 view_projection;
out vec2 v_at;
flat out float v_layer;
void main() {
    v_at = at.xy;
    v_layer = at.z;
    gl_Position = view_projection * vec4(place, 1);
}
)";
// The texel itself: beside covered texels there may be empty ones, and what is drawn here is opaque. At the very edge of a mesh
// rounding may lead out of it: the second texel is not empty then.
constexpr const char* mesh_fragment = R"(#version 430 core
in vec2 v_at;
flat in float v_layer;
out vec4 pixel;
uniform sampler2DArray pictures;
void main() {
    vec4 one = texelFetch(pictures, ivec3(v_at + 0.004, v_layer), 0);
    vec4 other = texelFetch(pictures, ivec3(v_at - 0.004, v_layer), 0);
    pixel = vec4(one.a > 0.0 ? one.rgb : other.rgb, 1);
}
)";

Error no_meshes(std::string what) {
    return {"image cache", std::move(what), "Set fewer mesh_triangles, or 0", ErrorKind::unsupported};
}

/// The triangle that load() draws.
constexpr std::array<std::uint16_t, corners_of_triangle> one_triangle = {0, 1, 2};

}  // namespace

Result<PictureMeshes> make_picture_meshes(const Api& gl, std::uint32_t triangles) {
    Undone<PictureMeshes> made(gl, free_picture_meshes);
    PictureMeshes& meshes = made.value;
    auto program = link_program(gl, {mesh_vertex, mesh_fragment, "meshes of the image cache"});
    if (!program) return program.error();
    meshes.program = *program;
    meshes.view_projection = gl.GetUniformLocation(meshes.program, "view_projection");
    gl.UseProgram(meshes.program);
    gl.Uniform1i(gl.GetUniformLocation(meshes.program, "pictures"), picture_unit);
    gl.GenVertexArrays(1, &meshes.vertex_array);
    gl.BindVertexArray(meshes.vertex_array);
    const std::size_t count = std::size_t{corners_of_triangle} * triangles;
    void* vertices = make_mapped_buffer(gl, GL_ARRAY_BUFFER, meshes.vertex_buffer, count * sizeof(MeshVertex));
    void* indices = make_mapped_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, meshes.index_buffer, count * sizeof(std::uint32_t));
    if (vertices == nullptr || indices == nullptr) return no_meshes("The device cannot map the corners of meshes");
    meshes.vertices = {static_cast<MeshVertex*>(vertices), count};
    meshes.indices = {static_cast<std::uint32_t*>(indices), count};
    gl.BindVertexBuffer(0, meshes.vertex_buffer, 0, sizeof(MeshVertex));
    gl.VertexAttribFormat(0, 3, GL_FLOAT, GL_FALSE, offsetof(MeshVertex, place));
    gl.VertexAttribFormat(1, 3, GL_FLOAT, GL_FALSE, offsetof(MeshVertex, at));
    for (const GLuint attribute : {0U, 1U}) {
        gl.VertexAttribBinding(attribute, 0);
        gl.EnableVertexAttribArray(attribute);
    }
    gl.BindVertexArray(0);
    if (auto fine = check_errors(gl, "image cache", "Set fewer mesh_triangles, or 0"); !fine) return fine.error();
    return made.keep();
}

void free_picture_meshes(const Api& gl, PictureMeshes& meshes) {
    gl.DeleteProgram(meshes.program);
    gl.DeleteVertexArrays(1, &meshes.vertex_array);
    gl.DeleteBuffers(1, &meshes.vertex_buffer);
    gl.DeleteBuffers(1, &meshes.index_buffer);
    meshes = {};
}

void write_mesh(const PictureMesh& mesh, const dvec3& eye, std::uint32_t first, std::span<MeshVertex> vertices,
                std::span<std::uint32_t> indices) {
    const vec3 from_eye(mesh.eye - eye);
    const vec2 low(mesh.place.column, mesh.place.row);
    const auto layer = static_cast<float>(mesh.place.layer);
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
        const vec3 place = mesh.corners[i].place + from_eye;
        const vec2 at = mesh.corners[i].at + low;
        vertices[i] = {{place.x, place.y, place.z}, {at.x, at.y, layer}};
    }
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) indices[i] = first + mesh.indices[i];
}

void GlDevice::load_meshes() {
    free_picture_meshes(gl_, meshes_);
    if (options_.mesh_triangles == 0 || pictures_.framebuffers.empty()) return;
    auto made = make_picture_meshes(gl_, options_.mesh_triangles);
    if (made) {
        meshes_ = *made;
    } else {
        picture_reason_ = made.error().text();
        take_errors(gl_);
    }
}

bool GlDevice::capture_depths(const CachePicture& picture, std::span<const DrawItem> items, std::span<float> depths) {
    if (depths.size() < std::size_t{picture.place.texels} * picture.place.texels) return false;
    if (!capture_picture(picture, items, {})) return false;
    captures_[capture_count_ - 1].depths = depths;
    return true;
}

/// Of the capture that was just drawn.
void GlDevice::read_depths(const PicturePlace& place, std::span<float> to) {
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl_.ReadPixels(place.column, place.row, place.texels, place.texels, GL_DEPTH_COMPONENT, GL_FLOAT, to.data());
}

void GlDevice::draw_picture_meshes(std::span<const PictureMesh> meshes) {
    if (lost_ || meshes_.program == 0 || meshes.empty()) return;
    gl_.UseProgram(meshes_.program);
    gl_.BindVertexArray(meshes_.vertex_array);
    gl_.UniformMatrix4fv(meshes_.view_projection, 1, GL_FALSE, &view_projection_[0][0]);
    if (samples_.samples > 1) set_coverage(false);
    gl_.Disable(GL_CULL_FACE);
    std::size_t first = used_mesh_indices_;
    for (const PictureMesh& mesh : meshes) {
        const std::size_t corners = mesh.corners.size(), indices = mesh.indices.size();
        if (!lies_within(mesh.place, picture_layers()) || indices == 0) continue;
        if (corners > meshes_.vertices.size() || indices > meshes_.indices.size()) continue;
        if (used_mesh_corners_ + corners > meshes_.vertices.size() || used_mesh_indices_ + indices > meshes_.indices.size()) {
            issue_meshes(first);  // correct, if slow
            gl_.Finish();
            used_mesh_corners_ = used_mesh_indices_ = first = 0;
        }
        write_mesh(mesh, pose_.position, static_cast<std::uint32_t>(used_mesh_corners_),
                   meshes_.vertices.subspan(used_mesh_corners_, corners), meshes_.indices.subspan(used_mesh_indices_, indices));
        used_mesh_corners_ += corners;
        used_mesh_indices_ += indices;
        ++stats_.meshes;
        stats_.triangles += indices / corners_of_triangle;
    }
    issue_meshes(first);
    state_known_ = false;
}

void GlDevice::issue_meshes(std::size_t first) {
    if (used_mesh_indices_ == first) return;
    ++stats_.batches;
    ++stats_.draws;
    // The API takes an offset in a buffer as a pointer.  NOLINTNEXTLINE(performance-no-int-to-ptr)
    const auto offset = reinterpret_cast<const void*>(static_cast<std::uintptr_t>(first) * sizeof(std::uint32_t));
    gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(used_mesh_indices_ - first), GL_UNSIGNED_INT, offset);
}

/// Into every target.
void GlDevice::warm_up_meshes(const CachePicture& picture) {
    if (meshes_.program == 0) return;
    const std::array<MeshCorner, corners_of_triangle> corners = {
        MeshCorner{vec3(0, 0, -1), vec2(0)}, MeshCorner{vec3(1, 0, -1), vec2(1)}, MeshCorner{vec3(0, 1, -1), vec2(1)}};
    const PictureMesh mesh{picture.place, picture.eye, corners, one_triangle};
    draw_picture_meshes({&mesh, 1});
}

}  // namespace surefoot::gl
