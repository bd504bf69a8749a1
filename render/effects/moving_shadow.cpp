// Effect: shadows of what moves, from a depth picture as the sun sees it. It takes the sun's own part of the light and no more.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

constexpr std::array<gl::UniformSource, 3> shadow_map_uniforms{{
    {"shadow_from_eye", 16,
     [](const gl::PictureMoment& moment, float* to) {
         for (int i = 0; i < 16; ++i) to[i] = moment.shadow.from_eye[i / 4][i % 4];
     }},
    {"shadow_towards", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.shadow.towards, to); }},
    {"shadow_texel", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.shadow.texel; }},
}};
constexpr std::array<gl::SamplerSource, 1> shadow_map_samplers{{{"shadow_map", gl::shadow_unit}}};

}  // namespace

// What receives stands still and what casts moves, so no surface shades itself: a slope's bias is there for what touches the
// ground. The comparison of 2 x 2 texels is the sampler's.
constexpr EffectModule moving_shadow{
    .bit = model::effect_moving_shadow,
    .name = "moving_shadow",
    .help = "no sun where something that moves hides it, by a shadow map",
    .requested_by = "a lit mesh that stands still within reach of the shadow of something opaque that moves",
    .have = "receive moving shadows",
    .missing = "nothing moves",
    .not_here = "no shadow of what moves reaches anything lit here",
    .vertex_declarations =
        "uniform mat4 shadow_from_eye;\nuniform vec3 shadow_towards;\nuniform float shadow_texel;\n"
        "out vec3 v_shadow_at;\n",
    .vertex_code =
        "    v_shadow_at = (shadow_from_eye * vec4(world, 1.0)).xyz;\n"
        "    float facing = clamp(dot(n, shadow_towards), 0.25, 1.0);\n"
        "    v_shadow_at.z += shadow_texel * (0.5 + sqrt(1.0 - facing * facing) / facing);\n",
    .fragment_declarations = "in vec3 v_shadow_at;\nuniform sampler2DShadow shadow_map;\n",
    .fragment_code = "    colour.rgb *= mix(in_shadow, vec3(1.0), texture(shadow_map, v_shadow_at));\n",
    .uniforms = shadow_map_uniforms,
    .samplers = shadow_map_samplers,
    .needs_sunless = true,
    .order = 8,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_moving_shadow, 2.0F, 1.0F, 0.8F},
    .shows_nothing = sun_is_black,
    .not_everywhere = "light would change materials without it",
};
const EffectModule moving_shadow_module = moving_shadow;

}  // namespace surefoot::effects
