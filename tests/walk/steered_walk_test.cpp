// A recorded visitor on the virtual clock: the same walk every time, every report in the frame that it belongs to, rest at the
// end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/capture/capture.hpp"
#include "tests/walk/steered_fixture.hpp"
#include "tools/walk/input_session.hpp"

namespace surefoot {
namespace {

using test::at;
using test::eye;
using test::GamepadSession;
using test::orientation;
using test::steered_request;
using test::walk;

Pose start_of_path() { return read_path(test::Forest::get().path_file)->samples.front().pose; }

TEST(SteeredWalk, IsTheSameAtAnyWorkerCountAndAcrossRuns) {
    walk::WalkRequest request = steered_request(input::test::walk_and_turn(), "same");
    request.workers = 1;
    const walk::WalkOutcome first = walk(request);
    ASSERT_GT(first.records.size(), 200U);
    for (const int workers : {1, 2, 4}) {
        request.workers = workers;
        const walk::WalkOutcome again = walk(request);
        EXPECT_EQ(again.summary.cut_hash, first.summary.cut_hash) << workers << " workers";
        ASSERT_EQ(again.records.size(), first.records.size());
        for (std::size_t i = 0; i < first.records.size(); ++i) {
            ASSERT_EQ(again.records[i].eye, first.records[i].eye) << "frame " << i;
            ASSERT_EQ(again.records[i].orientation, first.records[i].orientation) << "frame " << i;
        }
    }
}

TEST(SteeredWalk, FollowsTheDevice) {
    const walk::WalkOutcome outcome = walk(steered_request(input::test::walk_and_turn(), "way"));
    ASSERT_GT(outcome.records.size(), 250U);
    const Pose start = start_of_path();
    EXPECT_LT(glm::length(eye(at(outcome, 0.3)) - start.position), 1e-6) << "it starts where the path does";
    // Three seconds forward at 1.4 m/s, less the moment of getting going; along the view.
    const dvec3 first_leg = eye(at(outcome, 3.7)) - eye(at(outcome, 0.3));
    EXPECT_NEAR(glm::length(first_leg), 4.2, 0.25);
    EXPECT_GT(glm::dot(glm::normalize(first_leg), start.forward()), 0.9999);
    // 1.35 s to the left at 1.2 rad/s: heading seen from above.
    const dvec3 before = orientation(at(outcome, 3.7)) * dvec3(0, 0, -1), after = orientation(at(outcome, 5.5)) * dvec3(0, 0, -1);
    const double turned = std::atan2(before.z * after.x - before.x * after.z, before.x * after.x + before.z * after.z);
    EXPECT_NEAR(turned, 1.35 * 1.2, 0.12);
    EXPECT_LT(glm::length(eye(at(outcome, 5.5)) - eye(at(outcome, 4.2))), 0.01) << "it turns on the spot";
    EXPECT_GT(glm::length(eye(at(outcome, 8.0)) - eye(at(outcome, 5.6))), 2.5);
}

TEST(SteeredWalk, FramesPrepareForWhereTheHandCanLead) {
    const walk::WalkOutcome outcome = walk(steered_request(input::test::walk_and_turn(), "foreseen"));
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_GT(r.candidates, 0U) << "frame " << r.frame << " left the region that it was prepared for";
        EXPECT_EQ(r.guard_violations, 0U);
    }
    EXPECT_EQ(outcome.summary.input.guard_violations, 0U);
}

TEST(SteeredWalk, OnTheGroundKeepsItsHeightAndIsForeseen) {
    walk::WalkRequest request = steered_request(input::test::walk_and_turn(), "on-foot");
    request.walking = rt::WalkingMode::automatic;
    request.eye_height_m = 1.6;
    const walk::WalkOutcome outcome = walk(request);
    EXPECT_TRUE(outcome.summary.input.walked);
    EXPECT_EQ(outcome.summary.input.returns, 0U);
    EXPECT_EQ(outcome.summary.input.guard_violations, 0U);
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_GT(r.candidates, 0U) << "frame " << r.frame << " left the region that it was prepared for";
        EXPECT_EQ(r.guard_violations, 0U);
    }
    EXPECT_GT(glm::length(eye(outcome.records.back()) - start_of_path().position), 2.0) << "it went somewhere";
    walk::WalkRequest flight = request;
    flight.walking = rt::WalkingMode::fly;
    EXPECT_FALSE(walk(flight).summary.input.walked);
}

TEST(SteeredWalk, TheRegionOfAPreparedFrameIsThePredictedPoseWidenedByItsUncertainty) {
    walk::WalkRequest request = steered_request(input::test::walk_and_turn(), "region");
    request.capture_file = test::Forest::get().dir + "/region.cap";
    const auto captured_at = [&](std::uint64_t frame) {
        request.capture_frame = frame;
        walk(request);
        auto taken = capture::read_capture(request.capture_file);
        EXPECT_TRUE(taken.ok());
        return taken.ok() ? taken->prepared.region : prepare::Region{};
    };
    const walk::WalkOutcome outcome = walk(request);
    const input::MotionLimits limits;
    // In full walk: where it will be three frames on, as uncertain as the limits of speed and acceleration leave it.
    const prepare::Region walking = captured_at(60);
    const double ahead_s = 3.0 / 30 + 1e-9 * static_cast<double>(walk::carry_limit_ns);
    EXPECT_NEAR(glm::length(walking.centre.position - eye(outcome.records[59])), limits.walk_m_s * ahead_s, 0.003);
    EXPECT_NEAR(walking.radius_m, limits.walk_m_s * ahead_s + 0.5 * limits.accel_m_s2 * ahead_s * ahead_s, 0.01);
    // At rest: what a hand that starts now can reach.
    const prepare::Region resting = captured_at(8);
    EXPECT_NEAR(resting.radius_m, 0.5 * limits.accel_m_s2 * ahead_s * ahead_s, 1e-6);
    EXPECT_GT(captured_at(150).angle_rad, resting.angle_rad + 0.1) << "turning is foreseen too";
}

TEST(SteeredWalk, TenThousandEventsAreInTheFramesTheyBelongToNoneLostNoneTwice) {
    const GamepadSession session = test::ten_thousand_events();
    const walk::WalkOutcome outcome = walk(steered_request(session, "events"));
    const auto& reports = session.recording().reports;
    ASSERT_EQ(reports.size(), 10'000U);
    EXPECT_EQ(outcome.summary.input.reports, 10'000U);
    EXPECT_EQ(outcome.summary.input.reports_shown, 10'000U);
    const std::int64_t start_ns = outcome.records.front().due_ns;
    for (const rt::FrameRecord& r : outcome.records) {
        const auto due_by_now = std::count_if(reports.begin(), reports.end(),
                                              [&](const auto& e) { return start_ns + e.time_us * 1000 <= r.woken_ns; });
        ASSERT_EQ(r.input_reports, static_cast<std::uint64_t>(due_by_now)) << "frame " << r.frame;
        ASSERT_EQ(r.input_stamp_ns, start_ns + reports[r.input_reports - 1].time_us * 1000) << "frame " << r.frame;
    }
    const double period_ms = 1000.0 / 30;
    EXPECT_LE(outcome.summary.input.age_ms.p50, 1.5 * period_ms);
    EXPECT_LE(outcome.summary.input.age_ms.p99, 2 * period_ms);
    EXPECT_GT(outcome.summary.input.age_ms.max, 0);
}

TEST(SteeredWalk, RestsWhenTheRecordingEndsAndEndsASecondLater) {
    GamepadSession session;
    session.report({}).hold({.forward = 1}, 2);  // cut off in full walk
    walk::WalkRequest request = steered_request(session, "cut");
    const walk::WalkOutcome outcome = walk(request);
    EXPECT_EQ(outcome.records.size(), 90U);
    EXPECT_GT(glm::length(eye(at(outcome, 2.0)) - eye(at(outcome, 1.9))), 0.1);
    EXPECT_LT(glm::length(eye(at(outcome, 2.9)) - eye(at(outcome, 2.2))), 1e-9);
    EXPECT_EQ(outcome.summary.input.timeouts, 1U);
    request.seconds = 5;
    EXPECT_EQ(walk(request).records.size(), 150U);
    request.frames = 20;
    EXPECT_EQ(walk(request).records.size(), 20U);
}

TEST(SteeredWalk, ButtonsLeadToViewpointsTourAndBack) {
    GamepadSession session;
    session.report({});
    session.hold({}, 0.2).press(GamepadSession::next_viewpoint);      // 0.2
    session.hold({}, 0.2).press(GamepadSession::tour).hold({}, 0.8);  // 0.6, to 1.6
    session.press(GamepadSession::pause).hold({}, 0.4);               // 1.6
    session.press(GamepadSession::reset).hold({}, 0.4);               // 2.2, to 2.8
    const walk::WalkOutcome outcome = walk(steered_request(session, "buttons"));
    const Path path = *read_path(test::Forest::get().path_file);
    const double duration_s = path.duration_s();
    EXPECT_LT(glm::length(eye(at(outcome, 0.5)) - sample_path(path, duration_s / walk::viewpoint_count).position), 1e-6);
    // The tour begins with the press at about 0.6 s, at the path's start.
    EXPECT_LT(glm::length(eye(at(outcome, 1.5)) - sample_path(path, 0.9).position), 0.1);
    EXPECT_GT(glm::length(sample_path(path, 0.9).position - sample_path(path, 0).position), 0.2) << "or the test shows nothing";
    EXPECT_LT(glm::length(eye(at(outcome, 2.1)) - eye(at(outcome, 1.7))), 1e-9) << "paused";
    EXPECT_LT(glm::length(eye(at(outcome, 2.7)) - path.samples.front().pose.position), 1e-6);
    const report::InputSummary& in = outcome.summary.input;
    EXPECT_EQ(in.next_viewpoint, 1U);
    EXPECT_EQ(in.tour, 1U);
    EXPECT_EQ(in.pause, 1U);
    EXPECT_EQ(in.reset, 1U);
    EXPECT_EQ(in.jumps, 3U);
    for (const rt::FrameRecord& r : outcome.records)
        EXPECT_GT(r.candidates, 0U) << "frame " << r.frame << " was drawn coarse: nothing was prepared for where it is";
}

TEST(SteeredWalk, ButtonsOnFootLeadWhereTheyLeadInFlight) {
    GamepadSession session;
    session.report({});
    session.hold({}, 0.2).press(GamepadSession::next_viewpoint);                   // 0.2
    session.hold({}, 0.2).press(GamepadSession::tour).hold({}, 0.8);               // 0.6, to 1.6
    session.press(GamepadSession::pause).hold({.forward = 1}, 0.4).hold({}, 0.2);  // 1.6: pushed while paused
    session.press(GamepadSession::reset).hold({}, 0.3);                            // 2.4, to 2.9
    session.hold({.forward = 1}, 1).hold({}, 0.3);                                 // 2.9, to 4.2
    walk::WalkRequest request = steered_request(session, "buttons-on-foot");
    const walk::WalkOutcome flight = walk(request);
    request.walking = rt::WalkingMode::automatic;
    const walk::WalkOutcome foot = walk(request);
    ASSERT_EQ(foot.records.size(), flight.records.size());
    for (std::size_t i = 0; i < 86; ++i)
        EXPECT_LT(glm::length(eye(foot.records[i]) - eye(flight.records[i])), 1e-9)
            << i << ": nobody pushes who is carried, or stands where a button put him";
    EXPECT_TRUE(foot.summary.input.walked);
    EXPECT_EQ(foot.summary.input.jumps, flight.summary.input.jumps);
    EXPECT_GT(glm::length(eye(at(foot, 4.1)) - eye(at(foot, 2.8))), 0.7) << "then the hand walks on";
    for (const rt::FrameRecord& r : foot.records) EXPECT_GT(r.candidates, 0U) << "frame " << r.frame;
}

TEST(SteeredWalk, AnEmergencyStopStandsStillAndIsReported) {
    walk::WalkRequest request = test::Forest::get().virtual_request(0);
    GamepadSession session;
    session.report({})
        .hold({.forward = 1}, 1)
        .hold({.forward = 1, .buttons = GamepadSession::fifth}, 0.2)
        .hold({.forward = 1}, 0.8);
    request.input_file = test::keep(session, "stop");
    request.steering_file = test::Forest::get().dir + "/stop.toml";
    ASSERT_TRUE(write_text(request.steering_file, R"([[device]]
name = "pad with a stop"
vendor = 0x1d50
[[device.axis]]
control = "y"
action = "forward"
invert = true
[[device.button]]
control = "button-5"
action = "stop"
)")
                    .ok());
    const walk::WalkOutcome outcome = walk(request);
    ASSERT_FALSE(outcome.records.empty());
    EXPECT_GT(glm::length(eye(at(outcome, 1.0)) - eye(at(outcome, 0.9))), 0.1);
    EXPECT_LT(glm::length(eye(at(outcome, 2.9)) - eye(at(outcome, 1.1))), 1e-9) << "latched: released is not reset";
    EXPECT_FALSE(at(outcome, 0.9).stopped);
    EXPECT_TRUE(at(outcome, 1.1).stopped);
    const report::InputSummary& in = outcome.summary.input;
    EXPECT_EQ(in.stops, 1U);
    EXPECT_TRUE(in.stop_latched);
    EXPECT_GT(in.stopped_frames, 55U);
    EXPECT_EQ(outcome.summary.misses, 0U) << "a stop is no miss";
    EXPECT_NE(report::to_table(outcome.summary, false).find("stood still for"), std::string::npos);
    EXPECT_NE(report::to_json(outcome.summary).find("\"stops\": 1"), std::string::npos);
    EXPECT_EQ(in.devices.at(0).mapping, "pad with a stop");
}

TEST(SteeredWalk, RefusalsNameFilePlaceAndRemedy) {
    const auto refused = [](const std::string& text, const std::string& steering = {}) {
        walk::WalkRequest request = test::Forest::get().virtual_request(5);
        request.input_file = test::Forest::get().dir + "/bad.hid";
        EXPECT_TRUE(write_text(request.input_file, text).ok());
        if (!steering.empty()) {
            request.steering_file = test::Forest::get().dir + "/bad.toml";
            EXPECT_TRUE(write_text(request.steering_file, steering).ok());
        }
        request.model_file = "absent.walk";  // never asked for: the input is looked at first
        auto outcome = walk::run_walk(request, {});
        if (outcome.ok()) return std::string();
        EXPECT_FALSE(outcome.error().remedy.empty()) << outcome.error().text();
        return outcome.error().text();
    };
    const auto expect_refusal = [&](const std::string& text, const std::string& what, const std::string& steering = {}) {
        const std::string refusal = refused(text, steering);
        EXPECT_NE(refusal.find(what), std::string::npos) << refusal;
    };
    const std::string good = input::test::walk_and_turn().text();
    const std::string head = good.substr(0, good.find("\nE:") + 1);
    expect_refusal("", "bad.hid: The recording has no R: line");
    expect_refusal(head, "bad.hid: The recording holds no reports");
    expect_refusal(good.substr(0, good.size() - 8), "bad.hid: line ");
    expect_refusal(good.substr(0, good.size() - 8), "cut off");
    expect_refusal("hello\n", "bad.hid: line 1");
    expect_refusal("R: 3 05 01 c0\nE: 0.0 1 00\n", "bad.hid: R: byte 2");
    expect_refusal(head + "E: 0.0 2 00 00\n", "5");  // bytes it declares
    expect_refusal(head + "E: 0.0 2 00 00\n", "None of the 1 reports fits");
    expect_refusal(head + "E: 0.0 5 80 80 80 80 00\nE: 99999999.0 5 80 80 80 80 00\n", "span");
    expect_refusal(*read_text(std::string(SUREFOOT_SOURCE_DIR) + "/tests/input/devices/boot-keyboard.hid"), "class reject");
    expect_refusal(good, "bad.toml:2", "[motion]\nwalk_speed = 9\n");
    expect_refusal(good, "button-77",
                   "[[device]]\nname = \"x\"\n[[device.button]]\ncontrol = \"button-77\"\naction = \"stop\"\n");
    walk::WalkRequest request = test::Forest::get().virtual_request(5);
    request.input_file = "absent.hid";
    EXPECT_NE(walk::run_walk(request, {}).error().text().find("absent.hid"), std::string::npos);
    request.input_file = test::keep(input::test::walk_and_turn(), "fine");
    request.ledger_file = request.input_file;
    EXPECT_NE(walk::run_walk(request, {}).error().text().find("reads"), std::string::npos);
}

TEST(ReportAges, CountEveryReportOnceAtTheFirstFrameThatHoldsIt) {
    std::vector<rt::FrameRecord> records(3);
    records[0].submitted_ns = 10'000'000, records[0].input_reports = 1;
    records[1].submitted_ns = 20'000'000, records[1].input_reports = 1;
    records[2].submitted_ns = 30'000'000, records[2].input_reports = 3;
    const std::vector<std::int64_t> stamps = {4'000'000, 11'000'000, 29'000'000, 40'000'000};
    EXPECT_EQ(walk::report_ages_ms(records, stamps), (std::vector<double>{6, 19, 1}));
    EXPECT_TRUE(walk::report_ages_ms({}, stamps).empty());
}

}  // namespace
}  // namespace surefoot
