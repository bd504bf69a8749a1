// Effect: what is far takes the colour behind everything. By the pixel: large triangles reach far.
#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

constexpr std::array<gl::UniformSource, 2> fog_uniforms{{
    {"fog_colour", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.background, to); }},
    {"fog_density", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.light.fog_density; }},
}};

}  // namespace

constexpr EffectModule fog{
    .bit = model::effect_fog,
    .name = "depth_fog",
    .help = "what is far takes the colour of the sky",
    .requested_by = "extras.fog_visibility_m of a glTF scene, or bake --fog",
    .have = "lie in fog",
    .missing = "the scene names no fog",
    .not_here = "no material here lies in fog",
    .called_for = [](const MaterialFacts& material) { return material.in_fog; },
    .fragment_declarations = "uniform vec3 fog_colour;\nuniform float fog_density;\n",
    .fragment_code = "    colour.rgb = mix(fog_colour, colour.rgb, exp2(-fog_density / gl_FragCoord.w));\n",
    .uniforms = fog_uniforms,
    .order = 9,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_fog, 0, 2.4F, 0.46F},
    .hides_by_depth = true,
};
const EffectModule fog_module = fog;

}  // namespace surefoot::effects
