// The effects' modules, one file each; listed by all_effects().
#pragma once

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

}  // namespace surefoot::effects
