// Effect: water that moves. Three waves go over its surface; each pixel is brighter or darker by them. Nothing is displaced, so
// all bounds hold. By the pixel: a lake may be two triangles.
#include <cmath>

#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

/// Radians a metre to east and south. Their lengths are 7.3, 5.1 and 1.9 m.
constexpr std::array<vec2, 3> wave_numbers{vec2{0.79F, 0.34F}, vec2{-0.62F, 1.06F}, vec2{2.95F, -1.5F}};

/// Phases of the waves at the eye. In deep water a wave of k radians a metre turns by sqrt(9.81 k) radians a second.
void write_phases(const gl::PictureMoment& moment, float* to) {
    for (std::size_t i = 0; i < wave_numbers.size(); ++i) {
        const dvec2 k(wave_numbers[i]);
        const double turns = glm::dot(k, dvec2(moment.eye.x, moment.eye.z)) - std::sqrt(9.81 * glm::length(k)) * moment.time_s;
        to[i] = static_cast<float>(std::remainder(turns, 2.0 * glm::pi<double>()));
    }
}

constexpr std::array<gl::UniformSource, 2> water_uniforms{{
    {"wave_phases", 3, write_phases},
    {"pixel_rad", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.pixel_rad; }},
}};

}  // namespace

// A pixel covers more water the lower one looks along it. What it covers of a wave is `along` radians; beyond 1.6 it shows none.
// Waves bend each other, or they would look woven.
constexpr EffectModule water{
    .bit = model::effect_water,
    .name = "water_waves",
    .help = "waves that go over water, without displacing or reflecting anything",
    .requested_by = "extras.water of a glTF material, or bake --water and a name that ends with the word water",
    .have = "are water",
    .missing = "no material is water by its extras, nor by its name where bake --water was given",
    .not_here = "no material here is water",
    .called_for = [](const MaterialFacts& material) { return material.water; },
    .vertex_declarations = "out vec3 v_from_eye;\n",
    .vertex_code = "    v_from_eye = world;\n",
    .fragment_declarations = "in vec3 v_from_eye;\nuniform vec3 wave_phases;\nuniform float pixel_rad;\n",
    .fragment_code =
        "    float along = pixel_rad * dot(v_from_eye, v_from_eye) / max(abs(v_from_eye.y), 1e-3);\n"
        "    vec3 seen = clamp(1.6 - along * vec3(0.86, 1.23, 3.31), 0.0, 1.0);\n"
        "    vec3 wave = wave_phases + vec3(dot(v_from_eye.xz, vec2(0.79, 0.34)), dot(v_from_eye.xz, vec2(-0.62, 1.06)),\n"
        "                                   dot(v_from_eye.xz, vec2(2.95, -1.5)));\n"
        "    wave = vec3(wave.xy + 0.9 * sin(wave.yx), wave.z + sin(wave.x));\n"
        "    colour.rgb *= 1.0 + dot(seen * vec3(0.07, 0.07, 0.06), cos(wave));\n",
    .uniforms = water_uniforms,
    .order = 8,
    .priced_on = model::effect_texture | model::effect_sun,
    .usual_price = {model::effect_water, 0, 2.0F, 1.5F},
    .moves = true,
    .not_everywhere = "only water has waves",
};
const EffectModule water_module = water;

}  // namespace surefoot::effects
