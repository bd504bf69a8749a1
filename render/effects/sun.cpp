// Effect: sun and sky light, computed at the vertices (Gouraud): a hemisphere from ground to sky plus one directional sun.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule sun{
    .bit = model::effect_sun,
    .name = "sun",
    .help = "sun and sky light at the vertices",
    .requested_by = "a mesh with normals and a lit material",
    .vertex_declarations = "uniform vec3 sun_direction;\n",
    .vertex_code =
        "    vec3 sky = mix(vec3(0.34, 0.32, 0.30), vec3(0.52, 0.56, 0.62), 0.5 * n.y + 0.5);\n"
        "    lit *= sky + vec3(0.56, 0.53, 0.47) * max(dot(n, sun_direction), 0.0);\n",
    .fragment_declarations = "",
    .fragment_code = "",
    .is_light = true,
};
const EffectModule sun_module = sun;

}  // namespace surefoot::effects
