// Effect: light of lamps that stand still, and of surfaces that glow. Each side of a surface has its own.
#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

void light_by_lamps(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    out.lit += of_moment.lamp_strength * point.by_lamps * point.by_lamps;
}

}  // namespace

constexpr EffectModule lamps{
    .bit = model::effect_lamps,
    .name = "baked_lamps",
    .help = "light of lamps and of what glows, baked at the vertices",
    .requested_by = "a lamp (KHR_lights_punctual) or an emissive material, in a bake of quality full",
    .vertex_declarations = "in vec3 lamps_before;\nin vec3 lamps_behind;\nuniform float lamp_strength;\n",
    .vertex_code =
        "    vec3 by_lamps = turned ? lamps_behind : lamps_before;\n"
        "    lit += lamp_strength * by_lamps * by_lamps;\n",
    .fragment_declarations = "",
    .fragment_code = "",
    .is_light = true,
    .order = 5,
    .light = light_by_lamps,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_lamps, 2.2F, 0.7F, 0},
};
const EffectModule lamps_module = lamps;

}  // namespace surefoot::effects
