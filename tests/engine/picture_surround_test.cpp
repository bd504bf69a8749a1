// The image cache of the whole surround: a turn makes nothing anew, and what is seen first is made first.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "render/bake/bake.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/engine/picture_walk.hpp"

namespace surefoot {
namespace {

using test::holes;
using test::PictureWalk;

constexpr double period_us = 33'333;
constexpr std::uint32_t turn_frames = 120;  // 90 degrees a second: as far as sets are prepared for

Pose turned(Pose pose, double rad) {
    pose.orientation = glm::normalize(glm::angleAxis(rad, dvec3(0, 1, 0)) * pose.orientation);
    return pose;
}

/// Trees stand all round.
Pose in_the_forest(const Engine& engine) {
    Pose pose = test::forest_pose(engine);
    pose.position.z = engine.model().nodes[0].box.centre().z;
    return pose;
}

/// Balls all round, near and far.
model::Model ring_of_balls() {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    const importer::Index ball = bake::add_mesh(scene, bake::ball(16, 1), "ball");
    constexpr int balls = 64;
    for (int i = 0; i < balls; ++i) {
        const double at = 2 * std::numbers::pi * i / balls, distance_m = 12 + 6 * (i % 5);
        bake::place(scene, ball, distance_m * dvec3(std::cos(at), 0, std::sin(at)));
    }
    auto baked = bake::bake(scene, {}, {});
    EXPECT_TRUE(baked.ok());
    return baked.ok() ? std::move(*baked) : model::Model{};
}

/// Stands until no picture was made for a second. Returns the last frame that made one.
int fill(PictureWalk& walk, const Pose& pose) {
    int last = 0;
    for (int i = 0; i < 600 && i <= last + 30; ++i)
        if (walk.frame(pose, period_us).pictures_made > 0) last = i;
    return last;
}

/// Turns once round on the spot.
struct Turn {
    std::uint32_t made = 0, frames_with_pictures = 0;
};
Turn turn_round(PictureWalk& walk, const Pose& pose) {
    Turn turn;
    for (std::uint32_t i = 1; i <= turn_frames; ++i) {
        const Pose now = turned(pose, 2 * std::numbers::pi * i / turn_frames);
        const SubmitReport report = walk.frame(now, period_us);
        turn.made += report.pictures_made;
        turn.frames_with_pictures += report.pictures > 0 ? 1 : 0;
        if (i % 8 == 0) {
            EXPECT_TRUE(holes(walk.engine(), now).empty()) << i;
        }
    }
    return turn;
}

/// The first turn finds what boxes cost that no cut had drawn, and makes some anew for that. Then nothing is made.
TEST(PictureSurround, ATurnMakesNothingAnew) {
    const model::Model model = ring_of_balls();
    PictureWalk surround(model, {.all_round = true}), view(model, {});
    Pose pose;
    pose.position = dvec3(0.3, 0.2, 0.4);
    EXPECT_LT(fill(surround, pose), 60) << "it is full within two seconds";
    fill(view, pose);
    const Turn of_view = turn_round(view, pose), first = turn_round(surround, pose), then = turn_round(surround, pose);
    EXPECT_EQ(then.made, 0U);
    EXPECT_LT(first.made, of_view.made);
    EXPECT_EQ(first.frames_with_pictures, turn_frames) << "there are pictures in all directions";
    EXPECT_GT(of_view.made, 10U);
}

/// Where there is no room for all of them, those that are worth the most stay, wherever the eye turns.
TEST(PictureSurround, ATurnMakesNothingAnewInAFullCache) {
    PictureWalk walk(ring_of_balls(), {.layers = 1, .all_round = true});
    Pose pose;
    pose.position = dvec3(0.3, 0.2, 0.4);
    fill(walk, pose);
    const std::uint64_t full = 4U * 256 * 256;
    Turn turn;
    for (int i = 0; i < 3; ++i) turn = turn_round(walk, pose);
    EXPECT_EQ(turn.made, 0U);
    EXPECT_GT(turn.frames_with_pictures, turn_frames / 4);
    EXPECT_EQ(walk.frame(pose, period_us).picture_bytes, full) << "else this says nothing";
}

/// Pictures of what was seen before are valid still. They go for those of what is seen now.
TEST(PictureSurround, AfterATurnAFullCacheShowsWhatIsInView) {
    const test::PictureWalkOptions small{.layers = 3};
    PictureWalk turned_walk(test::forest_model(), small), fresh(test::forest_model(), small);
    const Pose pose = in_the_forest(fresh.engine()), behind = turned(pose, std::numbers::pi);
    fill(turned_walk, pose);
    for (int i = 1; i <= 60; ++i) turned_walk.frame(turned(pose, std::numbers::pi * i / 60), period_us);
    for (int i = 0; i < 150; ++i) {  // a full cache changes little by little: no pause says that it is done
        turned_walk.frame(behind, period_us);
        fresh.frame(behind, period_us);
    }
    const SubmitReport now = turned_walk.frame(behind, period_us), as_fresh = fresh.frame(behind, period_us);
    EXPECT_GT(as_fresh.pictures, 5U);
    EXPECT_GT(as_fresh.picture_bytes, 2U * 4 * 256 * 256) << "else this says nothing";
    EXPECT_GE(now.pictures + 2, as_fresh.pictures);
    EXPECT_LT(static_cast<double>(now.triangles), 1.05 * static_cast<double>(as_fresh.triangles));
    EXPECT_TRUE(holes(turned_walk.engine(), behind).empty());
}

/// Within two seconds of a jump the cache shows what it will show. What is in view comes before the rest.
TEST(PictureSurround, AJumpFillsTheCacheAgainWithinTwoSeconds) {
    for (const bool all_round : {false, true}) {
        PictureWalk walk(test::forest_model(), {.all_round = all_round});
        const Pose before = in_the_forest(walk.engine());
        fill(walk, before);
        Pose pose = turned(before, 2);
        pose.position.x += 25;
        std::vector<SubmitReport> after;
        int last_made = 0;
        for (int i = 0; i < 75; ++i) {
            after.push_back(walk.frame(pose, period_us));
            EXPECT_LE(after.back().captures_us, 0.1 * period_us + 1) << i;
            if (after.back().pictures_made > 0) last_made = i;
            if (i % 25 == 0) {
                EXPECT_TRUE(holes(walk.engine(), pose).empty()) << i;
            }
        }
        const auto view_filled =
            std::ranges::find_if(after, [&](const auto& r) { return r.triangles <= after.back().triangles; }) - after.begin();
        EXPECT_GT(after.back().pictures, 0U);
        EXPECT_GT(after.front().triangles, after.back().triangles);
        EXPECT_GT(last_made, 0);
        EXPECT_LT(last_made, 60);
        EXPECT_LT(view_filled, 60);
        if (all_round) {
            EXPECT_LT(view_filled, last_made) << "what is in view comes before the rest";
        }
    }
}

TEST(PictureSurround, AWalkThatTurnsHasNoHole) {
    for (const std::uint32_t layers : {2U, 64U}) {
        PictureWalk walk(test::forest_model(), {.layers = layers, .all_round = true});
        Pose pose = in_the_forest(walk.engine());
        std::uint32_t pictures = 0;
        for (int i = 0; i < 40; ++i) {
            pose.position.x += 1.4 / 30;
            const Pose now = turned(pose, 0.05 * i);
            pictures += walk.frame(now, period_us).pictures;
            EXPECT_TRUE(holes(walk.engine(), now).empty()) << i;
        }
        EXPECT_GT(pictures, 40U);
    }
}

}  // namespace
}  // namespace surefoot
