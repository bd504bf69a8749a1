// Which effects show nothing in a light, and which of them go together.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/model/daylight.hpp"

namespace surefoot {
namespace {

constexpr model::EffectMask by_lamps = model::effect_lamps, no_sun = model::effect_shadow | model::effect_moving_shadow;

TEST(EffectsByLight, ShowNothingOnlyWhereTheyProvablyDo) {
    model::LightFacts facts;
    facts.max_lamp_light = 0.7F;
    EXPECT_EQ(effects::without_effect_in(model::daylight_at(12, facts)), by_lamps);
    EXPECT_EQ(effects::without_effect_in(model::daylight_at(0, facts)), no_sun);
    EXPECT_EQ(effects::without_effect_in(model::daylight_of_model(dvec3(0, 1, 0), facts)), by_lamps);
    for (int step = 0; step < 24 * 30; ++step) {
        const model::Daylight light = model::daylight_at(step / 30.0, facts);
        const model::EffectMask none = effects::without_effect_in(light);
        EXPECT_EQ((none & by_lamps) != 0, light.lamp_strength == 0) << step;
        EXPECT_EQ(none & no_sun, light.sun_light == vec3(0) ? no_sun : 0U) << step;
        EXPECT_EQ(none & ~(by_lamps | no_sun), 0U) << step;
    }
    model::Daylight light = model::daylight_at(0, facts);
    for (int channel = 0; channel < 3; ++channel) {
        light.sun_light = vec3(0);
        light.sun_light[channel] = 1e-30F;
        EXPECT_EQ(effects::without_effect_in(light), 0U) << channel;
    }
    light.lamp_strength = 1e-30F;
    EXPECT_EQ(effects::without_effect_in(light), 0U);
    light.lamp_strength = light.sun_light.r = std::nanf("");
    EXPECT_EQ(effects::without_effect_in(light), 0U) << "what is no number is left as it is";
}

TEST(EffectsByLight, GoInGroupsOfTheModelsEffects) {
    const std::vector<model::EffectMask> all = effects::groups_by_light(~model::EffectMask{0});
    EXPECT_EQ(all, (std::vector<model::EffectMask>{no_sun, by_lamps}));
    EXPECT_EQ(effects::groups_by_light(model::effect_sun | model::effect_shadow),
              (std::vector<model::EffectMask>{model::effect_shadow}));
    EXPECT_TRUE(effects::groups_by_light(model::effect_sun | model::effect_fog | model::effect_sky).empty());
}

}  // namespace
}  // namespace surefoot
