// The seat: two lengths give the field of view and what the eye tells apart; one alone is refused.
#include "config/seat.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/config/toy_schema.hpp"

namespace surefoot::config {
namespace {

using test::toy_schema;

constexpr double degree = std::numbers::pi / 180;

Settings seated(double width_cm, double distance_cm) {
    Settings s;
    s.screen_width_cm = width_cm;
    s.eye_distance_cm = distance_cm;
    return s;
}

TEST(Seat, TheFieldOfViewIsTheScreensAngleAndFollowsThePicturesShape) {
    Settings s = seated(120, 60);
    s.width = 1600;
    s.height = 800;
    const auto seat = seat_of(s);
    ASSERT_TRUE(seat);
    EXPECT_NEAR(seat->fov_x_rad, 90 * degree, 1e-12);
    EXPECT_NEAR(seat->fov_y_rad, 2 * std::atan(0.5), 1e-12);
    s.shift_x = 2;
    EXPECT_EQ(seat_of(s)->fov_x_rad, seat->fov_x_rad) << "the next screen of a row is as wide";
    EXPECT_EQ(seat_text(*seat), "90.0 x 53.1 degrees");
}

TEST(Seat, WithoutALengthThereIsNone) {
    EXPECT_FALSE(seat_of(Settings()));
    EXPECT_FALSE(seat_of(seated(60, 0)));
    EXPECT_FALSE(seat_of(seated(0, 60)));
}

TEST(Seat, TheEyeTellsAnArcminuteApartWhereItSitsAndNothingIsKnownElsewhere) {
    EXPECT_EQ(acuity_rad(Settings()), 0);
    EXPECT_NEAR(acuity_rad(seated(10, 60)), degree / 60, 1e-15);
    Settings s = seated(10, 60);
    s.acuity_arcmin = 2.5;
    EXPECT_NEAR(acuity_rad(s), 2.5 * degree / 60, 1e-15);
    s = {};
    s.acuity_arcmin = 2.5;
    EXPECT_NEAR(acuity_rad(s), 2.5 * degree / 60, 1e-15) << "given by itself, it holds in the picture's own angles";
    s.min_accuracy = 10'000;
    EXPECT_NEAR(acuity_rad(s), 1e-4, 1e-15) << "a guarantee that is finer wins";
    s.min_accuracy = 10;
    EXPECT_NEAR(acuity_rad(s), 2.5 * degree / 60, 1e-15);
}

TEST(Seat, OneLengthAloneIsRefusedByItsOriginWithTheOther) {
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, "screen_width_cm = 60\n", "s.toml").ok());
    auto checked = check(c);
    ASSERT_FALSE(checked.ok());
    EXPECT_EQ(checked.error().text(),
              "screen_width_cm (s.toml:1): The field of view needs eye_distance_cm too. Set eye_distance_cm as well, or remove "
              "screen_width_cm.");
    EXPECT_EQ(checked.error().kind, ErrorKind::misuse);
    ASSERT_TRUE(set_value(c, "eye_distance_cm", "70").ok());
    EXPECT_TRUE(check(c).ok());
    ASSERT_TRUE(set_value(c, "screen_width_cm", "0").ok());
    checked = check(c);
    ASSERT_FALSE(checked.ok());
    EXPECT_NE(checked.error().place.find("eye_distance_cm (command line)"), std::string::npos);
}

TEST(Seat, WhatNoProjectionHoldsIsRefused) {
    const auto problem = [](double width_cm, double distance_cm, double shift_x) {
        Settings s = seated(width_cm, distance_cm);
        s.shift_x = shift_x;
        return seat_problem(s).has_value();
    };
    EXPECT_FALSE(problem(100, 1, 0)) << "88.9 degrees to each side";
    EXPECT_TRUE(problem(115, 1, 0));
    EXPECT_TRUE(problem(100, 1, 2)) << "the next screen reaches further";
    EXPECT_FALSE(problem(1, 300, 0));
    EXPECT_TRUE(problem(1, 600, 0));
}

TEST(Seat, ListingsSayTheFieldOfView) {
    Configuration c(toy_schema());
    EXPECT_EQ(explain(c).find("field of view of"), std::string::npos);
    ASSERT_TRUE(set_value(c, "screen_width_cm", "60").ok());
    ASSERT_TRUE(set_value(c, "eye_distance_cm", "70").ok());
    EXPECT_NE(explain(c).find("The seat gives a field of view of 46.4 x 27.1 degrees, in every pose.\n"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::config
