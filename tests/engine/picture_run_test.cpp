// Long walks with pictures on the null device: the same at any number of workers, frame by frame, and exact in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tests/engine/picture_walk.hpp"

namespace surefoot {
namespace {

using test::holes;
using test::PictureWalk;

/// Walks, turns, and jumps now and then.
class Wanderer {
public:
    explicit Wanderer(const Engine& engine) : world_(engine.model().nodes[0].box), pose_(test::forest_pose(engine)) {}
    const Pose& next() {
        if (random_.below(40) == 0) {
            const dvec3 reach(world_.half().x, 0, world_.half().z);
            pose_.position = world_.centre() + any_in(random_, -reach, reach) + dvec3(0, 2, 0);
        }
        if (random_.below(10) == 0) turn_rad_ = random_.range(-0.08, 0.08);
        pose_.orientation = glm::normalize(glm::angleAxis(turn_rad_, dvec3(0, 1, 0)) * pose_.orientation);
        pose_.position += 1.4 / 30 * pose_.forward();
        return pose_;
    }

private:
    Random random_{9};
    Box world_;
    Pose pose_;
    double turn_rad_ = 0;
};

bool same_pictures(const Engine& a, const Engine& b) {
    const auto &of_a = a.pictures(), &of_b = b.pictures();
    return std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), [](const auto& one, const auto& other) {
        return one.place.layer == other.place.layer && one.place.column == other.place.column &&
               one.place.row == other.place.row && one.place.texels == other.place.texels && one.eye == other.eye &&
               one.side_m == other.side_m;
    });
}

/// Until both have made so many pictures.
void expect_same(std::uint64_t refreshes, bool all_round) {
    constexpr std::uint32_t layers = 12;
    PictureWalk one(test::forest_model(), {.layers = layers, .all_round = all_round});
    PictureWalk three(test::forest_model(), {.layers = layers, .workers = 3, .all_round = all_round});
    Wanderer wanderer(one.engine());
    std::uint64_t made = 0, frame = 0, judged = 0;
    for (; made < refreshes; ++frame) {
        ASSERT_LT(frame, 20 * refreshes) << "hardly any picture is made";
        const Pose& pose = wanderer.next();
        const SubmitReport a = one.frame(pose, 33'333), b = three.frame(pose, 33'333);
        made += a.pictures_made;
        ASSERT_EQ(a.pictures_made, b.pictures_made) << frame;
        ASSERT_EQ(a.picture_bytes, b.picture_bytes) << frame;
        ASSERT_EQ(a.predicted_us, b.predicted_us) << frame;
        ASSERT_EQ(one.set().covered, three.set().covered) << frame;
        ASSERT_TRUE(same_pictures(one.engine(), three.engine())) << frame;
        ASSERT_LE(a.picture_bytes, std::uint64_t{layers} * 256 * 256 * 4);
        // A walk draws no set whose region the pose has left.
        if (frame % 16 == 0 && covers(one.set().region, pose, one.engine().options().device.viewport)) {
            ++judged;
            ASSERT_TRUE(holes(one.engine(), pose).empty()) << frame;
        }
    }
    EXPECT_GT(judged, frame / 32);
}

TEST(PictureRun, IsTheSameAtAnyNumberOfWorkers) {
    for (const bool all_round : {false, true}) expect_same(40, all_round);
}

TEST(PictureRunAtNight, IsTheSameAtAnyNumberOfWorkers) {
    for (const bool all_round : {false, true}) expect_same(20'000, all_round);
}

}  // namespace
}  // namespace surefoot
