// Effect: captured pictures of boxes in the light of the moment. What they are captured from looks many ways, so no normal
// serves: bake adds up how much of the sun at each moment, of sky, ground, rooms and lamps falls on it. Lamps differ by corner,
// so colours are interpolated.
#include <algorithm>

#include "render/effects/modules.hpp"
#include "render/effects/surface_light.hpp"

namespace surefoot::effects {

namespace {

constexpr float lamps_on_faces = 0.7F;  // lamps light spots: their mean over a face differs more from them than less of it does
constexpr vec3 room_colour(0.98F, 0.95F, 0.91F);

/// Rooms are seen through windows, and a face shows their light on all of it. That would be too bright by night, when rooms are
/// brighter than what is about them.
vec3 room_light(const model::Daylight& light) {
    constexpr float dark_sky = 0.12F, bright_sky = 0.56F, by_night = 0.25F;  // of green, night and day
    const float day = std::clamp((light.sky_light.g - dark_sky) / (bright_sky - dark_sky), 0.0F, 1.0F);
    return light.room_light * glm::mix(by_night, 1.0F, day) * room_colour;
}

/// As surfaces without the effect of the sun: their light is 1 before openness.
bool is_sunless(const gl::PictureMoment& moment) { return (moment.hidden & model::effect_sun) != 0; }

constexpr std::array<gl::UniformSource, 6> picture_uniforms{{
    {"picture_sun", 3,
     [](const gl::PictureMoment& moment, float* to) { put(is_sunless(moment) ? vec3(0) : moment.light.sun_light, to); }},
    {"picture_sky", 3,
     [](const gl::PictureMoment& moment, float* to) { put(is_sunless(moment) ? vec3(1) : moment.light.sky_light, to); }},
    {"picture_ground", 3,
     [](const gl::PictureMoment& moment, float* to) { put(is_sunless(moment) ? vec3(1) : moment.light.ground_light, to); }},
    {"picture_room", 3, [](const gl::PictureMoment& moment, float* to) { put(room_light(moment.light), to); }},
    {"picture_lamps", 1,
     [](const gl::PictureMoment& moment, float* to) {
         *to = (moment.hidden & model::effect_lamps) != 0 ? 0 : lamps_on_faces * moment.light.lamp_strength;
     }},
    {"picture_between", 1, [](const gl::PictureMoment& moment, float* to) { *to = moment.light.sun_between; }},
}};
constexpr std::array<LightInput, 3> picture_inputs{{{"vec4", "hidden"}, {"vec2", "sun_seen"}, {"vec3", "lamps_before"}}};

void light_picture(const SurfacePoint& point, const model::Daylight& of_moment, SurfaceLight& out) {
    out.lit *= light_on_picture(point.picture, of_moment);
}

}  // namespace

vec3 light_on_picture(const PictureLight& light, const model::Daylight& of_moment) {
    const auto share = [](std::uint8_t byte) { return max_picture_light * static_cast<float>(byte) / 255.0F; };
    const std::uint32_t moment = std::min(of_moment.sun_moment, model::sun_moments - 1);
    const float in_sun = glm::mix(share(light.sun.share[moment]), share(light.sun.share[moment + 1]), of_moment.sun_between);
    const vec3 root = vec3(light.lamps[0], light.lamps[1], light.lamps[2]) / 255.0F;
    return of_moment.sun_light * in_sun + of_moment.sky_light * share(light.from[0]) +
           of_moment.ground_light * share(light.from[1]) + room_light(of_moment) * share(light.from[2]) +
           lamps_on_faces * of_moment.lamp_strength * root * root;
}

constexpr EffectModule lit_picture{
    .bit = model::effect_lit_picture,
    .name = "lit_picture",
    .help = "pictures of boxes in the light of the hour, as baked at the corners of faces",
    .requested_by = "a box with pictures of what is lit, in a bake of quality full that finds shadows",
    .have = "are pictures in the light of the hour",
    .missing = "no material of the scene is a captured picture",
    .not_here = "no box with pictures of what is lit",
    .uniforms = picture_uniforms,
    .varies_colour = true,
    .light_declarations =
        "uniform vec3 picture_sun;\nuniform vec3 picture_sky;\nuniform vec3 picture_ground;\nuniform vec3 picture_room;\n"
        "uniform float picture_lamps;\nuniform float picture_between;\n",
    .light_code =
        "    vec3 on_picture = picture_sun * mix(sun_seen.x, sun_seen.y, picture_between) + picture_sky * hidden.x +\n"
        "                      picture_ground * hidden.y + picture_room * hidden.z;\n"
        "    lit *= 2.0 * on_picture + picture_lamps * lamps_before * lamps_before;\n",
    .light_inputs = picture_inputs,
    .order = 6,
    .priced_on = model::effect_texture,
    .usual_price = {model::effect_lit_picture, 2.5F, 0.9F, 0.08F},
    .light = light_picture,
    .not_everywhere = "light would change materials without it",
};
const EffectModule lit_picture_module = lit_picture;

}  // namespace surefoot::effects
