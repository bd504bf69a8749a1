// The registry of effects: their modules, one file each, in bit order.
#pragma once

#include <array>

#include "render/effects/effects.hpp"

namespace surefoot::effects {

extern const EffectModule texture_module;
extern const EffectModule vertex_colour_module;
extern const EffectModule sun_module;
extern const EffectModule alpha_mask_module;
extern const EffectModule blend_module;
extern const EffectModule openness_module;
extern const EffectModule shadow_module;
extern const EffectModule lamps_module;
extern const EffectModule fog_module;
extern const EffectModule water_module;
extern const EffectModule moving_shadow_module;
extern const EffectModule light_by_pixel_module;
extern const EffectModule sky_module;
extern const EffectModule lit_picture_module;

inline constexpr std::array<const EffectModule*, model::effect_count> registry{
    &texture_module,       &vertex_colour_module,  &sun_module,   &alpha_mask_module, &blend_module,
    &openness_module,      &shadow_module,         &lamps_module, &fog_module,        &water_module,
    &moving_shadow_module, &light_by_pixel_module, &sky_module,   &lit_picture_module};

/// EffectModule::shows_nothing of all that only takes the sun's own part of the light.
inline bool sun_is_black(const model::Daylight& light) { return light.sun_light == vec3(0.0F); }

/// Writes a uniform of type vec3.
constexpr void put(const vec3& value, float* to) {
    for (int i = 0; i < 3; ++i) to[i] = value[i];
}

}  // namespace surefoot::effects
