// Effect: a sky behind everything, and the sun in it. A pass of its own before all else, which works out each pixel's direction.
#include <algorithm>
#include <cmath>

#include "render/effects/modules.hpp"

namespace surefoot::effects {

namespace {

constexpr float fog_height_m = 50;  ///< of the fog that one looks through towards the sky

/// The sun's colour: bright while there is light of it, and black by night.
vec3 sun_in_sky(const model::Daylight& light) {
    const vec3& now = light.sun_light;
    const float full = model::Daylight{}.sun_light.r, brightest = std::max({now.r, now.g, now.b});
    return brightest > 0 ? now / std::sqrt(full * brightest) : vec3(0);
}

/// Light over the horizon on the sun's side, while the sun is low or just below.
vec3 dusk_light(const model::Daylight& light) {
    const float height_deg = glm::degrees(std::asin(std::clamp(light.sun_direction.y, -1.0F, 1.0F)));
    return glm::smoothstep(-8.0F, 0.0F, height_deg) * (1.0F - glm::smoothstep(2.0F, 20.0F, height_deg)) *
           vec3(0.55F, 0.22F, 0.02F);
}

constexpr std::array<gl::UniformSource, 7> sky_uniforms{{
    {"to_direction", 16,
     [](const gl::PictureMoment& moment, float* to) {
         for (int i = 0; i < 16; ++i) to[i] = moment.to_direction[i / 4][i % 4];
     }},
    {"horizon", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.background, to); }},
    {"zenith", 3,
     [](const gl::PictureMoment& moment, float* to) { put(moment.light.background * vec3(0.45F, 0.62F, 0.92F), to); }},
    {"sun_towards", 3, [](const gl::PictureMoment& moment, float* to) { put(moment.light.sun_direction, to); }},
    {"sun_disc", 3, [](const gl::PictureMoment& moment, float* to) { put(sun_in_sky(moment.light), to); }},
    {"dusk", 3, [](const gl::PictureMoment& moment, float* to) { put(dusk_light(moment.light), to); }},
    {"haze", 1,
     [](const gl::PictureMoment& moment, float* to) { *to = std::max(1e-6F, fog_height_m * moment.light.fog_density); }},
}};

}  // namespace

// The horizon, and all below it, has the fog's colour, so far things fade into it. The sun's disc is a degree wide, twice of what
// it is. What is added last is less than one of 255: without it the eye sees the steps of so even a gradient.
constexpr EffectModule sky{
    .bit = model::effect_sky,
    .name = "clear_sky",
    .help = "a sky behind everything, and the sun in it",
    .requested_by = "extras.sky of a glTF scene, or bake --sky",
    .have = "a sky is behind everything",
    .missing = "neither the scene nor the bake names a sky",
    .not_here = "it is behind everything",
    .called_for_by_scene = [](const SceneFacts& scene) { return scene.sky; },
    .vertex_declarations = "uniform mat4 to_direction;\nout vec3 v_direction;\n",
    .vertex_code =
        "    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
        "    v_direction = (to_direction * vec4(corner, 1.0, 1.0)).xyz;\n"
        "    gl_Position = vec4(corner, 0.0, 1.0);\n",
    .fragment_declarations =
        "in vec3 v_direction;\nuniform vec3 horizon, zenith, sun_towards, sun_disc, dusk;\nuniform float haze;\n",
    .fragment_code =
        "    vec3 direction = normalize(v_direction);\n"
        "    vec3 off_sun = direction - sun_towards;\n"
        "    float up = max(direction.y, 0.0), low = (1.0 - up) * (1.0 - up) * (1.0 - up), chord2 = dot(off_sun, off_sun);\n"
        "    float s2 = max(1.0 - 0.5 * chord2, 0.0);\n"
        "    s2 *= s2;\n"
        "    float s4 = s2 * s2, s8 = s4 * s4, s32 = s8 * s8 * s8 * s8, s128 = s32 * s32 * s32 * s32, s256 = s128 * s128;\n"
        "    float disc = 1.0 - smoothstep(5.9e-5, 9.9e-5, chord2);\n"
        "    vec3 glow = sun_disc * (disc + 0.3 * s256 + 0.12 * s8) + dusk * (low * low * s4);\n"
        "    vec3 above = (zenith - horizon) * (1.0 - low) + smoothstep(0.0, 0.06, up) * glow;\n"
        "    vec3 colour = horizon + above * (up / (up + haze));\n"
        "    colour += (fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;\n",
    .uniforms = sky_uniforms,
};
const EffectModule sky_module = sky;

}  // namespace surefoot::effects
