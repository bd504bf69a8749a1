// What a summary says of the seat, and of steal that only the cores show.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "rt/base/file.hpp"
#include "tests/report/records.hpp"
#include "tests/temporary_folder.hpp"
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
    EXPECT_NE(to_table(s, false).find("60 cm wide at 70 cm: 46.4 x 27.1 degrees; acuity 1 arcmin"), std::string::npos);
}

TEST(CoreStealOfASummary, IsCountedWhereTheKernelSaysItAndAbsentElsewhere) {
    std::vector<rt::FrameRecord> frames = frames_with_a_miss();
    WalkSummary s;
    summarize(frames, period_ns, s);
    EXPECT_TRUE(nlohmann::json::parse(to_json(s))["core_steal_misses"].is_null());
    frames[0].core_steal_ns = 0;
    summarize(frames, period_ns, s);
    EXPECT_EQ(nlohmann::json::parse(to_json(s))["core_steal_misses"], 0);
    frames[1].core_steal_ns = 20'000'000;
    frames[1].by_core_steal = true;
    frames[1].own_miss = false;
    frames[1].cause = rt::Cause::stolen;
    summarize(frames, period_ns, s);
    EXPECT_EQ(nlohmann::json::parse(to_json(s))["core_steal_misses"], 1);

    const test::TemporaryFolder folder;
    ASSERT_TRUE(write_ledger(folder / "ledger.csv", frames).ok());
    const auto ledger = read_text(folder / "ledger.csv");
    ASSERT_TRUE(ledger.ok());
    EXPECT_NE(ledger->find(",preempted_us,core_steal_us,by_core_steal,waited_us,"), std::string::npos);
    EXPECT_NE(ledger->find(",0.000,20000,1,0.000,"), std::string::npos) << "microseconds";
    EXPECT_NE(ledger->find(",0.000,,,0.000,"), std::string::npos) << "nobody said";
}

}  // namespace
}  // namespace surefoot::report
