// Parts of the light that frames had no time for: counted, in the order in which they went, and printed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/report/records.hpp"
#include "tools/report/report.hpp"

namespace surefoot::report {
namespace {

TEST(Summary, NamesDroppedPartsOfTheLightInTheOrderInWhichTheyWent) {
    auto records = good_frames(10);
    constexpr std::size_t shadows = 1, lamps = 2, fog = 3;
    for (std::size_t i = 3; i < 6; ++i) records[i].dropped_parts[lamps] = {true, i == 3, 0.5F};
    for (std::size_t i = 7; i < 10; ++i) records[i].dropped_parts[lamps] = {true, i == 7, 0.25F};
    for (std::size_t i = 3; i < 5; ++i) records[i].dropped_parts[shadows] = {true, false, 0.125F};
    records[9].dropped_parts[fog] = {true, true, 4};
    records[9].control = true;
    WalkSummary s;
    for (int twice = 0; twice < 2; ++twice) {
        summarize(records, period_ns, s);
        ASSERT_EQ(s.dropped_parts.size(), 2U) << "a bare frame has no light";
        EXPECT_EQ(s.dropped_parts[0].part, "shadows") << "both went in one frame: the one of less value before";
        EXPECT_EQ(s.dropped_parts[0].frames, 2U);
        EXPECT_EQ(s.dropped_parts[0].falls, 1U) << "before the first frame";
        EXPECT_EQ(s.dropped_parts[0].first_value_per_us, 0.125);
        EXPECT_EQ(s.dropped_parts[1].part, "lamps");
        EXPECT_EQ(s.dropped_parts[1].frames, 5U);
        EXPECT_EQ(s.dropped_parts[1].falls, 2U);
        EXPECT_EQ(s.dropped_parts[1].first_frame, records[3].frame);
        EXPECT_EQ(s.dropped_parts[1].first_value_per_us, 0.5);
    }
    const auto json = nlohmann::json::parse(to_json(s))["dropped_parts"];
    EXPECT_EQ(json[1]["part"], "lamps");
    EXPECT_EQ(json[1]["times"], 2);
    EXPECT_NE(to_table(s, false).find("lamps in 5 frames, first in frame 3 at 0.5 px/us"), std::string::npos)
        << to_table(s, false);
}

}  // namespace
}  // namespace surefoot::report
