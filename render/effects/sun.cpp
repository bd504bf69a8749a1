// Effect: sun and sky light, computed at the vertices (Gouraud): a hemisphere from ground to sky plus one directional sun.
// Normals go by the cofactor matrix, which serves non-uniform scales; its sign is the determinant's, so a mirrored placement
// turns it back. Normals of two-sided materials turn towards the eye.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

constexpr EffectModule sun{
    .bit = model::effect_sun,
    .name = "sun",
    .help = "sun and sky light at the vertices",
    .requested_by = "a mesh with normals and a lit material",
    .vertex_declarations = "in vec3 normal;\nin float two_sided;\nuniform vec3 sun_direction;\n",
    .vertex_code =
        "    vec3 cofactor_x = cross(world_rows[1].xyz, world_rows[2].xyz);\n"
        "    vec3 cofactor_y = cross(world_rows[2].xyz, world_rows[0].xyz);\n"
        "    vec3 cofactor_z = cross(world_rows[0].xyz, world_rows[1].xyz);\n"
        "    vec3 n = vec3(dot(cofactor_x, normal), dot(cofactor_y, normal), dot(cofactor_z, normal));\n"
        "    n *= inversesqrt(max(dot(n, n), 1e-30)) * sign(dot(world_rows[0].xyz, cofactor_x));\n"
        "    if (two_sided > 0.5 && dot(n, world) > 0.0) n = -n;\n"
        "    vec3 sky = mix(vec3(0.34, 0.32, 0.30), vec3(0.52, 0.56, 0.62), 0.5 * n.y + 0.5);\n"
        "    v_colour.rgb *= sky + vec3(0.56, 0.53, 0.47) * max(dot(n, sun_direction), 0.0);\n",
    .fragment_declarations = "",
    .fragment_code = "",
};
const EffectModule sun_module = sun;

}  // namespace surefoot::effects
