// Sun and sky by the sun's height: full from 12 degrees up, dusk below, night from 8 degrees below the horizon.
#include "render/model/daylight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::model {

namespace {

constexpr double one_degree = std::numbers::pi / 180;
constexpr float half_contrasts = 4.3219281F;  // log2(20): what is left at the visibility is 5 %

float smooth(double from, double to, double value) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return static_cast<float>(t * t * (3 - 2 * t));
}

/// What the sun's height makes of the usual light.
void set_by_height(Daylight& light) {
    const double height_deg = std::asin(std::clamp(static_cast<double>(light.sun_direction.y), -1.0, 1.0)) / one_degree;
    const float day = smooth(-8, 12, height_deg), sun = smooth(-1, 12, height_deg), low = 1 - smooth(2, 20, height_deg);
    const vec3 night_ground(0.07F, 0.072F, 0.074F), night_sky(0.11F, 0.12F, 0.15F);
    light.sun_light *= sun * vec3(1.0F, 1.0F - 0.25F * low, 1.0F - 0.5F * low);
    light.ground_light = glm::mix(night_ground, light.ground_light, day);
    light.sky_light = glm::mix(night_sky, light.sky_light, day);
    light.background = glm::mix(vec3(0.05F, 0.06F, 0.1F), vec3(1.0F), day);
    light.lamp_strength *= 1 - smooth(-3, 6, height_deg);
    light.room_light = glm::mix(light.room_light, 1.0F, day);
    const Daylight noon;
    light.pictures =
        (light.sky_light + light.ground_light + light.sun_light) / (noon.sky_light + noon.ground_light + noon.sun_light);
}

void set_fog(Daylight& light, const LightFacts& facts) {
    if (facts.fog_visibility_m > 0) light.fog_density = half_contrasts / facts.fog_visibility_m;
}

}  // namespace

double hour_of_moment(std::uint32_t moment, double day, double latitude_deg) {
    const double half = half_day_h(day, latitude_deg);
    return 12 + half * (2.0 * moment / (sun_moments - 1) - 1);
}

Daylight daylight_of_model(const dvec3& sun_direction, const LightFacts& facts) {
    Daylight light;
    light.sun_direction = vec3(glm::normalize(sun_direction));
    set_fog(light, facts);
    return light;
}

Daylight daylight_at(double hour, const LightFacts& facts) {
    Daylight light;
    hour = std::isfinite(hour) ? hour - 24 * std::floor(hour / 24) : 12;
    light.sun_direction = vec3(towards_sun({hour, facts.day, facts.latitude_deg}));
    light.lamp_strength = facts.max_lamp_light;
    light.room_light = facts.night_room_light;
    set_by_height(light);
    const double half = half_day_h(facts.day, facts.latitude_deg);
    const double at = std::clamp((hour - 12) / half + 1, 0.0, 2.0) * 0.5 * (sun_moments - 1);
    const double moment = std::min(std::floor(at), static_cast<double>(sun_moments - 2));
    light.sun_moment = 1 + static_cast<std::uint32_t>(moment);
    light.sun_between = static_cast<float>(at - moment);
    set_fog(light, facts);
    return light;
}

}  // namespace surefoot::model
