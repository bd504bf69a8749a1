// Floor frames of a walk: a smooth path has none, a turn that begins at once shows one.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporary_folder.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

constexpr double period_s = 1.0 / 30, radians_per_degree = 0.017453292519943295;

/// From the forest's own first pose: stands, turns at `deg_s` from frame 30 to frame 60, stands.
Path turn(const Path& forest, double deg_s) {
    Path path;
    for (int frame = 0; frame <= 90; ++frame) {
        const double angle = -radians_per_degree * deg_s * period_s * std::clamp(frame - 30, 0, 30);
        PathSample sample = forest.samples.front();
        sample.time_s = frame * period_s;
        sample.pose.orientation = glm::angleAxis(angle, dvec3(0, 1, 0)) * sample.pose.orientation;
        path.samples.push_back(sample);
    }
    return path;
}

std::uint64_t floor_frames_of_turn(double deg_s) {
    walk::WalkRequest request = test::Forest::get().virtual_request(90);
    const test::TemporaryFolder folder;
    const Path path = turn(*read_path(request.path_file), deg_s);
    request.path_file = folder / "turn.csv";
    EXPECT_TRUE(write_path(request.path_file, path).ok());
    const walk::WalkOutcome outcome = test::walk(request);
    for (const rt::FrameRecord& r : outcome.records)
        if (r.floor_frame) EXPECT_GT(r.floor_share, 0.5F) << "frame " << r.frame;
    return outcome.summary.floor_frames;
}

TEST(FloorFrames, ASmoothWalkHasNone) {
    EXPECT_EQ(test::walk(test::Forest::get().virtual_request(300)).summary.floor_frames, 0U);
    EXPECT_EQ(floor_frames_of_turn(20), 0U);
}

TEST(FloorFrames, ASuddenTurnBeyondTheRegionShowsOne) { EXPECT_EQ(floor_frames_of_turn(113), 1U); }

}  // namespace
}  // namespace surefoot
