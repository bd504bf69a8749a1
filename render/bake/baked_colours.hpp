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

/// Share of a triangle that passes the alpha test, 0..1, sampled. 1 for a material without alpha test.
float share_shown(const model::Model& model, const model::Material& material, const std::array<vec2, 3>& uv);

}  // namespace surefoot::bake
