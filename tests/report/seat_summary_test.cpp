// What a summary says of the seat.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/report/records.hpp"
#include "tools/report/report.hpp"

namespace surefoot::report {
namespace {

TEST(SeatOfASummary, IsWrittenWhereThereIsOne) {
    WalkSummary s;
    summarize(good_frames(2), period_ns, s);
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["seat"].is_null());
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["acuity_arcmin"].is_null());
    EXPECT_EQ(to_table(s, false).find("seat"), std::string::npos);
    s.seat = {true, 60, 70, 46.4, 27.1};
    s.acuity_arcmin = 1;
    const auto json = nlohmann::json::parse(to_json(s));
    for (const char* key : {"screen_width_cm", "eye_distance_cm", "fov_x_deg", "fov_y_deg"})
        EXPECT_TRUE(json["seat"].contains(key)) << key;
    EXPECT_EQ(json["seat"].size(), 4U);
    EXPECT_EQ(json["seat"]["fov_y_deg"], 27.1);
    EXPECT_EQ(json["acuity_arcmin"], 1);
    EXPECT_NE(to_table(s, false).find("60 cm wide at 70 cm: 46.4 x 27.1 degrees; the eye tells 1 arcmin apart"),
              std::string::npos);
}

}  // namespace
}  // namespace surefoot::report
