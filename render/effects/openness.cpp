// Effect: light by what a vertex sees, as baked. Where it sees no sky, a room's light takes the place of sun and sky; what is
// near it shades it. A little sky is enough for the sun: a street is no room.
#include <algorithm>

#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

void light_by_openness(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    const vec3& n = point.normal;
    const vec3 room = of_moment.room_light * (vec3(0.98F, 0.95F, 0.91F) + (0.06F * n.x + 0.12F * n.y - 0.04F * n.z));
    out.lit = glm::mix(room, out.lit, std::min(1.0F, 4.0F * point.sees_sky)) * (0.6F + 0.4F * point.sees_room);
}

constexpr std::array<gl::UniformSource, 1> room_uniforms{{
    {"room_light", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.light.room_light; }},
}};
constexpr std::array<LightInput, 1> openness_inputs{{{"vec4", "hidden"}}};

}  // namespace

constexpr EffectModule openness{
    .bit = model::effect_openness,
    .name = "openness",
    .help = "no sun where no sky is seen, and shade in corners, baked at the vertices",
    .requested_by = "a lit mesh that something hides from the sky, in a bake of quality full",
    .have = "are shaded",
    .missing = "not measured: the bake is of quality draft, or nothing lit is hidden from the sky",
    .not_here = "nothing lit here is hidden from the sky",
    .uniforms = room_uniforms,
    .varies_colour = true,
    .light_declarations = "uniform float room_light;\n",
    .light_code =
        "    vec2 seen = 1.0 - (turned ? hidden.yw : hidden.xz);\n"
        "    vec3 room = room_light * (vec3(0.98, 0.95, 0.91) + (0.06 * n.x + 0.12 * n.y - 0.04 * n.z));\n"
        "    lit = mix(room, lit, min(1.0, 4.0 * seen.x)) * (0.6 + 0.4 * seen.y);\n",
    .light_inputs = openness_inputs,
    .order = 4,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_openness, 0, 0, 0},
    .light = light_by_openness,
    .changes_nothing = [](const MaterialUse& material) { return material.open && (material.effects & model::effect_sun) != 0; },
    .not_everywhere = "light would change materials without it",
};
const EffectModule openness_module = openness;

}  // namespace surefoot::effects
