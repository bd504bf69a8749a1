// The effects as bits, and the findings of the bake. The state class of a draw is its set of effects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace surefoot::model {

/// One bit an effect; render/effects has them by name. The bare pipeline (mask 0) draws the material's colour, opaque, unlit.
enum Effect : std::uint32_t {
    effect_texture = 1U << 0U,          ///< base colour texture
    effect_vertex_colour = 1U << 1U,    ///< colour a vertex
    effect_sun = 1U << 2U,              ///< sun and sky light, Gouraud: needs normals
    effect_alpha_mask = 1U << 3U,       ///< alpha test against the material's cutoff
    effect_blend = 1U << 4U,            ///< ordered transparency: drawn last, back to front
    effect_openness = 1U << 5U,         ///< the sun where the sky is seen, a room's light elsewhere, as baked at the vertices
    effect_shadow = 1U << 6U,           ///< no sun where something hides it, as baked at the vertices for the whole day
    effect_lamps = 1U << 7U,            ///< light of lamps and of what glows, as baked at the vertices
    effect_fog = 1U << 8U,              ///< what is far takes the colour of the sky
    effect_water = 1U << 9U,            ///< waves go over it
    effect_moving_shadow = 1U << 10U,   ///< no sun where something that moves hides it, by a shadow map
    effect_light_by_pixel = 1U << 11U,  ///< its light is worked out for each pixel, not at the vertices
    effect_sky = 1U << 12U,             ///< a sky behind everything
    effect_lit_picture = 1U << 13U,     ///< a captured picture in the light of the moment
};
using EffectMask = std::uint32_t;
/// Effects of the scene that are drawn behind everything, by programs of their own. No material has one.
constexpr EffectMask background_effects = effect_sky;
constexpr int effect_count = 14;
constexpr int first_effect_count = 5;  ///< of the oldest files that open

/// Whether a scene calls for an effect, and the evidence. One entry for every effect, called for or not.
struct EffectFinding {
    std::uint32_t bit = 0;
    bool called_for = false;
    std::uint64_t triangles = 0;  ///< full-detail triangles that use it
    std::string reason;           ///< e.g. "78 images on 74 materials", or why not
    bool looked_for = true;       ///< false: the bake did not know the effect; such entries are not in the file
};

}  // namespace surefoot::model
