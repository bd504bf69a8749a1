// The walker behind the input's steps: who walks, what a path's walls are reported as, jumps.
#include "tools/walk/walking.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "rt/base/file.hpp"
#include "tests/ground/grounds.hpp"
#include "tests/input/gamepad_session.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/walk/input_session.hpp"
#include "tools/walk/region_clip.hpp"

namespace surefoot::walk {

namespace {

model::Ground hall() {
    test::Triangles t;
    test::add_floor(t, -20, 20, -20, 20, 0);
    test::add_wall(t, {5, -20}, {5, 20}, 0, 3);
    return test::ground_of(t);
}

Path straight(const dvec3& from, const dvec3& to) {
    Path path;
    path.samples = {{0, {from}}, {10, {to}}};
    return path;
}

constexpr std::int64_t second_ns = 1'000'000'000, frame_ns = second_ns / 30;

/// A hand that pushes forward all the time from half a second on, in a session of its own.
struct Pushed {
    test::TemporaryFolder folder;
    std::vector<std::string> notes;
    std::unique_ptr<InputSession> session;
    std::vector<FramePose> frames;

    Pushed(const model::Ground& ground, const Path& path, double seconds) {
        input::test::GamepadSession hand;
        hand.report({}).hold({}, 0.5).hold({.forward = 1}, seconds);
        WalkRequest request;
        request.input_file = folder / "hand.hid";
        EXPECT_TRUE(write_text(request.input_file, hand.text()));
        auto opened = InputSession::open(request, frame_ns, notes);
        EXPECT_TRUE(opened);
        session = std::move(*opened);
        session->begin(path, ground, frame_ns, false, {});
        for (std::int64_t at = frame_ns; at < static_cast<std::int64_t>(seconds * 1e9); at += frame_ns) {
            frames.push_back(session->poses().sample({static_cast<std::uint64_t>(at / frame_ns), at, at}));
            session->poll({}, notes);
        }
    }
};

}  // namespace

TEST(Walking, AStartInsideSomethingSolidIsToldOnceAndIsNoMotion) {
    test::Triangles t;
    test::add_floor(t, -20, 20, -20, 20, 0);
    test::add_box(t, {-0.6, 0, -0.6}, {0.6, 3, 0.6});
    const model::Ground ground = test::ground_of(t);
    const Path path = straight({0, 1.7, 0}, {9, 1.7, 9});
    const Pushed pushed(ground, path, 4);
    EXPECT_EQ(std::count_if(pushed.notes.begin(), pushed.notes.end(),
                            [](const std::string& n) { return n.find("inside something solid") != std::string::npos; }),
              1)
        << pushed.notes.size() << " notes";
    EXPECT_EQ(pushed.session->summary({}).freed, 1U);
    std::size_t jumps = 0;
    for (std::size_t i = 1; i < pushed.frames.size(); ++i) {
        const FramePose &before = pushed.frames[i - 1], &now = pushed.frames[i];
        if (now.jumped) ++jumps;
        EXPECT_LT(glm::length(now.pose.position - now.before.position), 0.1) << i << ": a jump is no motion";
        EXPECT_TRUE(now.jumped || glm::length(now.pose.position - before.pose.position) < 0.1) << i;
    }
    EXPECT_EQ(jumps, 1U);
    const Pushed free(ground, straight({5, 1.7, 5}, {9, 1.7, 9}), 1);
    EXPECT_TRUE(free.notes.empty());
}

TEST(Walking, WalkOfADeviceDependsOnTheModeAndOnTheDevice) {
    const model::Ground ground = hall();
    for (const auto& [mode, pad, puck] : {std::tuple{rt::WalkingMode::automatic, true, false},
                                          {rt::WalkingMode::walk, true, true},
                                          {rt::WalkingMode::fly, false, false}}) {
        Walking walking(ground, {}, mode);
        EXPECT_EQ(walking.ground(false).walks(), pad);
        EXPECT_EQ(walking.walks(), pad);
        EXPECT_EQ(walking.ground(true).walks(), puck);
    }
    Walking nothing({}, {}, rt::WalkingMode::walk);
    EXPECT_FALSE(nothing.ground(false).walks()) << "a model of an earlier version has no ground";
    EXPECT_EQ(nothing.jumps(), 0U);
}

TEST(Walking, RegionsOnFootAreClippedByWallsAndOthersNot) {
    const model::Ground ground = hall();
    Walking walking(ground, {}, rt::WalkingMode::walk);
    RegionClip clip(ground, {});
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{4, 1.7, 0}, {1, 0, 0, 0}, 1}));
    input::Command command;
    command.request.side = 1;
    input::NavigationSample sample;
    for (std::int64_t ms = 0; ms < 300; ++ms) sample = input::step(state, {}, command, ms * 1'000'000, walking.ground(false));
    ASSERT_TRUE(walking.stands(sample));
    PredictedRegion region;
    region.known = region.on_foot = true;
    region.region = {sample.pose, 1.5, 0.1};
    region.feet = walking.walker()->feet(), region.eye = sample.pose.position, region.way = 0.5 * sample.velocity_m_s;
    PredictedRegion flown = region;
    clip.clip(region);
    const double x = region.region.centre.position.x;
    EXPECT_LT(x, 4.71) << "the wall stops it";
    EXPECT_NEAR(region.region.radius_m, 5 - x, 1e-3);
    flown.on_foot = false;
    clip.clip(flown);
    EXPECT_EQ(flown.region.radius_m, 1.5);
    EXPECT_EQ(flown.region.centre.position, sample.pose.position);
    sample.pose.position.x = -10;
    EXPECT_FALSE(walking.stands(sample)) << "a button put the eye elsewhere";
}

TEST(PathWarning, NamesWallsAndViewpoints) {
    const model::Ground ground = hall();
    EXPECT_EQ(path_warning(ground, straight({0, 1.7, 0}, {4, 1.7, 0})), "");
    EXPECT_EQ(path_warning({}, straight({0, 1.7, 0}, {40, 1.7, 0})), "");
    const std::string through = path_warning(ground, straight({0, 1.7, 0}, {10, 1.7, 0}));
    EXPECT_NE(through.find("through walls or floors once, first after 10.0 s"), std::string::npos) << through;
    EXPECT_NE(through.find("Viewpoints in a wall: 5."), std::string::npos) << through << ": at half of the way";
}

}  // namespace surefoot::walk
