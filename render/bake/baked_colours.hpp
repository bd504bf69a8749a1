// The colours that stand for pictures in coarse forms: at a vertex, the mean of what the triangles about it show near it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/import/scene.hpp"

namespace surefoot::bake {

/// One colour for each vertex of the primitive, whose vertices in the model's form are `vertices`. Of an opaque picture the part
/// that its triangles show, and no other: most of an atlas belongs to other things, and what lies between them is black in most.
std::vector<std::array<std::uint8_t, 4>> baked_colours(const model::Model& model, const importer::Primitive& primitive,
                                                       std::span<const model::Vertex> vertices);

/// Share of a triangle that is not cut out by its mask, 0..1, sampled; 1 of a material that is no mask.
float share_shown(const model::Model& model, const model::Material& material, const std::array<vec2, 3>& uv);

}  // namespace surefoot::bake
