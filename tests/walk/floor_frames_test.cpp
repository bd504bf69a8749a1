// Floor frames of a walk: a smooth path has none, and a fast turn that begins at once has none either.
#include <gtest/gtest.h>

#include <algorithm>

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

walk::WalkOutcome walk_of_turn(double deg_s) {
    walk::WalkRequest request = test::Forest::get().virtual_request(90);
    const test::TemporaryFolder folder;
    const Path path = turn(*read_path(request.path_file), deg_s);
    request.path_file = folder / "turn.csv";
    EXPECT_TRUE(write_path(request.path_file, path).ok());
    return test::walk(request);
}

TEST(FloorFrames, ASmoothWalkHasNone) {
    const walk::WalkOutcome outcome = test::walk(test::Forest::get().virtual_request(300));
    EXPECT_EQ(outcome.summary.floor_frames, 0U);
    for (const rt::FrameRecord& r : outcome.records) {
        EXPECT_GE(r.floor_share, 0) << "frame " << r.frame;
        EXPECT_LE(r.floor_share, 1) << "frame " << r.frame;
    }
}

TEST(FloorFrames, AFastTurnThatBeginsAtOnceIsPreparedFor) {
    for (const double deg_s : {20.0, 113.0}) {
        const walk::WalkOutcome outcome = walk_of_turn(deg_s);
        EXPECT_EQ(outcome.summary.floor_frames, 0U) << deg_s << " degrees a second";
        for (const rt::FrameRecord& r : outcome.records)
            EXPECT_GT(r.candidates, 0U) << deg_s << " degrees a second: frame " << r.frame << " had no prepared set";
    }
}

}  // namespace
}  // namespace surefoot
