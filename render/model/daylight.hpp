// The light of a moment: sun and sky by the hour, lamps by night, fog. What the programs of lit scenes read as uniforms.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/model/sun_time.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::model {

/// How much of the sun a vertex sees, shares of 255. The first is of where the model's own sun stands; 15 moments of its day
/// follow.
/// Beside Vertex, only in models that call for effect_shadow.
struct SunSeen {
    std::uint8_t share[16];
};
static_assert(sizeof(SunSeen) == 16);
inline constexpr SunSeen always_in_sun = {{255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255}};

/// Light of lamps at a vertex, before and behind its surface: RGB, 255 * sqrt(light / LightFacts::max_lamp_light); the last
/// byte is zero. Beside Vertex, only in models that call for effect_lamps.
struct LampLight {
    std::uint8_t before[4], behind[4];
};
static_assert(sizeof(LampLight) == 8);

/// What the bake found of a scene's light, besides its vertices.
struct LightFacts {
    double day = 172, latitude_deg = 50;  ///< of the moments of SunSeen, and of every hour that a walk shows
    float max_lamp_light = 1;             ///< of all vertices
    float fog_visibility_m = 0;           ///< a black thing so far away has 5 % of its contrast; 0: no fog
    float night_room_light = 1;           ///< Daylight::room_light by night; less where a scene's own lamps light its rooms
    bool operator==(const LightFacts&) const = default;
};

/// The light of a moment. Colours are display values, 1 is white.
struct Daylight {
    vec3 sun_direction{0, 1, 0};             ///< towards it
    vec3 sun_light{0.56F, 0.53F, 0.47F};     ///< on what faces the sun
    vec3 ground_light{0.34F, 0.32F, 0.30F};  ///< on what faces the ground
    vec3 sky_light{0.52F, 0.56F, 0.62F};     ///< on what faces the sky
    float sun_between = 0;                   ///< 0..1, from the first to the second of two moments of SunSeen
    float lamp_strength = 0;                 ///< of LampLight; 0: they are off
    float room_light = 1;                    ///< of the light of rooms that see no sky
    float fog_density = 0;                   ///< light falls to 2^-(density * depth along the view in m)
    vec3 background{1.0F};                   ///< factor of the colour behind everything, which is the fog's as well
    vec3 pictures{1.0F};                     ///< factor of what was captured in the light of the bake
    std::uint32_t sun_moment = 0;            ///< the first of two of SunSeen
    bool operator==(const Daylight&) const = default;
};

/// Moments of SunSeen's day. They are evenly spread from sunrise to sunset, or over 24 hours where the sun never rises or never
/// sets.
constexpr std::uint32_t sun_moments = 15;
/// moment: 0 at sunrise, sun_moments - 1 at sunset. Its share is SunSeen::share[moment + 1].
double hour_of_moment(std::uint32_t moment, double day, double latitude_deg);

/// As the bake saw it: the model's own sun, and lamps off.
Daylight daylight_of_model(const dvec3& sun_direction, const LightFacts& facts);
/// At an hour of the facts' day; hours beyond 0..24 come round again, and what is no number is noon.
Daylight daylight_at(double hour, const LightFacts& facts);

}  // namespace surefoot::model
