// The walker behind the input's steps: who walks, what a path's walls are reported as, jumps.
#include "tools/walk/walking.hpp"

#include <gtest/gtest.h>

#include "tests/ground/grounds.hpp"

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

}  // namespace

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

TEST(Walking, ForeseesNothingWhereAButtonPutTheEyeElsewhere) {
    const model::Ground ground = hall();
    Walking walking(ground, {}, rt::WalkingMode::walk);
    input::MotionState state;
    ASSERT_TRUE(input::place(state, Pose{{4, 1.7, 0}, {1, 0, 0, 0}, 1}));
    input::Command command;
    command.request.side = 1;
    input::NavigationSample sample;
    for (std::int64_t ms = 0; ms < 300; ++ms) sample = input::step(state, {}, command, ms * 1'000'000, walking.ground(false));
    const auto foreseen = walking.foresee(sample, 0.5, 1.5);
    ASSERT_TRUE(foreseen.has_value());
    EXPECT_LT(foreseen->eye.x, 4.71) << "the wall stops it";
    EXPECT_NEAR(foreseen->clear_m, 5 - foreseen->eye.x, 1e-3);
    sample.pose.position.x = -10;
    EXPECT_FALSE(walking.foresee(sample, 0.5, 1.5).has_value());
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
