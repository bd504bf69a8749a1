// Pictures of the image cache on meshes, in GL: a program that draws them opaque, and memory for a frame's corners. pictures.md
// has the reasons.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "render/gl/api.hpp"
#include "render/gl/device.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// A corner as a driver reads it.
struct MeshVertex {
    std::array<float, 3> place;  ///< relative to the eye of the frame
    std::array<float, 3> at;     ///< in texels of a layer; the layer
};
static_assert(sizeof(MeshVertex) == 24);

/// Objects of the meshes, made by load(). Program 0: there are none.
struct PictureMeshes {
    GLuint program = 0, vertex_array = 0, vertex_buffer = 0, index_buffer = 0;
    GLint view_projection = -1;  ///< uniform location
    std::span<MeshVertex> vertices;
    std::span<std::uint32_t> indices;  ///< both are mapped: written without a GL call
};

/// Makes all of it or nothing. The texture of the image cache is bound to its unit already.
Result<PictureMeshes> make_picture_meshes(const Api& gl, std::uint32_t triangles);
void free_picture_meshes(const Api& gl, PictureMeshes& meshes);

/// Copies a mesh for an eye. first: of its corners in the buffer.
void write_mesh(const PictureMesh& mesh, const dvec3& eye, std::uint32_t first, std::span<MeshVertex> vertices,
                std::span<std::uint32_t> indices);

}  // namespace surefoot::gl
