// Mappings at work: binding, defaults by class, hats and null states, edges, relative controls, bounded merging.
#include "input/map/mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "input/map/merge.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

using test::axis;
using test::button;
using test::set;

DeviceOutput after(Mapper& mapper, DeviceState& state, std::size_t control, std::int32_t value, std::int64_t now_ns = 0) {
    set(state, control, value);
    ++state.reports;
    return evaluate(mapper, state, now_ns);
}

/// A device with its default mapping, shown at rest once.
struct Given {
    Given(std::vector<ControlInfo> c, DeviceClass device_class, std::vector<std::int32_t> rests)
        : controls(std::move(c)), mapping(default_mapping(controls, device_class)) {
        auto compiled = compile(mapping, controls);
        EXPECT_TRUE(compiled.ok()) << compiled.error().text();
        mapper = std::move(*compiled);
        state.reports = 1;
        for (std::size_t i = 0; i < rests.size(); ++i) set(state, i, rests[i]);
        EXPECT_TRUE(evaluate(mapper, state, 0).neutral);
    }
    MotionRequest at(std::size_t control, std::int32_t value) {
        const auto before = state;
        const MotionRequest request = after(mapper, state, control, value).request;
        state.value = before.value;
        state.has_value = before.has_value;
        ++state.reports;
        evaluate(mapper, state, 0);
        return request;
    }
    std::vector<ControlInfo> controls;
    DeviceMapping mapping;
    Mapper mapper;
    DeviceState state;
};

TEST(Defaults, AGamepadWalksWithItsLeftStickAndLooksWithItsRight) {
    const std::string pad = "Game Pad";
    for (const bool sony : {true, false}) {
        std::vector<ControlInfo> c = {axis("x", 0x30, 0, 255, pad), axis("y", 0x31, 0, 255, pad),
                                      axis(sony ? "z" : "rx", sony ? 0x32 : 0x33, 0, 255, pad),
                                      axis(sony ? "rz" : "ry", sony ? 0x35 : 0x34, 0, 255, pad), test::hat(pad)};
        for (int i = 1; i <= 10; ++i) c.push_back(button(i, pad));
        Given g(c, DeviceClass::navigation, {128, 127, 128, 128});
        EXPECT_EQ(g.mapping.name, "default: gamepad");
        EXPECT_NEAR(g.at(0, 255).side, 1, 1e-4);
        EXPECT_NEAR(g.at(1, 0).forward, 1, 1e-4) << "pushed away walks on";
        EXPECT_NEAR(g.at(2, 255).turn, -1, 1e-4) << "to the right turns right";
        EXPECT_NEAR(g.at(3, 0).look, 1, 1e-4);
        EXPECT_TRUE(g.at(5, 1).next_viewpoint);
        EXPECT_TRUE(g.at(6, 1).reset);
    }
}

TEST(Defaults, SonyTriggersLiftAndLower) {
    const std::string pad = "Game Pad";
    Given g({axis("x", 0x30, 0, 255, pad), axis("y", 0x31, 0, 255, pad), axis("z", 0x32, 0, 255, pad),
             axis("rz", 0x35, 0, 255, pad), axis("rx", 0x33, 0, 255, pad), axis("ry", 0x34, 0, 255, pad)},
            DeviceClass::navigation, {128, 128, 128, 128, 0, 0});
    EXPECT_EQ(g.at(4, 255).up, -1);
    EXPECT_EQ(g.at(5, 255).up, 1);
    EXPECT_NEAR(g.at(2, 255).turn, -1, 1e-4);
}

TEST(Defaults, AJoystickTwistsOrTurns) {
    Given twist({axis("x", 0x30, 0, 16383), axis("y", 0x31, 0, 16383), axis("rz", 0x35, 0, 255), axis("slider", 0x36, 0, 255),
                 test::hat(), button(1)},
                DeviceClass::navigation, {8192, 8192, 128, 255});
    EXPECT_EQ(twist.mapping.name, "default: joystick");
    EXPECT_NEAR(twist.at(0, 16383).side, 1, 1e-4);
    EXPECT_NEAR(twist.at(1, 0).forward, 1, 1e-4);
    EXPECT_NEAR(twist.at(2, 0).turn, 1, 1e-4);
    Given plain({axis("x", 0x30, -127, 127), axis("y", 0x31, -127, 127), button(1)}, DeviceClass::navigation, {0, 0});
    EXPECT_NEAR(plain.at(0, -127).turn, 1, 1e-4) << "without a twist the stick itself turns";
}

TEST(Defaults, ASpaceMouseMovesInSixAxes) {
    const std::string c = "Multi-axis Controller/Physical";
    std::vector<ControlInfo> controls;
    for (int i = 0; i < 6; ++i)
        controls.push_back(axis(std::string(1, "xyzabc"[i]), static_cast<std::uint16_t>(0x30 + i), -350, 350, c));
    Given g(controls, DeviceClass::navigation, {0, 0, 0, 0, 0, 0});
    EXPECT_EQ(g.mapping.name, "default: six axes");
    EXPECT_EQ(g.mapping.reporting, Reporting::streaming);
    EXPECT_NEAR(g.at(0, 350).side, 1, 1e-4);
    EXPECT_NEAR(g.at(1, -350).forward, 1, 1e-4);
    EXPECT_EQ(g.at(2, -350).up, 1);
    EXPECT_NEAR(g.at(3, 350).look, 1, 1e-4);
    EXPECT_NEAR(g.at(5, -350).turn, 1, 1e-4);
}

TEST(Defaults, SixRelativeAxesOfAStrangerMoveAtTheirPaceAndStopWithTheReports) {
    std::vector<ControlInfo> controls;
    for (int i = 0; i < 6; ++i) {
        controls.push_back(
            axis(std::string(1, "xyzabc"[i]), static_cast<std::uint16_t>(0x30 + i), -350, 350, "Multi-axis Controller/Physical"));
        controls.back().relative = true;
    }
    const DeviceMapping mapping = default_mapping(controls, DeviceClass::navigation);
    EXPECT_EQ(mapping.name, "default: six relative axes");
    auto mapper = *compile(mapping, controls);
    DeviceState state;
    MotionRequest request;
    const auto pushed = [&](int y, int ms) {
        const bool reports = ms % 8 == 0;
        return reports ? after(mapper, state, 1, y, ms * 1'000'000LL).request : evaluate(mapper, state, ms * 1'000'000LL).request;
    };
    for (int ms = 0; ms < 800; ++ms) request = pushed(-350, ms);
    EXPECT_GT(request.forward, 0.9);
    for (int ms = 800; ms < 1600; ++ms) request = pushed(-175, ms);
    EXPECT_LT(request.forward, 0.6) << "half pushed is slower";
    EXPECT_GT(request.forward, 0.2);
    for (int ms = 1601; ms < 2200; ++ms) request = evaluate(mapper, state, ms * 1'000'000LL).request;
    EXPECT_EQ(request.forward, 0);
    EXPECT_TRUE(default_mapping(controls, DeviceClass::reject).axes.empty());
}

TEST(Defaults, AHatAloneSteers) {
    Given pad({test::hat(), button(1)}, DeviceClass::navigation, {8, 0});
    EXPECT_EQ(pad.mapping.name, "default: hat");
    EXPECT_EQ(pad.mapping.buttons.size(), 1U);
    const auto held = [&](int direction, int from_ms) {
        MotionRequest request;
        for (int ms = from_ms; ms < from_ms + 1000; ++ms)
            request = after(pad.mapper, pad.state, 0, direction, ms * 1'000'000LL).request;
        return request;
    };
    EXPECT_NEAR(held(0, 0).forward, 0.5, 1e-3) << "half pace: a hat has no half way";
    EXPECT_NEAR(held(6, 1000).turn, 0.5, 1e-3) << "to the left";
    EXPECT_EQ(held(8, 2000).turn, 0);
}

TEST(Defaults, TheRightStickIsThePairThatIsLikeTheLeftOne) {
    const auto named = [](const char* name, std::uint16_t usage, int max) { return axis(name, usage, 0, max, "GamePad"); };
    // Triggers of their own range on Z and Rz; they rest at their ends, and the pad steers before they were ever pressed.
    Given wide({named("x", 0x30, 65535), named("y", 0x31, 65535), named("rx", 0x33, 65535), named("ry", 0x34, 65535),
                named("z", 0x32, 1023), named("rz", 0x35, 1023)},
               DeviceClass::navigation, {32768, 32768, 32768, 32768, 0, 0});
    EXPECT_NEAR(wide.at(1, 0).forward, 1, 1e-4);
    EXPECT_NEAR(wide.at(2, 0).turn, 1, 1e-4);
    EXPECT_NEAR(wide.at(5, 1023).up, 1, 1e-4);
    // One range for all: in the order of their usages Rx and Ry are the stick, named Z, Rz first they are.
    Given plain({named("x", 0x30, 255), named("y", 0x31, 255), named("z", 0x32, 255), named("rx", 0x33, 255),
                 named("ry", 0x34, 255), named("rz", 0x35, 255)},
                DeviceClass::navigation, {128, 128, 0, 128, 128, 0});
    EXPECT_NEAR(plain.at(3, 0).turn, 1, 1e-4);
    const std::vector<ControlInfo> z_first = {named("x", 0x30, 255),  named("y", 0x31, 255),  named("z", 0x32, 255),
                                              named("rz", 0x35, 255), named("rx", 0x33, 255), named("ry", 0x34, 255)};
    Given sony(z_first, DeviceClass::navigation, {128, 128, 128, 128, 0, 0});
    EXPECT_NEAR(sony.at(2, 0).turn, 1, 1e-4);
    EXPECT_NEAR(sony.at(5, 255).up, 1, 1e-4);
    // A "trigger" that rests in its middle is never seen released: it does nothing, and the sticks steer all the same.
    Given odd(z_first, DeviceClass::navigation, {128, 128, 128, 128, 128, 128});
    EXPECT_NEAR(odd.at(1, 0).forward, 1, 1e-4);
    EXPECT_EQ(odd.at(1, 0).up, 0);
}

TEST(Defaults, WheelsYokesAndGameControllersSteer) {
    const auto on = [](std::uint16_t page, const char* name, std::uint16_t usage, int min, int max) {
        auto control = axis(name, usage, min, max, "Simulation");
        control.usage_page = page;
        return control;
    };
    Given wheel({on(2, "steering", 0xc8, 0, 65535), on(2, "accelerator", 0xc4, 0, 255), on(2, "brake", 0xc5, 0, 255), button(1)},
                DeviceClass::navigation, {32768, 0, 0, 0});
    EXPECT_EQ(wheel.mapping.name, "default: wheel");
    EXPECT_NEAR(wheel.at(0, 0).turn, 1, 1e-3);
    EXPECT_NEAR(wheel.at(1, 255).forward, 1, 1e-4);
    EXPECT_NEAR(wheel.at(2, 255).forward, -1, 1e-4);
    Given yoke({on(2, "aileron", 0xb0, -127, 127), on(2, "elevator", 0xb8, -127, 127), on(2, "rudder", 0xba, -127, 127)},
               DeviceClass::navigation, {0, 0, 0});
    EXPECT_EQ(yoke.mapping.name, "default: joystick");
    EXPECT_NEAR(yoke.at(1, -127).forward, 1, 1e-4);
    EXPECT_NEAR(yoke.at(0, 127).side, 1, 1e-4);
    EXPECT_NEAR(yoke.at(2, -127).turn, 1, 1e-4);
    Given game({on(5, "turn", 0x21, -127, 127), on(5, "forward", 0x25, -127, 127)}, DeviceClass::navigation, {0, 0});
    EXPECT_NEAR(game.at(1, 127).forward, 1, 1e-4);
    EXPECT_NEAR(game.at(0, -127).turn, 1, 1e-4);
    // Three axes that count both ways are no pedals.
    const std::string c = "Multi-axis Controller/Physical";
    Given puck({axis("x", 0x30, -350, 350, c), axis("y", 0x31, -350, 350, c), axis("z", 0x32, -350, 350, c)},
               DeviceClass::navigation, {0, 0, 0});
    EXPECT_EQ(puck.mapping.name, "default: multi-axis");
    EXPECT_NEAR(puck.at(1, -350).forward, 1, 1e-4);
    Given stick({axis("x", 0x30, -127, 127), axis("y", 0x31, -127, 127), axis("z", 0x32, -127, 127)}, DeviceClass::navigation,
                {0, 0, 0});
    EXPECT_EQ(stick.mapping.name, "default: joystick");
}

TEST(Defaults, PedalsAndButtonBoxesWorkAndOthersDoNothing) {
    Given pedals({axis("x", 0x30, 0, 1023), axis("y", 0x31, 0, 1023), axis("z", 0x32, 0, 1023)}, DeviceClass::navigation,
                 {0, 0, 512});
    EXPECT_EQ(pedals.mapping.name, "default: pedals");
    EXPECT_NEAR(pedals.at(0, 1023).forward, 1, 1e-4);
    EXPECT_NEAR(pedals.at(1, 1023).forward, -1, 1e-4);
    EXPECT_NEAR(pedals.at(2, 1023).turn, -1, 1e-4);
    Given box({button(1), button(2), button(3), button(4)}, DeviceClass::buttons, {0, 0, 0, 0});
    EXPECT_TRUE(box.at(3, 1).pause);
    const auto mouse = std::vector{axis("x", 0x30, -127, 127, "Mouse"), button(1, "Mouse")};
    EXPECT_TRUE(default_mapping(mouse, DeviceClass::reject).buttons.empty());
    EXPECT_TRUE(default_mapping(mouse, DeviceClass::trackball).axes.empty());
}

TEST(Mapper, AxesWaitToBeSeenAtRest) {
    const auto controls = test::stick_controls();
    auto mapper = *compile(test::stick_mapping(), controls);
    DeviceState state;
    set(state, 0, 255);
    set(state, 1, 128);
    state.reports = 1;
    DeviceOutput output = evaluate(mapper, state, 0);
    EXPECT_EQ(output.request.side, 0);
    EXPECT_FALSE(output.neutral);
    output = after(mapper, state, 0, 128);
    EXPECT_TRUE(output.neutral);
    EXPECT_NEAR(after(mapper, state, 0, 255).request.side, 1, 1e-4);
    forget(mapper);
    EXPECT_EQ(after(mapper, state, 0, 255).request.side, 0) << "again after a replug";
}

TEST(Mapper, HatsRestInEveryNullStateAndDiagonalsAreNoFaster) {
    const std::vector controls = {test::hat()};
    DeviceMapping m;
    m.hats.push_back({{"hat", 0, 0, ""}, {Action::side, Action::forward}, {}, 1, 0});
    auto mapper = *compile(m, controls);
    DeviceState state;
    state.reports = 1;
    EXPECT_TRUE(evaluate(mapper, state, 0).neutral);
    EXPECT_NEAR(after(mapper, state, 0, 0).request.forward, 1, 1e-4);
    EXPECT_NEAR(after(mapper, state, 0, 2).request.side, 1, 1e-4);
    const MotionRequest d = after(mapper, state, 0, 3).request;
    EXPECT_NEAR(std::hypot(d.side, d.forward), 1, 1e-12);
    EXPECT_LT(d.forward, 0);
    for (const int outside : {-1, 8, 15, 255}) EXPECT_TRUE(after(mapper, state, 0, outside).neutral) << outside;
    state.has_value.reset();
    EXPECT_EQ(evaluate(mapper, state, 0).request.side, 0);
}

TEST(Mapper, AnAxisThatLosesItsValueRests) {
    auto mapper = *compile(test::stick_mapping(), test::stick_controls());
    DeviceState state;
    after(mapper, state, 0, 128);
    after(mapper, state, 1, 128);
    EXPECT_NEAR(after(mapper, state, 0, 255).request.side, 1, 1e-4);
    state.has_value.reset(0);
    EXPECT_EQ(evaluate(mapper, state, 0).request.side, 0);
    EXPECT_NEAR(after(mapper, state, 0, 100000).request.side, 1, 1e-4) << "out of range: clamped";
}

TEST(Mapper, EdgesComeOnceAndOnlyForPressesAfterARelease) {
    DeviceMapping m;
    m.buttons = {{{"button-1", 0, 0, ""}, Action::reset, 1, 0, 0.005, false},
                 {{"button-2", 0, 0, ""}, Action::forward, -1, 0, 0, false}};
    auto mapper = *compile(m, test::stick_controls());
    DeviceState state;
    EXPECT_FALSE(after(mapper, state, 2, 1).request.reset) << "held when it came";
    after(mapper, state, 2, 0, 1'000'000);
    EXPECT_FALSE(after(mapper, state, 2, 1, 2'000'000).request.reset) << "bounced: 1 ms is no release";
    after(mapper, state, 2, 0, 3'000'000);
    after(mapper, state, 2, 0, 9'000'000);
    EXPECT_TRUE(after(mapper, state, 2, 1, 10'000'000).request.reset);
    EXPECT_FALSE(after(mapper, state, 2, 1, 11'000'000).request.reset);
    after(mapper, state, 3, 0);
    const DeviceOutput walking = after(mapper, state, 3, 1);
    EXPECT_EQ(walking.request.forward, -1);
    EXPECT_FALSE(walking.neutral);
}

TEST(Mapper, StopsAreAssertedByOpenContactsAndUnknownOnes) {
    DeviceMapping m;
    m.buttons = {{{"button-1", 0, 0, ""}, Action::stop, 1, 0, 0, true}};
    auto mapper = *compile(m, test::stick_controls());
    DeviceState state;
    EXPECT_TRUE(evaluate(mapper, state, 0).stop);
    EXPECT_FALSE(after(mapper, state, 2, 1).stop);
    EXPECT_TRUE(after(mapper, state, 2, 0).stop);
}

/// A ball that turns: 1000 counts a second are full response.
Mapper relative_turn() {
    auto control = axis("x", 0x30, -127, 127, "Trackball");
    control.relative = true;
    DeviceMapping m;
    AxisMapping a;
    a.control.name = "x";
    a.action = Action::turn;
    a.counts_per_s = 1000;
    m.axes = {a};
    return *compile(m, std::vector{control});
}

TEST(Mapper, RelativeControlsBecomeAPaceAndRestByThemselves) {
    auto mapper = relative_turn();
    DeviceState state;
    MotionRequest request;
    for (int i = 0; i < 500; ++i) request = after(mapper, state, 0, 1, i * 1'000'000LL).request;  // 1000 counts a second
    EXPECT_GT(request.turn, 0.95);
    for (int i = 500; i < 700; ++i) request = evaluate(mapper, state, i * 1'000'000LL).request;
    EXPECT_EQ(request.turn, 0);
}

TEST(Mapper, ADisplacementIsWalkedOnceThoughReportsOfOtherIdsFollow) {
    auto mapper = relative_turn();
    DeviceState state;
    after(mapper, state, 0, 20);
    state.carried_over.set(0);
    MotionRequest request;
    for (int ms = 1; ms < 1000; ++ms) {
        ++state.reports;
        request = evaluate(mapper, state, ms * 1'000'000LL).request;
    }
    EXPECT_EQ(request.turn, 0);
}

TEST(Mapper, AStickHasTwoAxes) {
    DeviceMapping m = test::stick_mapping();
    m.sticks[0].controls[1] = m.sticks[0].controls[0];
    const auto twice = compile(m, test::stick_controls());
    ASSERT_FALSE(twice.ok());
    EXPECT_NE(twice.error().text().find("named twice"), std::string::npos) << twice.error().text();
}

TEST(Mapper, SmoothingLagsAsStatedAndEndsExactlyAtRest) {
    Shape shape;
    shape.smoothing_s = 0.1;
    auto mapper = *compile(test::stick_mapping(shape), test::stick_controls());
    EXPECT_EQ(mapping_lag_s(mapper), 0.1);
    DeviceState state;
    after(mapper, state, 0, 128);
    after(mapper, state, 1, 128);
    MotionRequest request;
    for (int i = 0; i <= 100; ++i) request = after(mapper, state, 0, 255, i * 1'000'000LL).request;
    EXPECT_NEAR(request.side, 1 - std::exp(-1.0), 0.01);
    for (int i = 101; i < 1200; ++i) request = after(mapper, state, 0, 128, i * 1'000'000LL).request;
    EXPECT_EQ(request.side, 0);
}

TEST(Mapper, WhatCannotBeBoundIsNamedWithTheNearest) {
    DeviceMapping m = test::stick_mapping();
    m.name = "lobby";
    m.sticks[0].controls[1].name = "yy";
    auto bad = compile(m, test::stick_controls());
    ASSERT_FALSE(bad.ok());
    EXPECT_NE(bad.error().text().find("'yy'"), std::string::npos);
    EXPECT_NE(bad.error().text().find("Did you mean 'y'"), std::string::npos) << bad.error().text();
    EXPECT_EQ(compile_what_fits(m, test::stick_controls()).messages.size(), 1U);
    m = {};
    AxisMapping a;
    a.control = {"", 0x01, 0x31, "Stick"};
    m.axes = {a};
    EXPECT_FALSE(compile(m, test::stick_controls()).ok()) << "another collection";
    m.axes[0].control.collection = "Joy";
    EXPECT_TRUE(compile(m, test::stick_controls()).ok());
    EXPECT_FALSE(compile(m, std::vector{axis("y", 0x31, 5, 5)}).ok()) << "an empty range moves nothing";
}

TEST(Merge, NothingExceedsOneFullDeflection) {
    MotionRequest a, b;
    a.forward = b.forward = 1;
    a.side = 1;
    a.turn = b.turn = a.look = 1;
    a.speed = b.speed = a.zoom = b.zoom = 1;
    b.tour = true;
    const MotionRequest sum = merge(std::vector{a, b});
    EXPECT_NEAR(std::hypot(sum.forward, sum.side, sum.up), 1, 1e-12);
    EXPECT_NEAR(std::hypot(sum.turn, sum.look), 1, 1e-12);
    EXPECT_EQ(sum.speed, 1);
    EXPECT_EQ(sum.zoom, 1);
    EXPECT_TRUE(sum.tour);
    b.forward = -1;
    EXPECT_EQ(merge(std::vector{a, b}).forward, 0) << "two hands that pull apart";
    a.up = std::numeric_limits<double>::quiet_NaN();
    b.turn = std::numeric_limits<double>::infinity();
    EXPECT_EQ(merge(std::vector{a, b}).up, 0);
    EXPECT_FALSE(bound(a));
}

}  // namespace
}  // namespace surefoot::input
