// The seat in a walk: every pose has its field of view, the summary says so, and acuity saves what is not seen. And a path whose
// field of view changes.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "config/seat.hpp"
#include "render/capture/capture.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/walk/steered_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

constexpr double radians = std::numbers::pi / 180;

walk::WalkRequest seated(walk::WalkRequest request, double width_cm, double distance_cm) {
    request.screen_width_cm = width_cm;
    request.eye_distance_cm = distance_cm;
    return request;
}

/// The field of view that a frame of the walk was prepared for.
double prepared_fov_rad(walk::WalkRequest request, std::uint64_t frame) {
    const test::TemporaryFolder folder;
    request.capture_file = folder / "frame.capture";
    request.capture_frame = frame;
    test::walk(request);
    const auto captured = capture::read_capture(request.capture_file);
    EXPECT_TRUE(captured.ok());
    return captured ? captured->prepared.region.centre.fov_y_rad : 0;
}

/// The forest's path, with a field of view that goes from 20 to 110 degrees and back, 60 degrees a second.
Path zooming() {
    Path path = *read_path(test::Forest::get().path_file);
    for (PathSample& sample : path.samples) {
        const double turn = std::fmod(sample.time_s * 60, 180);
        sample.pose.fov_y_rad = (20 + (turn < 90 ? turn : 180 - turn)) * radians;
    }
    return path;
}

TEST(SeatWalk, EveryPoseHasTheFieldOfViewOfTheSeat) {
    const double fov_y_rad = config::seat_of(seated({}, 60, 70))->fov_y_rad;
    walk::WalkRequest path = seated(test::Forest::get().virtual_request(12), 60, 70);
    EXPECT_DOUBLE_EQ(prepared_fov_rad(path, 10), fov_y_rad);
    path.given_path = std::make_shared<const Path>(zooming());
    EXPECT_DOUBLE_EQ(prepared_fov_rad(path, 10), fov_y_rad) << "whatever the path says";
    test::GamepadSession session;
    session.hold({.forward = 1}, 0.4).press(test::GamepadSession::next_viewpoint).press(test::GamepadSession::tour).hold({}, 0.5);
    const walk::WalkRequest steered = seated(test::steered_request(session, "seated"), 60, 70);
    for (const std::uint64_t frame : {16, 30})
        EXPECT_DOUBLE_EQ(prepared_fov_rad(steered, frame), fov_y_rad) << "a viewpoint, a tour: frame " << frame;
}

TEST(SeatWalk, TheSummarySaysWhereTheEyeIs) {
    const walk::WalkOutcome outcome = test::walk(seated(test::Forest::get().virtual_request(2), 60, 70));
    const auto json = nlohmann::json::parse(report::to_json(outcome.summary));
    EXPECT_EQ(json["seat"]["screen_width_cm"], 60);
    EXPECT_EQ(json["seat"]["eye_distance_cm"], 70);
    EXPECT_NEAR(json["seat"]["fov_x_deg"].get<double>(), 46.397, 1e-2);
    EXPECT_NEAR(json["seat"]["fov_y_deg"].get<double>(), 27.112, 1e-2);
    EXPECT_NEAR(json["acuity_arcmin"].get<double>(), 1, 1e-9);
    EXPECT_NE(report::to_table(outcome.summary, false).find("60 cm wide at 70 cm: 46.4 x 27.1 degrees"), std::string::npos);
    const auto plain = nlohmann::json::parse(report::to_json(test::walk(test::Forest::get().virtual_request(2)).summary));
    EXPECT_TRUE(plain["seat"].is_null());
    EXPECT_TRUE(plain["acuity_arcmin"].is_null());
}

TEST(SeatWalk, IsTheWalkOfAPathWithThatFieldOfViewWherePixelsAreCoarse) {
    walk::WalkRequest request = test::Forest::get().virtual_request(20);
    Path path = *read_path(request.path_file);
    for (PathSample& sample : path.samples) sample.pose.fov_y_rad = config::seat_of(seated({}, 120, 60))->fov_y_rad;
    request.given_path = std::make_shared<const Path>(path);
    const std::string by_path = test::walk(request).summary.cut_hash;
    request.given_path = nullptr;
    walk::WalkRequest seat = seated(request, 120, 60);
    seat.acuity_arcmin = 0.4;
    EXPECT_EQ(test::walk(seat).summary.cut_hash, by_path) << "an eighth of a pixel is 0.5 arcminutes";
    EXPECT_NE(test::walk(request).summary.cut_hash, by_path) << "or the test shows nothing";
}

/// A small screen, far off: pixels of 0.45 arcminutes. Half the resolution is no softer for the eye, and costs a quarter.
TEST(SeatWalk, AcuitySavesWhatTheEyeCannotTellApart) {
    walk::WalkRequest request = seated(test::Forest::get().virtual_request(40), 10, 60);
    request.rate_hz = 45;
    const report::WalkSummary seen = test::walk(request).summary;
    request.acuity_arcmin = 0.001;
    const report::WalkSummary all = test::walk(request).summary;
    EXPECT_GT(seen.triangles_mean, 1.5 * all.triangles_mean) << "what pixels no longer take buys forms";
    EXPECT_LT(seen.frame_ms.p50, 0.9 * all.frame_ms.p50);
    EXPECT_LT(seen.resolution_mean, 0.75);
    EXPECT_GT(all.resolution_mean, 0.9);
}

TEST(ZoomWalk, EveryFrameIsChosenFromASetThatCoversItsFieldOfView) {
    walk::WalkRequest request = test::Forest::get().virtual_request(90);
    request.given_path = std::make_shared<const Path>(zooming());
    request.width = 2560;  // wide, so that the sides open faster than the field of view
    request.height = 360;
    for (const rt::FrameRecord& r : test::walk(request).records) {
        EXPECT_GT(r.candidates, 0U) << "frame " << r.frame << " was drawn without a set";
        EXPECT_FALSE(r.missed) << r.frame;
    }
}

}  // namespace
}  // namespace surefoot
