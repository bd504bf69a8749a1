// The light of a moment: noon is the usual light, night is dark and has lamps, and nothing jumps between.
#include "render/model/daylight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace surefoot::model {
namespace {

/// A day at a place, and what it is.
struct Place {
    const char* name;
    double day, latitude_deg;
};
constexpr Place places[] = {{"summer", 172, 50},      {"winter", 355, 50},      {"equinox", 81, 0},
                            {"south", 172, -35},      {"polar day", 172, 80},   {"polar night", 355, 80},
                            {"the pole", 172, 90},    {"south pole", 172, -90}, {"pole at equinox", 81, 90},
                            {"white night", 172, 65}, {"short day", 355, 66},   {"last day", 366, -90}};

LightFacts facts_of(const Place& place) {
    LightFacts facts;
    facts.day = place.day;
    facts.latitude_deg = place.latitude_deg;
    facts.max_lamp_light = 3;
    return facts;
}

/// All numbers of a light, in one order.
std::vector<double> numbers_of(const Daylight& light) {
    std::vector<double> all;
    for (const vec3* v :
         {&light.sun_direction, &light.sun_light, &light.ground_light, &light.sky_light, &light.background, &light.pictures})
        for (int i = 0; i < 3; ++i) all.push_back((*v)[i]);
    all.insert(all.end(), {light.sun_between, light.lamp_strength, light.room_light, light.fog_density});
    return all;
}

/// The place in SunSeen's day: 1 at sunrise, 15 at sunset.
double moment_of(const Daylight& light) { return static_cast<double>(light.sun_moment) + static_cast<double>(light.sun_between); }

TEST(Daylight, AtAHighSunIsTheUsualLight) {
    const LightFacts facts = facts_of(places[0]);
    Daylight usual;
    const Daylight noon = daylight_at(12, facts);
    usual.sun_direction = vec3(towards_sun({12, facts.day, facts.latitude_deg}));
    usual.sun_between = noon.sun_between;
    const std::vector<double> expected = numbers_of(usual), found = numbers_of(noon);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-6) << i;
    EXPECT_EQ(noon.lamp_strength, 0) << "lamps are off";
    EXPECT_NEAR(moment_of(noon), 8, 1e-6) << "the middle of 15 moments";
}

TEST(Daylight, AtMidnightIsDarkAndHasItsLamps) {
    const Daylight night = daylight_at(0, facts_of(places[0])), usual;
    EXPECT_EQ(night.sun_light, vec3(0));
    EXPECT_EQ(night.lamp_strength, 3);
    LightFacts with_lamps = facts_of(places[0]);
    with_lamps.night_room_light = 0.4F;
    EXPECT_EQ(night.room_light, 1) << "rooms have a light of their own";
    EXPECT_EQ(daylight_at(0, with_lamps).room_light, 0.4F);
    EXPECT_EQ(daylight_at(12, with_lamps).room_light, 1);
    for (int i = 0; i < 3; ++i) {
        EXPECT_LT(night.sky_light[i], 0.25F * usual.sky_light[i]);
        EXPECT_LT(night.ground_light[i], 0.25F * usual.ground_light[i]);
        EXPECT_GT(night.sky_light[i], 0) << "never black";
        EXPECT_LE(night.background[i], 0.1F);
        EXPECT_LT(night.pictures[i], 0.25F);
        EXPECT_GT(night.pictures[i], 0);
    }
}

TEST(Daylight, OfTheModelIsTheSunOfTheBakeWithoutLamps) {
    LightFacts facts = facts_of(places[0]);
    facts.fog_visibility_m = 200;
    const Daylight light = daylight_of_model({0, 3, 4}, facts);
    EXPECT_NEAR(light.sun_direction.y, 0.6, 1e-6);
    EXPECT_EQ(light.lamp_strength, 0);
    EXPECT_EQ(light.sun_moment, 0U) << "the first share is that of the model's own sun";
    EXPECT_EQ(light.sun_between, 0);
    EXPECT_NEAR(std::exp2(-200 * light.fog_density), 0.05, 1e-6);
    EXPECT_EQ(daylight_at(7, facts).fog_density, light.fog_density);
}

TEST(Daylight, IsFiniteAndInRangeAtEveryHourAndPlace) {
    for (const Place& place : places) {
        const LightFacts facts = facts_of(place);
        std::vector<double> hours{-3, 24, 1000, -1e-20, 1e9, -1e9, 12, 0};
        for (int i = 0; i <= 480; ++i) hours.push_back(0.05 * i);
        for (std::uint32_t i = 0; i < sun_moments; ++i) hours.push_back(hour_of_moment(i, place.day, place.latitude_deg));
        for (const double hour : hours) {
            const Daylight light = daylight_at(hour, facts);
            const std::vector<double> numbers = numbers_of(light);
            for (std::size_t i = 0; i < numbers.size(); ++i) {
                EXPECT_TRUE(std::isfinite(numbers[i])) << place.name << ' ' << hour << ": " << i;
                if (i < 3) continue;  // the sun's direction
                EXPECT_GE(numbers[i], 0) << place.name << ' ' << hour << ": " << i;
            }
            EXPECT_NEAR(glm::length(light.sun_direction), 1, 1e-5) << place.name << ' ' << hour;
            EXPECT_GE(light.sun_moment, 1U) << place.name << ' ' << hour;
            EXPECT_LT(light.sun_moment, sun_moments) << place.name << ' ' << hour << ": it and the next one are read";
            EXPECT_LE(light.sun_between, 1) << place.name << ' ' << hour;
            EXPECT_LE(light.lamp_strength, 3) << place.name << ' ' << hour;
        }
    }
}

TEST(Daylight, ComesRoundAgainEveryDay) {
    for (const Place& place : places) {
        const LightFacts facts = facts_of(place);
        for (const auto& [hour, same] : {std::pair{-3.0, 21.0}, {24.0, 0.0}, {1000.0, 16.0}, {-27.5, 20.5}}) {
            EXPECT_EQ(numbers_of(daylight_at(hour, facts)), numbers_of(daylight_at(same, facts))) << place.name << ' ' << hour;
            EXPECT_EQ(daylight_at(hour, facts).sun_moment, daylight_at(same, facts).sun_moment) << place.name << ' ' << hour;
        }
    }
}

/// Where the sun shines, nothing that a vertex is given jumps: neither the light nor the place between two moments.
TEST(Daylight, GoesOnWithoutAJump) {
    constexpr double step_h = 1.0 / 240;
    for (const Place& place : places) {
        const LightFacts facts = facts_of(place);
        const double half_h = 12 - hour_of_moment(0, place.day, place.latitude_deg);
        const double by_step = 1.01 * step_h * 7 / half_h + 1e-5;  // 14 moments from sunrise to sunset
        Daylight last = daylight_at(0, facts);
        for (double hour = step_h; hour < 24; hour += step_h) {
            const Daylight light = daylight_at(hour, facts);
            EXPECT_GE(moment_of(light), moment_of(last) - 1e-5) << place.name << ' ' << hour;
            EXPECT_LE(moment_of(light), moment_of(last) + by_step) << place.name << ' ' << hour;
            const std::vector<double> now = numbers_of(light), before = numbers_of(last);
            for (std::size_t i = 0; i < now.size(); ++i) {
                if (i == 18) continue;  // sun_between begins again with each moment; 19 is lamp_strength, up to 3
                EXPECT_NEAR(now[i], before[i], i == 19 ? 0.04 : 0.01) << place.name << ' ' << hour << ": " << i;
            }
            last = light;
        }
    }
}

TEST(Daylight, BetweenItsLastAndFirstMomentTheSunStandsTheSameOrDoesNotShine) {
    for (const Place& place : places) {
        const LightFacts facts = facts_of(place);
        const Daylight before = daylight_at(24 - 1e-9, facts), after = daylight_at(0, facts);
        const bool same = glm::length(before.sun_direction - after.sun_direction) < 1e-5F;
        EXPECT_TRUE(same) << place.name;
        const bool whole = hour_of_moment(0, place.day, place.latitude_deg) < 1e-9;  // share 15 is share 1, of the same hour
        EXPECT_TRUE(whole || after.sun_light.r < 0.01F) << place.name;
    }
}

TEST(Daylight, HasItsMomentsWhereTheHoursAre) {
    for (const Place& place : places) {
        const LightFacts facts = facts_of(place);
        for (std::uint32_t i = 0; i < sun_moments; ++i) {
            const double hour = hour_of_moment(i, place.day, place.latitude_deg);
            EXPECT_GE(hour, 0) << place.name;
            EXPECT_LE(hour, 24) << place.name;
            const double expected = hour == 24 ? 1 : 1.0 + i;  // the day's end is the next one's begin
            EXPECT_NEAR(moment_of(daylight_at(hour, facts)), expected, 1e-5) << place.name << " at moment " << i;
        }
    }
}

TEST(Daylight, RisesAndSetsWithTheFirstAndTheLastMoment) {
    for (const Place& place : {places[0], places[1], places[2], places[3]}) {
        for (const std::uint32_t i : {0U, sun_moments - 1}) {
            const double hour = hour_of_moment(i, place.day, place.latitude_deg);
            EXPECT_NEAR(towards_sun({hour, place.day, place.latitude_deg}).y, 0, 1e-9) << place.name << ' ' << i;
        }
    }
}

}  // namespace
}  // namespace surefoot::model
