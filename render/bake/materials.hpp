// Converts materials and textures of a scene to those of a model; bakes colours for coarse levels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/bake/scene_light.hpp"
#include "render/import/scene.hpp"
#include "render/model/model.hpp"
#include "render/model/sun_time.hpp"

namespace surefoot::bake {

/// What the caller says of materials, where their files say nothing.
struct MaterialRules {
    bool water_by_name = false;   ///< as is_named_water() says
    bool light_by_pixel = false;  ///< all that is lit, but for coarse forms of several materials
};

/// Fills model.materials and model.textures, with mip levels and alpha bleeding. Each material has the effects that it calls for
/// by itself; the model has its fog already. Appends the proxy material (vertex colours and sun) and returns its index.
model::Index add_materials(const importer::Scene& scene, model::Model& model, const MaterialRules& rules = {});
/// Whether the last word of a material's name is "water": "Pond_water.001", "oceanicWater.png", and not "waterfall".
bool is_named_water(std::string_view name);
/// By material of the scene: whether its alpha test drops at least one texel, and so cuts shapes out of triangles.
std::vector<bool> cut_out_materials(const importer::Scene& scene);
/// By material of the model: whether it has a texture, and how that wraps.
std::vector<Picture> pictures_of(const model::Model& model);

/// Adds an RGBA8 texture with at most `max_levels` mip levels; returns its index. cutoff: alpha (0..255) of the alpha test, or 0
/// without one. Levels of an alpha-tested texture keep its coverage; they end where they no longer can.
model::Index add_texture(model::Model& model, std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                         bool clamp, std::uint32_t max_levels, float cutoff = 0);

/// Vertex colour x material colour x texture colour, 0..255 each.
std::array<std::uint8_t, 4> tinted(const model::Material& material, const model::Vertex& vertex, const vec3& picture);
/// The same, with the texture colour around the uv of the vertex. For vertices without triangles.
std::array<std::uint8_t, 4> baked_colour(const model::Model& model, const model::Material& material, const model::Vertex& vertex);

/// What nothing is drawn with calls for no effects. copies: materials that stand for others without the sun, and which; an
/// original of which only the copy is drawn takes the copy's effects.
void keep_used_effects(model::Model& model, std::span<const std::pair<model::Index, model::Index>> copies);
/// One finding an effect, with its reason. triangles_of_material: full detail.
std::vector<model::EffectFinding> find_effects(const model::Model& model, const std::vector<std::uint64_t>& triangles_of_material,
                                               const SceneLight& light = {});
/// Into the findings: what the scene, or the bake, calls for that no material has.
void add_scene_effects(const importer::Scene& scene, bool sky_by_bake, std::vector<model::EffectFinding>& findings);
/// Adds to the sun's finding why it stands where it does, if it is called for.
void add_sun_reason(const importer::Scene& scene, const std::optional<model::SunTime>& time,
                    std::vector<model::EffectFinding>& findings);

}  // namespace surefoot::bake
