// Visitors of a session on what moves: pose, floor and picture agree on the time; bakes and files hold what moves.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "render/bake/bake.hpp"
#include "render/bake/ground.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/ground/exact_scenes.hpp"
#include "tests/ground/moving_scenes.hpp"
#include "tests/input/gamepad_session.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/walk/input_session.hpp"

namespace surefoot::walk {

namespace {

constexpr std::int64_t lift_frame_ns = 1'000'000'000 / 30;

/// A hall with a lift that goes up 4 m in 4 s, from the first second on.
test::MovingScene lift_hall() {
    test::MovingScene scene;
    test::add_floor(scene.still, -20, 20, -20, 20, 0);
    scene.things.push_back(test::platform({-2, -0.1, -2}, {2, 0.02, 2}, {0, 4, 0}, 4));
    return scene;
}

/// Frames of a session whose hand moves for a tenth of a second and then rests. Each frame is due `late_ns` after the last one's
/// end: a display that is slower than it says.
std::vector<FramePose> frames_of(const model::Model& model, double seconds, std::int64_t late_ns, bool motion = true) {
    const test::TemporaryFolder folder;
    std::vector<std::string> notes;
    input::test::GamepadSession hand;
    hand.report({}).hold({}, 0.2).hold({.forward = 0.3}, 0.1).hold({}, seconds);
    WalkRequest request;
    request.motion = motion;
    request.input_file = folder / "hand.hid";
    EXPECT_TRUE(write_text(request.input_file, hand.text()));
    auto session = InputSession::open(request, lift_frame_ns, notes);
    EXPECT_TRUE(session);
    Path path;
    path.samples = {{0, {{0, 1.72, 0}}}, {10, {{9, 1.72, 9}}}};
    (*session)->begin(path, model, lift_frame_ns, false, {});
    std::vector<FramePose> frames;
    std::int64_t due_ns = lift_frame_ns;
    for (std::uint64_t slot = 0; static_cast<double>(slot) / 30 < seconds; ++slot, due_ns += lift_frame_ns + late_ns)
        frames.push_back((*session)->poses().sample({slot, due_ns, due_ns}));
    EXPECT_EQ((*session)->summary({}).passed_through, 0U);
    EXPECT_EQ((*session)->summary({}).put_aside, 0U);
    return frames;
}

importer::Primitive floor_primitive() { return exact::one_box({-10, -1, -10}, {20, 1, 20}); }

}  // namespace

TEST(MovingWalk, FramesShowTheEyeOverTheFloorOfTheirTime) {
    const test::MovingScene scene = lift_hall();
    const model::Model model = scene.model();
    for (const std::int64_t late_ns : {std::int64_t{0}, std::int64_t{40'000}, std::int64_t{-40'000}}) {
        const std::vector<FramePose> frames = frames_of(model, 9, late_ns);
        double off_m = 0, highest_m = 0;
        for (std::size_t slot = 20; slot < frames.size(); ++slot) {
            const double floor = scene.things[0].at({0, 0.02, 0}, static_cast<double>(slot) / 30).y;
            highest_m = std::max(highest_m, floor);
            off_m = std::max(off_m, std::abs(frames[slot].pose.position.y - 1.7 - floor));
        }
        EXPECT_GT(highest_m, 4) << late_ns;
        EXPECT_LT(off_m, 5e-3) << late_ns << ": a step of 2 ms and where it turns round";
    }
}

TEST(MovingWalk, WithoutMotionTheFloorStaysWhereItIs) {
    const std::vector<FramePose> frames = frames_of(lift_hall().model(), 9, 0, false);
    for (std::size_t slot = 20; slot < frames.size(); ++slot) ASSERT_NEAR(frames[slot].pose.position.y, 1.72, 1e-3) << slot;
}

/// A lift whose motion leads nowhere is what a lift that is held still is to be.
TEST(MovingWalk, WithoutMotionRegionsAreThoseOfWhatStandsStill) {
    test::MovingScene still = lift_hall();
    still.things[0].stands = {{0, dvec3(0.0)}, {10, dvec3(0.0)}};
    const std::vector<FramePose> frames = frames_of(lift_hall().model(), 4, 0, false), expected = frames_of(still.model(), 4, 0);
    ASSERT_EQ(frames.size(), expected.size());
    std::size_t known = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const PredictedRegion &held = frames[i].predicted, &rest = expected[i].predicted;
        ASSERT_EQ(held.known, rest.known) << i;
        ASSERT_EQ(held.carried_m, rest.carried_m) << i;
        ASSERT_EQ(held.region.radius_m, rest.region.radius_m) << i;
        ASSERT_EQ(held.region.angle_rad, rest.region.angle_rad) << i;
        ASSERT_EQ(held.region.centre.position, rest.region.centre.position) << i;
        known += held.known ? 1 : 0;
    }
    EXPECT_GT(known, 90U);
    EXPECT_EQ(expected.back().predicted.carried_m, 0);
}

TEST(MovingWalk, RegionsHoldTheNextFramesOfALift) {
    const std::vector<FramePose> frames = frames_of(lift_hall().model(), 9, 0);
    std::size_t known = 0;
    for (std::size_t i = 20; i + 3 < frames.size(); ++i) {
        if (!frames[i].predicted.known) continue;
        ++known;
        for (std::size_t k = 1; k <= 3; ++k) {
            const prepare::Region& region = frames[i].predicted.region;
            ASSERT_LE(glm::length(frames[i + k].pose.position - region.centre.position), region.radius_m + 1e-9) << i << ' ' << k;
        }
    }
    EXPECT_GT(known, 200U);
    EXPECT_GT(frames[60].predicted.region.centre.position.y, frames[60].pose.position.y + 0.05) << "it goes up";
}

/// A door of two nodes and a lift: what moves is in the moving ground, and in it alone.
TEST(MovingBake, AnimatedNodesThatBlockMove) {
    exact::SceneMaker maker;
    maker.add({floor_primitive()});
    const importer::Index door = maker.add({exact::one_box({-0.6F, 0, -0.03F}, {1.2F, 2.5F, 0.06F})}, exact::moved(3, 0, 0));
    const importer::Index knob = maker.add({exact::one_box({0.4F, 1, 0.03F}, {0.05F, 0.05F, 0.1F})}, exact::moved(3, 0, 0));
    const importer::Index lift = maker.add({exact::one_box({-1, -0.2F, -1}, {2, 0.22F, 2})}, exact::moved(-3, 0, 0));
    maker.add_node(maker.scene.nodes[lift].mesh, exact::moved(-6, 0, 0));  // the same mesh, at rest
    for (const double way : {1.2, 3.0}) {
        model::Motion motion;
        motion.first_key = static_cast<std::uint32_t>(maker.scene.motion_keys.size());
        motion.key_count = 3;
        motion.period_s = 4;
        maker.scene.motions.push_back(motion);
        const dvec3 to = way < 2 ? dvec3(way, 0, 0) : dvec3(0, way, 0);
        for (const auto& [time_s, move] : {std::pair{0.0, dvec3(0.0)}, {2.0, to}, {4.0, dvec3(0.0)}})
            maker.scene.motion_keys.push_back({time_s, move, {0, 0, 0, 1}});
    }
    maker.scene.nodes[door].motion = maker.scene.nodes[knob].motion = 0;
    maker.scene.nodes[lift].motion = 1;
    model::MovingGround moving;
    const model::Ground still = bake::make_ground(maker.scene, {}, nullptr, &moving), all = bake::make_ground(maker.scene, {});
    EXPECT_EQ(still.triangles, 24U) << "the floor, and the mesh that stands at rest";
    EXPECT_EQ(moving.rest.triangles, 24U) << "the knob is smaller than a foot";
    EXPECT_GT(all.triangles, still.triangles) << "without a place for what moves all of it stands";
    ASSERT_EQ(moving.motions.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        const model::GroundInstance& instance = moving.rest.instances[i];
        EXPECT_EQ(moving.motions[i], instance.origin.x > 0 ? 0U : 1U);
    }

    const auto baked = bake::bake(maker.scene, {}, {});
    ASSERT_TRUE(baked) << baked.error().text();
    const test::TemporaryFolder folder;
    ASSERT_TRUE(model::write_walk(folder / "m.walk", *baked));
    const auto read = model::read_walk(folder / "m.walk");
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->moving_ground.motions, baked->moving_ground.motions);
    EXPECT_EQ(read->moving_ground.rest.bytes, moving.rest.bytes);
    model::Walker before(*baked, {}), after(*read, {});
    dvec3 a{-3, 1.72, 0}, b = a;
    for (int i = 0; i < 1500; ++i) {
        before.set_time(i * 0.002), after.set_time(i * 0.002);
        const dvec3 way(i == 0 ? 1e-6 : 0, 0, 0);
        a = before.walk(a, a + way, 0.002), b = after.walk(b, b + way, 0.002);
        ASSERT_EQ(a, b);
    }
    EXPECT_NEAR(a.y, 1.72 + 1.5, 0.01) << "three of four seconds: on its way down";

    model::Model bad = *baked;
    bad.moving_ground.motions[0] = 7;
    EXPECT_FALSE(model::validate(bad).ok());
    bad = *baked;
    bad.moving_ground.motions.pop_back();
    EXPECT_FALSE(model::validate(bad).ok());
}

}  // namespace surefoot::walk
