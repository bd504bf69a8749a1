// Effect: what is far takes the colour behind everything. By the pixel: large triangles reach far.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule fog{
    .bit = model::effect_fog,
    .name = "depth_fog",
    .help = "what is far takes the colour of the sky",
    .requested_by = "extras.fog_visibility_m of a glTF scene, or bake --fog",
    .vertex_declarations = "",
    .vertex_code = "",
    .fragment_declarations = "uniform vec3 fog_colour;\nuniform float fog_density;\n",
    .fragment_code = "    colour.rgb = mix(fog_colour, colour.rgb, exp2(-fog_density / gl_FragCoord.w));\n",
    .order = 9,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_fog, 0, 2.4F, 0.46F},
};
const EffectModule fog_module = fog;

}  // namespace surefoot::effects
