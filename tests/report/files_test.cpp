// What a walk leaves on disk: ledger, trace, and pages that need nothing outside themselves.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "rt/base/file.hpp"
#include "tests/report/records.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/text_pieces.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/report/report.hpp"

namespace surefoot::report {
namespace {

namespace fs = std::filesystem;

class ReportFiles : public ::testing::Test {
protected:
    [[nodiscard]] std::string in(const std::string& name) const { return folder_ / name; }
    test::TemporaryFolder folder_;
};

TEST_F(ReportFiles, LedgerHasOneRowAFrameAndTheColumnsOfTheDesign) {
    auto records = frames_with_a_miss();
    records[3].control = true;
    records[1].input_stamp_ns = records[1].submitted_ns - 4'500'000;
    records[1].input_reports = 17;
    records[1].stopped = true;
    records[1].light = {{true, false, true, false}, 17.5F};
    records[1].dropped_parts[2] = {true, true, 0.125F};
    records[1].dropped_parts[0] = {true, false, 3};
    ASSERT_TRUE(write_ledger(in("l.csv"), records).ok());
    const auto lines = test::split(*read_text(in("l.csv")), '\n');
    ASSERT_EQ(lines.size(), records.size() + 1);
    const auto names = test::split(lines[0], ',');
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << "a column twice";
    for (const auto* wanted :
         {"wake_us", "select_us", "submit_us", "raster_us", "present_us", "slack_us", "predicted_us", "actual_us", "nodes",
          "triangles", "accuracy", "value", "switches", "cause", "waited_us", "preempted_us"})
        EXPECT_NE(std::find(names.begin(), names.end(), wanted), names.end()) << wanted;
    std::map<std::string, std::string> miss;
    const auto cells = test::split(lines[2], ',');
    ASSERT_EQ(cells.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) miss[names[i]] = cells[i];
    EXPECT_EQ(miss["wake_us"], "50.000");
    EXPECT_EQ(miss["select_us"], "500.000");
    EXPECT_EQ(miss["slack_us"], "-16666.667");
    EXPECT_EQ(miss["frame_us"], "50000.000");
    EXPECT_EQ(miss["cause"], "raster");
    EXPECT_EQ(miss["missed"], "1");
    EXPECT_EQ(miss["triangles"], "5000");
    EXPECT_EQ(miss["input_age_us"], "4500.000");
    EXPECT_EQ(miss["input_reports"], "17");
    EXPECT_EQ(miss["stopped"], "1");
    EXPECT_EQ(miss["cut_hash"], "0000000000001235");
    EXPECT_EQ(miss["sunlight"] + miss["shadows"] + miss["lamps"] + miss["fog"], "1010");
    EXPECT_EQ(miss["hour"], "17.5000");
    EXPECT_EQ(miss["dropped_parts"], "sunlight lamps");
    EXPECT_EQ(miss["fell_at"], "lamps:0.125") << "the sunlight went before";
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), "hour") - names.begin());
    EXPECT_EQ(test::split(lines[1], ',').at(at), "") << "the model's own light";
    for (const auto& line : lines) EXPECT_EQ(test::split(line, ',').size(), names.size());
}

TEST_F(ReportFiles, TraceParsesAndHasOneFrameEventARecord) {
    auto records = frames_with_a_miss();
    records[3].control = true;
    ASSERT_TRUE(write_trace(in("t.json"), records).ok());
    const auto trace = nlohmann::json::parse(*read_text(in("t.json")));
    std::map<std::string, int> counts;
    for (const auto& event : trace["traceEvents"]) {
        if (event["ph"] == "M") continue;
        ++counts[event.value("cat", "")];
        EXPECT_GE(event["ts"].get<double>(), 0.0);
        if (event["ph"] == "X") {
            EXPECT_GE(event["dur"].get<double>(), 0.0);
        }
        if (event.value("cat", "") == "miss") {
            EXPECT_EQ(event["name"], "raster");
            EXPECT_NEAR(event["args"]["late_us"].get<double>(), 16666.7, 0.1);
        }
    }
    EXPECT_EQ(counts["frame"], 4);
    EXPECT_EQ(counts["expected"], 4);
    EXPECT_EQ(counts["phase"], 5 * 3) << "the bare loop has no phases";
    EXPECT_EQ(counts["miss"], 1);
    EXPECT_EQ(counts["skipped"], 1);
}

TEST_F(ReportFiles, EmptyWalkStillMakesReadableFiles) {
    ASSERT_TRUE(write_trace(in("t.json"), {}).ok());
    EXPECT_TRUE(nlohmann::json::accept(*read_text(in("t.json"))));
    WalkSummary s;
    summarize({}, period_ns, s);
    ASSERT_TRUE(write_report(in("r"), s, {}, {}).ok());
    EXPECT_NE(read_text(in("r/index.html"))->find("No frame was drawn."), std::string::npos);
}

ReportSnapshot snapshot_of(std::uint64_t frame) {
    ReportSnapshot snapshot;
    snapshot.frame = frame;
    snapshot.width = 8;
    snapshot.height = 4;
    snapshot.walk.assign(8 * 4 * 4, 90);
    snapshot.full.assign(8 * 4 * 4, 100);
    snapshot.difference.assign(8 * 4 * 4, 40);
    snapshot.snr_db = 12.5;
    snapshot.ssim = 0.9;
    snapshot.triangles = 100;
    snapshot.full_triangles = 400;
    snapshot.drawn = {{0, 0, 4, 4, 0, 0.2F}, {1, 1, 2, 2, 1, 1.0F}, {std::numeric_limits<float>::quiet_NaN(), 0, 1, 1, 1, 1}};
    snapshot.forward = {0, 0, -1};
    snapshot.world_xz = {-5, -5, 5, 5};
    return snapshot;
}

TEST_F(ReportFiles, PageNeedsNothingOutsideItself) {
    WalkSummary s;
    auto records = frames_with_a_miss();
    summarize(records, period_ns, s);
    s.model = "forest.walk";
    s.degraded = {{rt::LackKind::fifo, "FIFO refused", "grant rtprio"}};
    s.control.ran = true;
    s.control.blocks.resize(4);
    s.picture = {.frames = 2, .psnr_db = 31.25, .worst_psnr_db = 27.5, .worst_frame = 120, .ssim = 0.987, .flip = 0.021};
    s.unused_ms = quantiles({4.0, 6.0});
    s.coarse_frames = 17;
    s.floor_frames = 3;
    const std::vector<ReportSnapshot> snapshots = {snapshot_of(0), snapshot_of(2)};
    ASSERT_TRUE(write_report(in("r"), s, records, snapshots).ok());
    const auto page = *read_text(in("r/index.html"));
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("url("), std::string::npos);
    EXPECT_EQ(page.find("@import"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos) << "a figure that is none";
    EXPECT_EQ(test::count_of(page, "data:image/jpeg;base64,"), 6U);
    EXPECT_EQ(test::count_of(page, "<svg"), test::count_of(page, "</svg>"));
    EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
    EXPECT_NE(page.find("4 frames, 1 missed"), std::string::npos);
    EXPECT_NE(page.find("grant rtprio"), std::string::npos);
    for (const auto* part : {"31.2", "SSIM 0.987, FLIP 0.021; worst 27.5 dB, frame 120", "Unused time", "5.0", "in 17 frames",
                             "shown without need in 3"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_TRUE(fs::exists(in("r/ledger.csv")));
    EXPECT_TRUE(nlohmann::json::accept(*read_text(in("r/walk.json"))));
}

TEST_F(ReportFiles, ThePageShowsTheImageCacheWhereThereIsOne) {
    auto records = good_frames(4);
    records[2].pictures = 100;
    records[2].pictures_made = 3;
    records[2].pictures_reused = 97;
    records[2].boxes_as_triangles = 41;
    records[2].picture_bytes = 3U << 20U;
    WalkSummary s;
    summarize(records, period_ns, s);
    EXPECT_DOUBLE_EQ(s.pictures.reused_mean, 97.0 / 4);
    EXPECT_DOUBLE_EQ(s.pictures.as_triangles_mean, 41.0 / 4);
    EXPECT_NE(to_table(s, false).find("25.0 pictures a frame, 24.2 of them reused; 3 made"), std::string::npos)
        << to_table(s, false);
    ReportSnapshot snapshot = snapshot_of(1);
    snapshot.birds_eye.assign(4U * 20 * 20, 128);
    snapshot.birds_eye_px = 20;
    snapshot.new_pictures = 3;
    snapshot.boxes_as_triangles = 41;
    ASSERT_TRUE(write_report(in("r"), s, records, std::vector<ReportSnapshot>{snapshot}).ok());
    const auto page = *read_text(in("r/index.html"));
    EXPECT_NE(page.find("Red: 3 new pictures. White: 0 reused. Black: 41 boxes"), std::string::npos);
    EXPECT_NE(page.find("What the image cache does"), std::string::npos) << "the chart";
    EXPECT_EQ(test::count_of(page, "data:image/jpeg;base64,"), 4U);
    const auto lines = test::split(*read_text(in("r/ledger.csv")), '\n');
    const auto names = test::split(lines[0], ','), cells = test::split(lines[3], ',');
    for (const auto& [name, value] : {std::pair{"pictures_reused", "97"}, {"boxes_as_triangles", "41"}}) {
        const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        ASSERT_LT(at, names.size()) << name;
        EXPECT_EQ(cells[at], value) << name;
    }
    summarize(good_frames(4), period_ns, s);
    ASSERT_TRUE(write_report(in("r"), s, good_frames(4), std::vector<ReportSnapshot>{snapshot_of(1)}).ok());
    EXPECT_EQ(read_text(in("r/index.html"))->find("mage cache"), std::string::npos);
}

TEST_F(ReportFiles, NamesCannotBreakThePage) {
    WalkSummary s;
    summarize(good_frames(2), period_ns, s);
    s.model = "<img src=x onerror=alert(1)>.walk";
    s.renderer = "\"quoted\" & <b>";
    ASSERT_TRUE(write_report(in("r"), s, good_frames(2), {}).ok());
    const auto page = *read_text(in("r/index.html"));
    EXPECT_EQ(page.find("<img src=x"), std::string::npos);
    EXPECT_EQ(page.find("& <b>"), std::string::npos);
}

TEST_F(ReportFiles, PicturesOfTheNullBackendMayBeMissing) {
    WalkSummary s;
    const auto records = good_frames(3);
    summarize(records, period_ns, s);
    ReportSnapshot snapshot = snapshot_of(1);
    snapshot.walk.clear();
    snapshot.full.clear();
    snapshot.difference.clear();
    ASSERT_TRUE(write_report(in("r"), s, records, std::vector<ReportSnapshot>{snapshot}).ok());
    const auto page = *read_text(in("r/index.html"));
    EXPECT_EQ(page.find("<img"), std::string::npos);
    EXPECT_NE(page.find("nodes drawn"), std::string::npos);
}

TEST_F(ReportFiles, UnwritablePlaceIsNamed) {
    ASSERT_TRUE(write_text(in("file"), "x").ok());
    WalkSummary s;
    const auto written = write_report(in("file"), s, {}, {});
    ASSERT_FALSE(written.ok());
    EXPECT_NE(written.error().text().find(in("file")), std::string::npos);
    EXPECT_EQ(*read_text(in("file")), "x");
}

TEST_F(ReportFiles, CostPlotDoesNotDivideByZero) {
    const auto none = cost_plot_svg("cost", {});
    EXPECT_EQ(none.find("nan"), std::string::npos);
    EXPECT_EQ(none.find("inf"), std::string::npos);
    const std::vector<CostPoint> one = {
        {"plain", 1, 1, 3.0}, {"plain", 1, 0, 3.0}, {"plain", 4, 16, std::numeric_limits<double>::infinity()}};
    const auto svg = cost_plot_svg("cost", one);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(test::count_of(svg, "<circle"), 1U);
}

TEST(Pictures, Base64IsPadded) {
    const std::vector<std::uint8_t> bytes = {'M', 'a', 'n'};
    EXPECT_EQ(base64(bytes), "TWFu");
    EXPECT_EQ(base64(std::span(bytes).first(2)), "TWE=");
    EXPECT_EQ(base64(std::span(bytes).first(1)), "TQ==");
    EXPECT_EQ(base64({}), "");
}

TEST(Pictures, WrongSizeIsNoPicture) {
    const std::vector<std::uint8_t> rgba(16 * 4);
    EXPECT_TRUE(jpeg_data_uri(rgba, 5, 4, 80).empty());
    EXPECT_TRUE(jpeg_data_uri({}, 0, 0, 80).empty());
    EXPECT_EQ(jpeg_data_uri(rgba, 4, 4, 80).rfind("data:image/jpeg;base64,/9j/", 0), 0U);
}

}  // namespace
}  // namespace surefoot::report
