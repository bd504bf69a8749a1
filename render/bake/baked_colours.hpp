// Vertex colours that replace textures in coarse levels: at a vertex, the mean texture colour near it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/import/scene.hpp"

namespace surefoot::bake {

/// One colour for each vertex of the primitive. `vertices`: the same vertices in the model's layout. Of an opaque
/// texture, only texels that the triangles show count. Most of an atlas belongs to other objects, and its gaps are often black.
std::vector<std::array<std::uint8_t, 4>> baked_colours(const model::Model& model, const importer::Primitive& primitive,
                                                       std::span<const model::Vertex> vertices);

}  // namespace surefoot::bake
