// The sun's direction beside what an almanac says.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/model/sun_time.hpp"

namespace surefoot::model {
namespace {

double altitude_deg(const SunTime& time) { return std::asin(towards_sun(time).y) * 180 / std::numbers::pi; }

TEST(SunTime, StandsWhereAnAlmanacSays) {
    EXPECT_NEAR(altitude_deg({12, 80, 0}), 90, 0.6) << "equinox at the equator";
    EXPECT_NEAR(altitude_deg({12, 172, 52.5}), 60.9, 0.5) << "Berlin, 21 June";
    EXPECT_NEAR(altitude_deg({12, 355, 52.5}), 14.1, 0.5) << "Berlin, 21 December";
    EXPECT_NEAR(altitude_deg({0, 172, 80}), 13.4, 0.5) << "a midnight sun";
    EXPECT_LT(altitude_deg({0, 172, 50}), 0);
    EXPECT_NEAR(altitude_deg({18, 80, 50}), 0, 0.5) << "it sets at six";
}

TEST(SunTime, RisesInTheEastAndIsInTheSouthAtNoonOfTheNorth) {
    const dvec3 morning = towards_sun({8, 172, 50}), noon = towards_sun({12, 172, 50}), evening = towards_sun({16, 172, 50});
    EXPECT_GT(morning.x, 0.5);
    EXPECT_NEAR(noon.x, 0, 1e-12);
    EXPECT_GT(noon.z, 0.3) << "+Z is south";
    EXPECT_LT(evening.x, -0.5);
    EXPECT_NEAR(morning.y, evening.y, 1e-12);
    EXPECT_LT(towards_sun({12, 172, -35}).z, -0.3) << "in the north at noon of the south";
    for (int hour = 0; hour < 24; ++hour) EXPECT_NEAR(glm::length(towards_sun({hour + 0.5, 1, 90})), 1, 1e-12);
}

}  // namespace
}  // namespace surefoot::model
