// What the display itself reports of pictures: its own figures in JSON and table, apart from the records.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/report/report.hpp"

namespace surefoot::report {
namespace {

TEST(DisplaySummary, StandsApartInJsonAndTable) {
    WalkSummary s;
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["display"].is_null()) << "it reported nothing";
    EXPECT_EQ(to_table(s, false).find("until the display showed it"), std::string::npos);
    s.display.pictures = 190;
    s.display.replaced = 10;
    s.display.after_ms.p50 = 8.25;
    s.display.after_ms.p99 = 15.5;
    s.display.after_ms.max = 33;
    const auto json = nlohmann::json::parse(to_json(s));
    EXPECT_TRUE(json["shown_by"].is_null()) << "the records do not know of it";
    EXPECT_EQ(json["display"]["pictures"], 190);
    EXPECT_EQ(json["display"]["replaced"], 10);
    EXPECT_EQ(json["display"]["after_ms"]["p50"], 8.25);
    EXPECT_EQ(json["display"]["after_ms"]["p99"], 15.5);
    EXPECT_EQ(json["display"]["after_ms"]["max"], 33);
    EXPECT_NE(to_table(s, false).find("until the display showed it"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::report
