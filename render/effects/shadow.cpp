// Effect: shadows that do not move with things. How much of the sun a vertex sees at two moments, between which it now is.
#include <algorithm>

#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

void take_shadow(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    const auto seen = [&](std::uint32_t moment) { return static_cast<float>(point.sun_seen.share[moment]) / 255.0F; };
    const std::uint32_t moment = std::min(of_moment.sun_moment, model::sun_moments - 1);
    const float before = seen(moment), after = seen(moment + 1);
    out.lit -= out.by_sun * (1.0F - (before + (after - before) * of_moment.sun_between));
}

constexpr std::array<gl::UniformSource, 1> shadow_uniforms{{
    {"sun_between", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.light.sun_between; }},
}};
constexpr std::array<LightInput, 1> shadow_inputs{{{"vec2", "sun_seen"}}};

}  // namespace

constexpr EffectModule shadow{
    .bit = model::effect_shadow,
    .name = "baked_shadow",
    .help = "no sun where something hides it, baked at the vertices for the whole day",
    .requested_by = "a mesh in the sun that something hides from it, in a bake of quality full",
    .have = "lie in shadow",
    .missing = "not measured: the bake is of quality draft, or nothing stands between sun and scene",
    .not_here = "nothing hides the sun from what is here",
    .uniforms = shadow_uniforms,
    .light_declarations = "uniform float sun_between;\n",
    .light_code = "    lit -= by_sun * (1.0 - mix(sun_seen.x, sun_seen.y, sun_between));\n",
    .light_inputs = shadow_inputs,
    .order = 3,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_shadow, 0.9F, 0, 0},
    .light = take_shadow,
    .shows_nothing = sun_is_black,
    .changes_nothing =  // its vertices see the sun all day
    [](const MaterialUse& material) { return (material.effects & model::effect_sun) != 0; },
    .not_everywhere = "light would change materials without it",
};
const EffectModule shadow_module = shadow;

}  // namespace surefoot::effects
