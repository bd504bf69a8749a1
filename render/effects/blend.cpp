// Effect: ordered transparency; the device draws such items last, back to front, without writing depth.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule blend{
    .bit = model::effect_blend,
    .name = "blend",
    .help = "transparent surfaces, drawn last, back to front",
    .requested_by = "a material whose alpha mode is blend",
    .have = "are transparent",
    .missing = "no material has alpha mode BLEND",
    .not_here = "no material here has alpha mode BLEND",
    .called_for = [](const MaterialFacts& material) { return material.alpha == model::AlphaMode::blend; },
    .fragment_code = "    opacity = colour.a;\n",
    .not_everywhere = "what is blended is drawn last and hides nothing behind it",
};
const EffectModule blend_module = blend;

}  // namespace surefoot::effects
