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

Asked after(Mapper& mapper, DeviceState& state, std::size_t control, std::int32_t value, std::int64_t now_ns = 0) {
    set(state, control, value);
    ++state.reports;
    return ask(mapper, state, now_ns);
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
        EXPECT_TRUE(ask(mapper, state, 0).neutral);
    }
    Wish at(std::size_t control, std::int32_t value) {
        const auto before = state;
        const Wish wish = after(mapper, state, control, value).wish;
        state.value = before.value;
        state.has_value = before.has_value;
        ++state.reports;
        ask(mapper, state, 0);
        return wish;
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
    Asked asked = ask(mapper, state, 0);
    EXPECT_EQ(asked.wish.side, 0);
    EXPECT_FALSE(asked.neutral);
    asked = after(mapper, state, 0, 128);
    EXPECT_TRUE(asked.neutral);
    EXPECT_NEAR(after(mapper, state, 0, 255).wish.side, 1, 1e-4);
    forget(mapper);
    EXPECT_EQ(after(mapper, state, 0, 255).wish.side, 0) << "again after a replug";
}

TEST(Mapper, HatsRestInEveryNullStateAndDiagonalsAreNoFaster) {
    const std::vector controls = {test::hat()};
    DeviceMapping m;
    m.hats.push_back({{"hat", 0, 0, ""}, {Action::side, Action::forward}, {}, 1, 0});
    auto mapper = *compile(m, controls);
    DeviceState state;
    state.reports = 1;
    EXPECT_TRUE(ask(mapper, state, 0).neutral);
    EXPECT_NEAR(after(mapper, state, 0, 0).wish.forward, 1, 1e-4);
    EXPECT_NEAR(after(mapper, state, 0, 2).wish.side, 1, 1e-4);
    const Wish d = after(mapper, state, 0, 3).wish;
    EXPECT_NEAR(std::hypot(d.side, d.forward), 1, 1e-12);
    EXPECT_LT(d.forward, 0);
    for (const int outside : {-1, 8, 15, 255}) EXPECT_TRUE(after(mapper, state, 0, outside).neutral) << outside;
    state.has_value.reset();
    EXPECT_EQ(ask(mapper, state, 0).wish.side, 0);
}

TEST(Mapper, AnAxisThatLosesItsValueRests) {
    auto mapper = *compile(test::stick_mapping(), test::stick_controls());
    DeviceState state;
    after(mapper, state, 0, 128);
    after(mapper, state, 1, 128);
    EXPECT_NEAR(after(mapper, state, 0, 255).wish.side, 1, 1e-4);
    state.has_value.reset(0);
    EXPECT_EQ(ask(mapper, state, 0).wish.side, 0);
    EXPECT_NEAR(after(mapper, state, 0, 100000).wish.side, 1, 1e-4) << "out of range: clamped";
}

TEST(Mapper, EdgesComeOnceAndOnlyForPressesAfterARelease) {
    DeviceMapping m;
    m.buttons = {{{"button-1", 0, 0, ""}, Action::reset, 1, 0, 0.005, false},
                 {{"button-2", 0, 0, ""}, Action::forward, -1, 0, 0, false}};
    auto mapper = *compile(m, test::stick_controls());
    DeviceState state;
    EXPECT_FALSE(after(mapper, state, 2, 1).wish.reset) << "held when it came";
    after(mapper, state, 2, 0, 1'000'000);
    EXPECT_FALSE(after(mapper, state, 2, 1, 2'000'000).wish.reset) << "bounced: 1 ms is no release";
    after(mapper, state, 2, 0, 3'000'000);
    after(mapper, state, 2, 0, 9'000'000);
    EXPECT_TRUE(after(mapper, state, 2, 1, 10'000'000).wish.reset);
    EXPECT_FALSE(after(mapper, state, 2, 1, 11'000'000).wish.reset);
    after(mapper, state, 3, 0);
    const Asked walking = after(mapper, state, 3, 1);
    EXPECT_EQ(walking.wish.forward, -1);
    EXPECT_FALSE(walking.neutral);
}

TEST(Mapper, StopsAreAssertedByOpenContactsAndUnknownOnes) {
    DeviceMapping m;
    m.buttons = {{{"button-1", 0, 0, ""}, Action::stop, 1, 0, 0, true}};
    auto mapper = *compile(m, test::stick_controls());
    DeviceState state;
    EXPECT_TRUE(ask(mapper, state, 0).stop);
    EXPECT_FALSE(after(mapper, state, 2, 1).stop);
    EXPECT_TRUE(after(mapper, state, 2, 0).stop);
}

TEST(Mapper, RelativeControlsBecomeAPaceAndRestByThemselves) {
    auto control = axis("x", 0x30, -127, 127, "Trackball");
    control.relative = true;
    DeviceMapping m;
    AxisMapping a;
    a.control.name = "x";
    a.action = Action::turn;
    a.counts_per_s = 1000;
    m.axes = {a};
    auto mapper = *compile(m, std::vector{control});
    DeviceState state;
    Wish wish;
    for (int i = 0; i < 500; ++i) wish = after(mapper, state, 0, 1, i * 1'000'000LL).wish;  // 1000 counts a second
    EXPECT_GT(wish.turn, 0.95);
    for (int i = 500; i < 700; ++i) wish = ask(mapper, state, i * 1'000'000LL).wish;
    EXPECT_EQ(wish.turn, 0);
}

TEST(Mapper, SmoothingLagsAsStatedAndEndsExactlyAtRest) {
    Shape shape;
    shape.smoothing_s = 0.1;
    auto mapper = *compile(test::stick_mapping(shape), test::stick_controls());
    EXPECT_EQ(mapping_lag_s(mapper), 0.1);
    DeviceState state;
    after(mapper, state, 0, 128);
    after(mapper, state, 1, 128);
    Wish wish;
    for (int i = 0; i <= 100; ++i) wish = after(mapper, state, 0, 255, i * 1'000'000LL).wish;
    EXPECT_NEAR(wish.side, 1 - std::exp(-1.0), 0.01);
    for (int i = 101; i < 1200; ++i) wish = after(mapper, state, 0, 128, i * 1'000'000LL).wish;
    EXPECT_EQ(wish.side, 0);
}

TEST(Mapper, WhatCannotBeBoundIsNamedWithTheNearest) {
    DeviceMapping m = test::stick_mapping();
    m.name = "lobby";
    m.sticks[0].controls[1].name = "yy";
    auto bad = compile(m, test::stick_controls());
    ASSERT_FALSE(bad.ok());
    EXPECT_NE(bad.error().text().find("'yy'"), std::string::npos);
    EXPECT_NE(bad.error().text().find("did you mean 'y'"), std::string::npos) << bad.error().text();
    EXPECT_EQ(compile_what_fits(m, test::stick_controls()).notes.size(), 1U);
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
    Wish a, b;
    a.forward = b.forward = 1;
    a.side = 1;
    a.turn = b.turn = a.look = 1;
    a.speed = b.speed = 1;
    b.tour = true;
    const Wish sum = merge(std::vector{a, b});
    EXPECT_NEAR(std::hypot(sum.forward, sum.side, sum.up), 1, 1e-12);
    EXPECT_NEAR(std::hypot(sum.turn, sum.look), 1, 1e-12);
    EXPECT_EQ(sum.speed, 1);
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
