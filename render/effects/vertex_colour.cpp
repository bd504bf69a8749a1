// Effect: a colour at each vertex, multiplied with the material's.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule vertex_colour{
    .bit = model::effect_vertex_colour,
    .name = "vertex_colour",
    .help = "a colour at each vertex",
    .requested_by = "a mesh whose vertices carry colours",
    .have = "have vertex colours",
    .missing = "all vertex colours are white or absent",
    .not_here = "all vertices here are white, or have no colours",
    .called_for = [](const MaterialFacts& material) { return material.vertex_colours; },
    .vertex_declarations = "in vec4 vertex_colour;\n",
    .vertex_code = "    v_colour *= vertex_colour;\n",
    .varies_colour = true,
    .changes_nothing = [](const MaterialUse& material) { return material.white; },
    .not_everywhere = "a colour stands in vertices that do not show it",
};
const EffectModule vertex_colour_module = vertex_colour;

}  // namespace surefoot::effects
