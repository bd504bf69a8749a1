// What a walk leaves and refuses: outputs asked for beforehand, one failure that spoils no other, strictness, coarse frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "render/capture/capture.hpp"
#include "rt/base/file.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/real_time.hpp"
#include "tools/walk/snapshots.hpp"
#include "tools/walk/walk_results.hpp"

namespace surefoot {
namespace {

namespace fs = std::filesystem;

std::string in_forest(const std::string& name) { return test::Forest::get().dir + "/" + name; }

std::string refusal(const walk::WalkRequest& request) {
    bool walked = false;
    Progress progress;
    progress.report = [&](std::string_view stage, double) { walked |= stage == "walk"; };
    auto outcome = walk::run_walk(request, progress);
    EXPECT_FALSE(walked) << "refused only after the walk";
    return outcome.ok() ? std::string() : outcome.error().text();
}

TEST(WalkOutputs, HaveTheirPlacesCheckedBeforeTheWalk) {
    const walk::WalkRequest good = test::Forest::get().virtual_request(5);
    ASSERT_TRUE(write_text(in_forest("plain"), "kept").ok());
    const auto refused = [&](const std::function<void(walk::WalkRequest&)>& change) {
        walk::WalkRequest request = good;
        change(request);
        return refusal(request);
    };
    EXPECT_NE(refused([](auto& r) { r.ledger_file = "/nonexistent/l.csv"; }).find("--ledger /nonexistent/l.csv"),
              std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.trace_file = in_forest(""); }).find("--trace"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.capture_file = "/nonexistent/c"; }).find("--capture"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.report_dir = in_forest("plain"); }).find("--report"), std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.report_dir = in_forest("plain") + "/below"; }).find("--report"), std::string::npos);
    EXPECT_NE(refused([](auto& r) {
                  r.snap_dir = in_forest("plain");
                  r.backend = "egl";
              }).find("--snap"),
              std::string::npos);
    EXPECT_NE(refused([](auto& r) { r.snap_dir = in_forest("pictures"); }).find("null"), std::string::npos);
    EXPECT_EQ(*read_text(in_forest("plain")), "kept");
    EXPECT_FALSE(fs::exists(in_forest("pictures")));
}

TEST(WalkOutputs, NeverReplaceWhatIsReadNorEachOther) {
    walk::WalkRequest request = test::Forest::get().virtual_request(5);
    request.ledger_file = request.model_file;
    EXPECT_NE(refusal(request).find("reads"), std::string::npos);
    request.ledger_file = fs::path(request.model_file).replace_extension(".path.csv").string();
    request.path_file.clear();
    EXPECT_NE(refusal(request).find("reads"), std::string::npos);
    request.ledger_file = in_forest("both");
    request.trace_file = test::Forest::get().dir + "/./both";
    EXPECT_NE(refusal(request).find("written by --ledger"), std::string::npos);
}

TEST(WalkOutputs, OneThatFailsAtTheEndSpoilsNoOther) {
    walk::WalkRequest request = test::Forest::get().virtual_request(200);
    fs::create_directories(in_forest("gone"));
    request.ledger_file = in_forest("gone/l.csv");
    request.trace_file = in_forest("t.json");
    request.capture_file = in_forest("c.cap");
    request.capture_frame = 7;
    request.report_dir = in_forest("page");
    Progress progress;
    progress.report = [](std::string_view stage, double) {
        std::error_code ignored;
        if (stage == "walk") fs::remove_all(in_forest("gone"), ignored);
    };
    auto outcome = walk::run_walk(request, progress);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_EQ(outcome->summary.frames, 200U);
    ASSERT_EQ(outcome->failures.size(), 1U);
    EXPECT_NE(outcome->failures[0].text().find("gone/l.csv"), std::string::npos);
    for (const auto* name : {"t.json", "c.cap", "page/index.html", "page/ledger.csv"})
        EXPECT_TRUE(fs::exists(in_forest(name))) << name;
    auto captured = capture::read_capture(in_forest("c.cap"));
    ASSERT_TRUE(captured.ok());
    EXPECT_EQ(captured->frame, 7U);
}

TEST(WalkOutputs, AStoppedWalkSumsUpWhatRan) {
    walk::WalkRequest request = test::Forest::get().virtual_request(2'000'000);
    request.ledger_file = in_forest("stopped.csv");
    std::atomic<bool> stop{false};
    Progress progress;
    progress.stop = &stop;
    int updates = 0;  // every 5 ms: a busy machine may let the first frame wait for some
    progress.report = [&](std::string_view stage, double) {
        if (stage == "walk" && ++updates > 60) stop.store(true);
    };
    auto outcome = walk::run_walk(request, progress);
    ASSERT_TRUE(outcome.ok());
    EXPECT_TRUE(outcome->stopped);
    EXPECT_GT(outcome->summary.frames, 0U);
    EXPECT_LT(outcome->summary.frames, 2'000'000U);
    const std::string ledger = *read_text(request.ledger_file);
    EXPECT_EQ(static_cast<std::uint64_t>(std::count(ledger.begin(), ledger.end(), '\n')), outcome->summary.frames + 1);
}

TEST(WalkOutputs, MoreFramesThanAreKeptAndFramesThatAreNotThereAreRefused) {
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    request.seconds = 1e6;
    EXPECT_NE(refusal(request).find("at most"), std::string::npos);
    request.seconds = 1;
    request.capture_file = in_forest("none.cap");
    request.capture_frame = 30;
    EXPECT_NE(refusal(request).find("--capture-frame 30"), std::string::npos);
    EXPECT_FALSE(fs::exists(request.capture_file));
}

TEST(Snaps, AreCappedByMemoryAndTheCapIsReported) {
    walk::WalkRequest request;
    request.snap_dir = "pictures";
    request.snap_every = 1;
    std::vector<std::string> notes;
    constexpr std::size_t items = 60'000;  // about half a megabyte a picture
    const std::size_t fit = walk::snapshots_that_fit(items, false);
    EXPECT_LE(fit * items * sizeof(gl::DrawItem), walk::snapshot_memory_bytes);
    const walk::SnapshotStore all = walk::make_snapshot_store(request, fit, items, notes);
    EXPECT_EQ(all.snapshots().size(), fit);
    EXPECT_TRUE(notes.empty());
    const walk::SnapshotStore capped = walk::make_snapshot_store(request, 3 * fit, items, notes);
    EXPECT_EQ(capped.snapshots().size(), fit);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("--every 3"), std::string::npos) << notes[0];
    request.snap_every = 3;
    notes.clear();
    EXPECT_EQ(walk::make_snapshot_store(request, 3 * fit, items, notes).snapshots().size(), fit);
    EXPECT_TRUE(notes.empty()) << "the remedy that was named must work";
    EXPECT_EQ(walk::snapshots_that_fit(1U << 30U, true), 1U);
}

TEST(Strict, NamesEveryLackWithItsRemedy) {
    EXPECT_TRUE(walk::require_real_time({}).ok());
    const std::vector<rt::Lack> lacks = {{rt::LackKind::fifo, "FIFO is refused", "grant rtprio"},
                                         {rt::LackKind::isolated_core, "no isolated core", "isolcpus"},
                                         {rt::LackKind::cost_table, "no table", ""}};
    const auto refused = walk::require_real_time(lacks);
    ASSERT_FALSE(refused.ok());
    for (const auto* part : {"--strict", "FIFO is refused", "grant rtprio", "no isolated core", "isolcpus", "no table"})
        EXPECT_NE(refused.error().text().find(part), std::string::npos) << part;
}

TEST(Strict, RefusesAMissingCostTableAndOrdinaryScheduling) {
    walk::WalkRequest request = test::Forest::get().virtual_request(5);  // no table in its state folder
    request.clock = rt::ClockKind::real;
    request.strict = true;
    request.fifo = false;
    const std::string text = refusal(request);
    EXPECT_NE(text.find("no cost table"), std::string::npos) << text;
    EXPECT_NE(text.find("calibrate"), std::string::npos) << text;
    EXPECT_NE(text.find("--no-fifo"), std::string::npos) << text;
    request.clock = rt::ClockKind::virtual_time;
    EXPECT_NE(refusal(request).find("--strict"), std::string::npos);
}

TEST(VirtualWalk, AMissingCostTableMarksTheFiguresAndIsNoLackOfRealTime) {
    auto outcome = walk::run_walk(test::Forest::get().virtual_request(5), {});
    ASSERT_TRUE(outcome.ok());
    EXPECT_NE(outcome->summary.uncalibrated.find("surefoot calibrate"), std::string::npos);
    EXPECT_TRUE(outcome->summary.degraded.empty());
}

TEST(VirtualWalk, PreparedAgeIsTheTrueOne) {
    auto outcome = walk::run_walk(test::Forest::get().virtual_request(20), {});
    ASSERT_TRUE(outcome.ok());
    EXPECT_EQ(outcome->records[0].prepared_age, 0U) << "made for the first frame itself";
    for (std::size_t i = 1; i < outcome->records.size(); ++i) EXPECT_EQ(outcome->records[i].prepared_age, 1U) << i;
}

TEST(VirtualWalk, FramesDrawnWhollyCoarseReportWhatTheyDrewAndWereToCost) {
    walk::WalkRequest request = test::Forest::get().virtual_request(60);
    auto path = read_path(request.path_file);
    ASSERT_TRUE(path.ok());
    Path jump;  // a jump that no region of poses covers
    for (const double t : {0.0, 1.0, 1.001, 3.0}) {
        PathSample sample = path->samples[t <= 1.0 ? 0 : path->samples.size() / 2];
        if (t > 1.0) sample.pose.position += dvec3(50, 20, 50);
        sample.time_s = t;
        jump.samples.push_back(sample);
    }
    request.path_file = in_forest("jump.csv");
    ASSERT_TRUE(write_path(request.path_file, jump).ok());
    auto outcome = walk::run_walk(request, {});
    ASSERT_TRUE(outcome.ok());
    std::uint32_t coarse = 0;
    for (const rt::FrameRecord& r : outcome->records) {
        if (r.candidates > 0) continue;  // selected as usual
        ++coarse;
        EXPECT_GT(r.triangles, 0U);
        EXPECT_GT(r.predicted_us, 0.0F);
        EXPECT_NEAR(r.predicted_us / r.correction, r.actual_us, 0.01F * r.actual_us);
    }
    EXPECT_GT(coarse, 0U) << "the path must jump, or the test shows nothing";
}

}  // namespace
}  // namespace surefoot
