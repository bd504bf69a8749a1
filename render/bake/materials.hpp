// Materials and textures of a model from a scene's; and colours with everything baked in, for coarse forms.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/import/scene.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// Fills model.materials and .textures (with mip levels; texels that are never shown have the nearest shown one's colour).
/// Effects a material calls for, sun included; vertex colour is set by mark_vertex_colours(). Appends the proxy material (vertex
/// colours and sun) and returns its index.
model::Index add_materials(const importer::Scene& scene, model::Model& model);
/// Those whose picture's alpha cuts the shape out of the triangles: masks with a texel that they drop. By material of the scene.
std::vector<bool> cut_out_materials(const importer::Scene& scene);
/// A material whose primitives have colours that are not all white calls for vertex colours.
void mark_vertex_colours(const importer::Scene& scene, model::Model& model);

/// Adds RGBA8 with its mip levels, as far as there are; returns its index. cutoff: the alpha (0..255) from which a mask shows it,
/// or 0 of no mask. Levels of a mask show about as much as the picture does, and end where they no longer can.
model::Index add_texture(model::Model& model, std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                         bool clamp, std::uint32_t most_levels, float cutoff = 0);

/// Colour of a vertex: its own, times the material's, times what its picture shows (0..255 each).
std::array<std::uint8_t, 4> tinted(const model::Material& material, const model::Vertex& vertex, const vec3& picture);
/// The same for a vertex of no triangle: with the texture about its uv.
std::array<std::uint8_t, 4> baked_colour(const model::Model& model, const model::Material& material, const model::Vertex& vertex);

/// One finding an effect, with the reason, from materials and full-detail triangles a material.
std::vector<model::EffectFinding> find_effects(const model::Model& model,
                                               const std::vector<std::uint64_t>& triangles_of_material);

}  // namespace surefoot::bake
