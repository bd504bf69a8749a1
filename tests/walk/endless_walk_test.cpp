// A walk without end hands every frame to its watch, keeps none, and ends when it is asked to.
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <vector>

#include "render/capture/capture.hpp"
#include "rt/base/path.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/tour_controller.hpp"

namespace surefoot::walk {
namespace {

using test::Forest;

TEST(EndlessWalk, HandsOverEveryFrameAndKeepsNone) {
    WalkRequest request = Forest::get().virtual_request(0);
    request.endless = true;
    auto path = read_path(request.path_file);
    ASSERT_TRUE(path.ok());
    for (auto& sample : path->samples) sample.time_s /= 4;  // its end comes sooner: less to draw, and as much to turn round at
    request.path_file = Forest::get().dir + "/fast.path.csv";
    ASSERT_TRUE(write_path(request.path_file, *path).ok());
    // Past the path's end, where it turns round.
    const std::uint64_t wanted = static_cast<std::uint64_t>(path->duration_s() * request.rate_hz * 1.25);

    std::atomic<bool> stop{false};
    std::atomic<int> started{0};
    std::vector<rt::FrameRecord> seen;
    std::vector<WalkStep> steps;
    WalkObserver observer;
    observer.on_step = [&](WalkStep step) { steps.push_back(step); };
    observer.on_started = [&](const WalkStart& start) {
        ++started;
        EXPECT_EQ(start.period_ns, 33'333'333);
        EXPECT_EQ(start.t0_ns, start.period_ns);
        EXPECT_EQ(start.path, request.path_file);
        EXPECT_NE(start.uncalibrated, "") << "there is no cost table";
    };
    observer.on_record = [&](const rt::FrameRecord& record) {
        seen.push_back(record);
        if (seen.size() == wanted) stop.store(true);
    };
    Progress progress;
    progress.stop = &stop;
    auto outcome = run_walk(request, progress, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_TRUE(outcome->stopped);
    EXPECT_TRUE(outcome->records.empty());
    EXPECT_EQ(outcome->summary.frames, 0U);
    EXPECT_EQ(started.load(), 1);
    ASSERT_GE(seen.size(), wanted);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        ASSERT_EQ(seen[i].frame, i);
        const Pose pose = pose_at(*path, static_cast<double>(seen[i].slot) / request.rate_hz);
        ASSERT_NEAR(seen[i].eye[0], pose.position.x, 1e-3) << "frame " << i;
        ASSERT_NEAR(seen[i].eye[2], pose.position.z, 1e-3) << "frame " << i;
    }
    const std::vector<WalkStep> whole = {WalkStep::request, WalkStep::real_time, WalkStep::input, WalkStep::model,
                                         WalkStep::device,  WalkStep::frames,    WalkStep::ending};
    EXPECT_EQ(steps, whole);
}

TEST(EndlessWalk, RefusesWhatNeedsItsFrames) {
    WalkRequest request = Forest::get().virtual_request(0);
    request.endless = true;
    request.ledger_file = Forest::get().dir + "/ledger.csv";
    auto outcome = run_walk(request, {});
    ASSERT_FALSE(outcome.ok());
    EXPECT_NE(outcome.error().what.find("none can be written"), std::string::npos) << outcome.error().text();
    request.ledger_file.clear();
    request.frames = 100;
    outcome = run_walk(request, {});
    ASSERT_FALSE(outcome.ok());
    EXPECT_NE(outcome.error().what.find("An endless walk cannot have"), std::string::npos) << outcome.error().text();
}

TEST(WatchedWalk, AnErrorBelongsToTheStepReportedLast) {
    WalkRequest request = Forest::get().virtual_request(10);
    request.model_file = Forest::get().dir + "/absent.walk";
    WalkStep last = WalkStep::request;
    WalkObserver observer;
    observer.on_step = [&](WalkStep step) { last = step; };
    EXPECT_FALSE(run_walk(request, {}, observer).ok());
    EXPECT_EQ(last, WalkStep::model);
}

TEST(WatchedWalk, HandsOverAMissedFrameThatReplays) {
    WalkRequest request = Forest::get().virtual_request(120);
    request.correct_costs = false;
    request.in_frame_check = false;
    WalkObserver observer;
    std::vector<capture::Capture> captures;
    std::set<std::uint64_t> missed;
    observer.on_missed_frame = [&](const capture::Capture& c) { captures.push_back(c); };
    observer.on_record = [&](const rt::FrameRecord& record) {
        if (record.missed) missed.insert(record.frame);
    };
    ASSERT_TRUE(run_walk(request, {}, observer).ok());
    EXPECT_TRUE(captures.empty()) << "frame " << captures[0].frame << " was in time";
    request.cost_scale = 2;
    ASSERT_TRUE(run_walk(request, {}, observer).ok());
    ASSERT_FALSE(captures.empty());
    for (const capture::Capture& c : captures) {
        EXPECT_TRUE(missed.contains(c.frame)) << c.frame;
        const auto same = capture::verify(c);
        EXPECT_TRUE(same.ok()) << same.error().text();
    }
    // The frame that was asked for goes first.
    captures.clear();
    request.capture_file = Forest::get().dir + "/asked.capture";
    request.capture_frame = 5;
    ASSERT_TRUE(run_walk(request, {}, observer).ok());
    EXPECT_TRUE(captures.empty());
}

TEST(WatchedWalk, SeesWhatIsKeptAndFaultsComeStageByStage) {
    const WalkRequest request = Forest::get().virtual_request(40);
    std::vector<std::uint64_t> seen;
    std::vector<FramePhase> phases;
    WalkObserver observer;
    observer.on_record = [&](const rt::FrameRecord& record) { seen.push_back(record.cut_hash); };
    observer.inject = [&](FramePhase phase, const rt::FrameRecord& record) {
        if (record.frame == 7) phases.push_back(phase);
        return Fault::none;
    };
    auto outcome = run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    ASSERT_EQ(seen.size(), 40U);
    ASSERT_EQ(outcome->records.size(), 40U);
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], outcome->records[i].cut_hash);
    const std::vector<FramePhase> in_order = {FramePhase::sample, FramePhase::select, FramePhase::submit, FramePhase::finish};
    EXPECT_EQ(phases, in_order);
}

TEST(WatchedWalk, ALostContextEndsItAndIsReported) {
    const WalkRequest request = Forest::get().virtual_request(40);
    WalkStep last = WalkStep::request;
    WalkObserver observer;
    observer.on_step = [&](WalkStep step) { last = step; };
    observer.inject = [](FramePhase phase, const rt::FrameRecord& record) {
        return phase == FramePhase::finish && record.frame == 7 ? Fault::context_lost : Fault::none;
    };
    auto outcome = run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_TRUE(outcome->lost);
    EXPECT_FALSE(outcome->stopped);
    EXPECT_EQ(outcome->summary.frames, 8U) << "what ran until then is summed up";
    ASSERT_EQ(outcome->failures.size(), 1U);
    EXPECT_NE(outcome->failures[0].text().find("lost"), std::string::npos);
    EXPECT_EQ(last, WalkStep::device);
}

}  // namespace
}  // namespace surefoot::walk
