// Effect: light of lamps that stand still, and of surfaces that glow. Each side of a surface has its own.
#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

void light_by_lamps(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    out.lit += of_moment.lamp_strength * point.by_lamps * point.by_lamps;
}

constexpr std::array<gl::UniformSource, 1> lamp_uniforms{{
    {"lamp_strength", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.light.lamp_strength; }},
}};
constexpr std::array<LightInput, 2> lamp_inputs{{{"vec3", "lamps_before"}, {"vec3", "lamps_behind"}}};

}  // namespace

constexpr EffectModule lamps{
    .bit = model::effect_lamps,
    .name = "baked_lamps",
    .help = "light of lamps and of what glows, baked at the vertices",
    .requested_by = "a lamp (KHR_lights_punctual) or an emissive material, in a bake of quality full",
    .have = "are lit by lamps",
    .missing = "no lamp and nothing that glows, or the bake is of quality draft",
    .not_here = "no lamp reaches it, and nothing here glows",
    .uniforms = lamp_uniforms,
    .varies_colour = true,
    .light_declarations = "uniform float lamp_strength;\n",
    .light_code =
        "    vec3 by_lamps = turned ? lamps_behind : lamps_before;\n"
        "    lit += lamp_strength * by_lamps * by_lamps;\n",
    .light_inputs = lamp_inputs,
    .order = 5,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_lamps, 2.2F, 0.7F, 0},
    .light = light_by_lamps,
    .shows_nothing = [](const model::Daylight& light) { return light.lamp_strength == 0.0F; },
    .changes_nothing =  // no lamp reaches its vertices
    [](const MaterialUse& material) { return (material.effects & (model::effect_sun | model::effect_openness)) != 0; },
    .not_everywhere = "light would change materials without it",
};
const EffectModule lamps_module = lamps;

}  // namespace surefoot::effects
