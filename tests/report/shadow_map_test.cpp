// The summary counts shadow maps of what moves.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "tools/report/report.hpp"

namespace surefoot::report {
namespace {

TEST(Summary, CountsTheShadowMapsThatWereBoughtAndShown) {
    std::vector<rt::FrameRecord> frames(5);
    frames[1].shadow_refreshed = frames[1].shadow_shown = frames[2].shadow_shown = true;
    WalkSummary s;
    summarize(frames, 33'333'333, s);
    const auto json = nlohmann::json::parse(to_json(s))["shadow_map"];
    EXPECT_EQ(json["refreshes"], 1);
    EXPECT_EQ(json["shown_frames"], 2);
}

}  // namespace
}  // namespace surefoot::report
