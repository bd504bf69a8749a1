// Effect: sun and sky light, by default at the vertices (Gouraud): a hemisphere from ground to sky plus one directional sun.
#include <algorithm>

#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

void light_by_sun(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    out.by_sun = of_moment.sun_light * std::max(glm::dot(point.normal, of_moment.sun_direction), 0.0F);
    out.lit *= glm::mix(of_moment.ground_light, of_moment.sky_light, 0.5F * point.normal.y + 0.5F) + out.by_sun;
}

constexpr std::array<gl::UniformSource, 4> sun_uniforms{{
    {"sun_direction", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.sun_direction, to); }},
    {"sun_light", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.sun_light, to); }},
    {"ground_light", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.ground_light, to); }},
    {"sky_light", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.sky_light, to); }},
}};

}  // namespace

constexpr EffectModule sun{
    .bit = model::effect_sun,
    .name = "sun",
    .help = "sun and sky light",
    .requested_by = "a mesh with normals and a lit material",
    .have = "are lit",
    .missing = "every material is unlit",
    .not_here = "nothing is lit",
    .called_for = [](const MaterialFacts& material) { return material.lit; },
    .uniforms = sun_uniforms,
    .varies_colour = true,
    .light_declarations =
        "uniform vec3 sun_direction;\nuniform vec3 sun_light;\nuniform vec3 ground_light;\nuniform vec3 sky_light;\n",
    .light_code =
        "    by_sun = sun_light * max(dot(n, sun_direction), 0.0);\n"
        "    lit *= mix(ground_light, sky_light, 0.5 * n.y + 0.5) + by_sun;\n",
    .priced_on = model::effect_texture,
    .usual_price = {model::effect_sun, 2.3F, 1.4F, 0.06F},
    .light = light_by_sun,
    .changes_nothing =
        [](const MaterialUse& material) { return material.no_sky && (material.effects & model::effect_openness) != 0; },
    .not_everywhere = "light would change materials without it",
};
const EffectModule sun_module = sun;

}  // namespace surefoot::effects
