// Effect: shadows that do not move with things. How much of the sun a vertex sees at two moments, between which it now is.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule shadow{
    .bit = model::effect_shadow,
    .name = "baked_shadow",
    .help = "no sun where something hides it, baked at the vertices for the whole day",
    .requested_by = "a mesh in the sun that something hides from it, in a bake of quality full",
    .vertex_declarations = "in vec2 sun_seen;\nuniform float sun_between;\n",
    .vertex_code = "    lit -= by_sun * (1.0 - mix(sun_seen.x, sun_seen.y, sun_between));\n",
    .fragment_declarations = "",
    .fragment_code = "",
    .is_light = true,
    .order = 3,
};
const EffectModule shadow_module = shadow;

}  // namespace surefoot::effects
