// Effect: ordered transparency; the device draws such items last, back to front, without writing depth.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule blend{
    .bit = model::effect_blend,
    .name = "blend",
    .help = "transparent surfaces, drawn last, back to front",
    .requested_by = "a material whose alpha mode is blend",
    .vertex_declarations = "",
    .vertex_code = "",
    .fragment_declarations = "",
    .fragment_code = "    opacity = colour.a;\n",
};
const EffectModule blend_module = blend;

}  // namespace surefoot::effects
