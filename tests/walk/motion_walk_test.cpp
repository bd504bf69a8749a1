// A walk in which things move: alike at any number of workers, other pictures at other times, and no rest while it looks on.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

struct MotionWalk : testing::Test {
    test::TemporaryFolder folder;
    /// The eye stands still before the town for as long as it takes.
    walk::WalkRequest request(bool moves, std::uint64_t count) const {
        importer::Scene scene = bake::moving_town();
        if (!moves)
            for (importer::Node& node : scene.nodes) node.motion = importer::none;
        auto m = bake::bake(scene, {}, {});
        EXPECT_TRUE(m.ok());
        walk::WalkRequest r;
        r.model_file = folder / (moves ? "moving.walk" : "still.walk");
        EXPECT_TRUE(model::write_walk(r.model_file, *m).ok());
        auto path = std::make_shared<Path>();
        for (const double t : {0.0, 60.0}) {
            PathSample sample;
            sample.time_s = t;
            sample.pose.position = dvec3(50, 30, 150);
            sample.pose.orientation = glm::quatLookAt(glm::normalize(dvec3(46, 10, 50) - sample.pose.position), dvec3(0, 1, 0));
            path->samples.push_back(sample);
        }
        r.given_path = path;
        r.backend = "null";
        r.clock = rt::ClockKind::virtual_time;
        r.frames = count;
        r.state_dir = folder / "";
        return r;
    }
};

TEST_F(MotionWalk, IsAlikeAtAnyNumberOfWorkers) {
    walk::WalkRequest r = request(true, 90);
    r.workers = 1;
    const auto first = test::walk(r).summary;
    const std::string hash = first.cut_hash;
    EXPECT_FALSE(hash.empty());
    EXPECT_GT(first.shadow_refreshes, 30U) << "shadows of what moves, in most of 90 frames";
    EXPECT_GE(first.shadow_frames, first.shadow_refreshes);
    for (const int workers : {1, 2, 4}) {
        r.workers = workers;
        const auto again = test::walk(r).summary;
        EXPECT_EQ(again.cut_hash, hash) << workers << " workers";
        EXPECT_EQ(again.shadow_refreshes, first.shadow_refreshes) << workers << " workers";
        EXPECT_EQ(again.shadow_frames, first.shadow_frames) << workers << " workers";
    }
}

TEST_F(MotionWalk, NeverRestsBeforeWhatMoves) {
    const auto rests = [&](bool moves) {
        std::size_t at_rest = 0;
        for (const rt::FrameRecord& record : test::walk(request(moves, 60)).records) at_rest += record.at_rest ? 1 : 0;
        return at_rest;
    };
    EXPECT_EQ(rests(true), 0U);
    EXPECT_GT(rests(false), 20U);
}

TEST_F(MotionWalk, RestsWithoutMotionAndHasItsSets) {
    walk::WalkRequest r = request(true, 60);
    r.motion = false;
    std::size_t at_rest = 0, without_a_set = 0;
    for (const rt::FrameRecord& record : test::walk(r).records) {
        at_rest += record.at_rest ? 1 : 0;
        without_a_set += record.candidates == 0 ? 1 : 0;
    }
    EXPECT_GT(at_rest, 20U);
    EXPECT_EQ(without_a_set, 0U);
}

TEST_F(MotionWalk, EveryFrameShowsItsOwnTime) {
    const auto pictures = [&](bool moves) {
        walk::WalkRequest r = request(moves, 40);
        r.backend = "egl";
        r.width = 320;
        r.height = 180;
        r.rest_after_ms = 0;
        r.snap_every = 10;
        r.snap_dir = folder / (moves ? "moving" : "still");
        auto outcome = walk::run_walk(r, {});
        std::set<std::vector<std::byte>> different;
        if (!outcome.ok()) {
            EXPECT_EQ(outcome.error().kind, ErrorKind::unsupported) << outcome.error().text();
            return different;
        }
        for (int i = 0; i < 4; ++i) {
            auto file = read_file(r.snap_dir + "/0000" + std::to_string(i) + ".png");
            EXPECT_TRUE(file.ok());
            if (file.ok()) different.insert(*file);
        }
        return different;
    };
    const auto moving = pictures(true);
    if (moving.empty()) GTEST_SKIP() << "EGL is not there, or a sanitizer allows no GL";
    EXPECT_EQ(moving.size(), 4U);
    EXPECT_EQ(pictures(true), moving) << "the same walk shows the same";
    EXPECT_LT(pictures(false).size(), 4U);
}

}  // namespace
}  // namespace surefoot
