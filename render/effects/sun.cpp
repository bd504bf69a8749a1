// Effect: sun and sky light, computed at the vertices (Gouraud): a hemisphere from ground to sky plus one directional sun.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule sun{
    .bit = model::effect_sun,
    .name = "sun",
    .help = "sun and sky light at the vertices",
    .requested_by = "a mesh with normals and a lit material",
    .vertex_declarations =
        "uniform vec3 sun_direction;\nuniform vec3 sun_light;\nuniform vec3 ground_light;\nuniform vec3 sky_light;\n",
    .vertex_code =
        "    by_sun = sun_light * max(dot(n, sun_direction), 0.0);\n"
        "    lit *= mix(ground_light, sky_light, 0.5 * n.y + 0.5) + by_sun;\n",
    .fragment_declarations = "",
    .fragment_code = "",
    .is_light = true,
};
const EffectModule sun_module = sun;

}  // namespace surefoot::effects
