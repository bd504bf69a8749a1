// Effect: alpha test against the material's cutoff: leaves, fences.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule alpha_mask{
    .bit = model::effect_alpha_mask,
    .name = "alpha_mask",
    .help = "alpha test: holes where alpha is below the material's cutoff",
    .requested_by = "a material whose alpha mode is mask",
    .have = "are cut out by alpha",
    .missing = "no material has alpha mode MASK",
    .not_here = "no material here has alpha mode MASK",
    .called_for = [](const MaterialFacts& material) { return material.alpha == model::AlphaMode::mask; },
    .vertex_declarations = "in float alpha_cutoff;\nflat out float v_alpha_cutoff;\n",
    .vertex_code = "    v_alpha_cutoff = alpha_cutoff;\n",
    .fragment_declarations = "flat in float v_alpha_cutoff;\n",
    .fragment_code = "    if (colour.a < v_alpha_cutoff) discard;\n",
    .fragment_code_samples =
        "    opacity = clamp((colour.a - v_alpha_cutoff) / max(fwidth(colour.a), 1.0 / 255.0) + 0.5, 0.0, 1.0);\n"
        "    if (opacity == 0.0) discard;\n",
    .changes_nothing = [](const MaterialUse&) { return true; },
};
const EffectModule alpha_mask_module = alpha_mask;

}  // namespace surefoot::effects
