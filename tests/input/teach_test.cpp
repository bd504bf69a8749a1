// Learning a mapping by showing, on synthetic reports: who moved furthest, levers that stay, triggers, hats, trembling sticks.
#include <gtest/gtest.h>

#include <cmath>

#include "input/map/mapper.hpp"
#include "input/map/steering_file.hpp"
#include "input/map/teach.hpp"
#include "tests/input/hid_test.hpp"
#include "tests/input/stick_fixture.hpp"
#include "tests/time_units.hpp"

namespace surefoot::input {
namespace {

/// A user with one device, in virtual time: reports every 10 ms.
struct User {
    explicit User(std::vector<ControlInfo> infos, TeachLimits limits = {}) : teach(limits), controls(std::move(infos)) {
        number = teach.add_device({0x1d50, 0x8000, "pad", DeviceClass::navigation}, controls);
        for (std::size_t i = 0; i < controls.size(); ++i)
            if (controls[i].kind == ControlKind::axis && !controls[i].relative)
                test::set(state, i, (controls[i].logical_min + controls[i].logical_max + 1) / 2);
    }
    void report(int times = 1) {
        for (int i = 0; i < times; ++i) {
            now += 10 * ms;
            teach.observe(number, state, now);
        }
    }
    void wait_for_question() {
        for (int i = 0; i < 1000 && teach.phase() == Teach::Phase::rest; ++i) report();
        ASSERT_NE(teach.phase(), Teach::Phase::rest);
    }
    [[nodiscard]] std::size_t at(const std::string& name) const {
        for (std::size_t i = 0; i < controls.size(); ++i)
            if (controls[i].name == name) return i;
        ADD_FAILURE() << name;
        return 0;
    }
    /// To `value` in ten steps, and back.
    void push(const std::string& name, std::int32_t value, bool back = true) {
        const std::size_t i = at(name);
        const std::int32_t rest = state.value[i];
        for (int k = 1; k <= 10; ++k) {
            state.value[i] = rest + (value - rest) * k / 10;
            state.has_value.set(i);
            report();
        }
        if (back) state.value[i] = rest;
        report(back ? 3 : 100);
    }
    void show(const std::string& name, std::int32_t value, bool back = true) {
        wait_for_question();
        push(name, value, back);
    }
    void skip() {
        wait_for_question();
        teach.skip(now);
    }
    void skip_rest() {
        while (teach.phase() != Teach::Phase::done) skip();
    }
    Teach teach;
    std::vector<ControlInfo> controls;
    DeviceState state;
    std::int64_t now = 1'000'000'000;
    int number = 0;
};

std::vector<ControlInfo> pad() {
    using test::axis;
    return {axis("x", 0x30, 0, 255),
            axis("y", 0x31, 0, 255),
            axis("z", 0x32, 0, 255),
            axis("rz", 0x35, 0, 255),
            axis("rx", 0x33, 0, 255),
            axis("slider", 0x36, 0, 1023),
            test::hat(),
            test::button(1),
            test::button(2),
            test::button(3),
            test::button(4)};
}

/// Asked of a device that was taught, with one control held.
DeviceOutput output_of(const DeviceMapping& mapping, User& user, const std::string& name, std::int32_t value) {
    auto mapper = compile(mapping, user.controls);
    EXPECT_TRUE(mapper.ok()) << (mapper.ok() ? "" : mapper.error().text());
    DeviceState state = user.state;
    const std::size_t i = user.at(name);
    state.reports = 1;
    DeviceOutput a;
    std::int64_t now = 0;
    for (int k = 0; k < 20; ++k) a = evaluate(*mapper, state, now += 10 * ms);
    state.value[i] = value;
    state.has_value.set(i);
    for (int k = 0; k < 200; ++k) {
        ++state.reports;
        a = evaluate(*mapper, state, now += 10 * ms);
    }
    return a;
}

TEST(Teach, AGamepadIsTaughtAndSteersAsItWasShown) {
    User u(pad());
    u.state.value[u.at("rx")] = 0;  // a trigger
    u.show("y", 0);                 // forward: away from the user
    u.show("x", 255);               // to the right
    u.show("rx", 255);              // rises by a trigger, which goes one way only,
    u.skip();                       // so sinking is asked for as well
    u.show("z", 0);                 // turns to the left
    u.show("rz", 0);                // looks up
    u.show("slider", 1023, false);  // faster: a lever that stays there
    u.show("button-1", 1);
    u.show("button-3", 1);
    u.skip();
    u.show("button-4", 1);
    ASSERT_EQ(u.teach.phase(), Teach::Phase::done);
    ASSERT_EQ(u.teach.mappings().size(), 1U);
    DeviceMapping m = u.teach.mappings().front();
    EXPECT_EQ(m.match.vendor, 0x1d50);
    ASSERT_EQ(m.sticks.size(), 2U) << "x and y, z and rz are sticks";
    EXPECT_EQ(m.sticks[0].actions, (std::array{Action::side, Action::forward}));
    EXPECT_EQ(m.sticks[0].invert, (std::array{false, true}));
    EXPECT_EQ(m.sticks[1].actions, (std::array{Action::turn, Action::look}));
    u.state.value[u.at("slider")] = 512;
    EXPECT_NEAR(output_of(m, u, "y", 0).request.forward, 1, 1e-3);
    EXPECT_NEAR(output_of(m, u, "x", 255).request.side, 1, 1e-3);
    EXPECT_NEAR(output_of(m, u, "x", 0).request.side, -1, 1e-3);
    EXPECT_NEAR(output_of(m, u, "rx", 255).request.up, 1, 1e-3);
    EXPECT_EQ(output_of(m, u, "rx", 0).request.up, 0);
    EXPECT_NEAR(output_of(m, u, "z", 0).request.turn, 1, 1e-3);
    EXPECT_NEAR(output_of(m, u, "rz", 0).request.look, 1, 1e-3);
    EXPECT_GT(output_of(m, u, "slider", 1023).request.speed, 0.9);
    ASSERT_EQ(m.buttons.size(), 3U);
    EXPECT_EQ(m.buttons[0].action, Action::next_viewpoint);
    EXPECT_EQ(m.buttons[1].control.name, "button-3");
    EXPECT_EQ(m.buttons[2].action, Action::pause);
    // What is written is read back the same.
    SteeringFile file;
    file.devices = u.teach.mappings();
    const std::string text = steering_text(file);
    const auto again = parse_steering(text, "shown.toml");
    ASSERT_TRUE(again.ok()) << again.error().text() << "\n" << text;
    EXPECT_EQ(steering_text(*again), text);
}

TEST(Teach, OfTwoThatMoveTheFurtherOneIsMeant) {
    User u(pad());
    u.wait_for_question();
    const std::size_t x = u.at("x"), y = u.at("y");
    for (int k = 1; k <= 10; ++k) {  // a thumb that pushes y also takes x along, at first even further
        u.state.value[y] = 128 - 12 * k;
        u.state.value[x] = 128 + std::min(8 * k, 60);
        u.report();
    }
    u.state.value[x] = u.state.value[y] = 128;
    u.report(3);
    ASSERT_EQ(u.teach.learned().size(), 1U);
    EXPECT_EQ(u.teach.learned()[0].control, y);
    EXPECT_FALSE(u.teach.learned()[0].positive);
}

TEST(Teach, ATriggerIsAnAxisThoughItPressesAButtonAsWell) {
    User u(pad());
    u.state.value[u.at("rx")] = 0;
    u.wait_for_question();
    test::set(u.state, u.at("button-2"), 1);
    u.push("rx", 255);
    test::set(u.state, u.at("button-2"), 0);
    u.report(3);
    ASSERT_FALSE(u.teach.learned().empty());
    EXPECT_EQ(u.teach.learned()[0].control, u.at("rx"));
    EXPECT_EQ(u.teach.learned()[0].rest, Rest::min);
    EXPECT_EQ(u.teach.action(), Action::forward) << "the other way is asked next";
}

TEST(Teach, HatsAreTwoControlsAndButtonsMayWalk) {
    User u(pad());
    const std::size_t h = u.at("hat");
    const auto press_hat = [&](std::int32_t direction) {
        u.wait_for_question();
        test::set(u.state, h, direction);
        u.report(3);
        u.state.has_value.reset(h);
        u.report(3);
    };
    press_hat(0);           // forward by up
    press_hat(6);           // side: shown to the left, so it is turned round
    u.show("button-2", 1);  // rises
    u.show("button-3", 1);  // sinks
    u.skip_rest();
    const DeviceMapping m = u.teach.mappings().front();
    ASSERT_EQ(m.hats.size(), 1U);
    EXPECT_EQ(m.hats[0].actions, (std::array{Action::side, Action::forward}));
    EXPECT_EQ(m.hats[0].invert, (std::array{true, false}));
    ASSERT_EQ(m.buttons.size(), 2U);
    EXPECT_GT(m.buttons[0].scale, 0);
    EXPECT_LT(m.buttons[1].scale, 0);
    EXPECT_EQ(m.buttons[1].action, Action::up);
}

TEST(Teach, WhatIsUsedAlreadyIsNoAnswer) {
    User u(pad());
    u.show("y", 0);
    u.show("y", 0);
    EXPECT_EQ(u.teach.learned().size(), 1U);
    EXPECT_EQ(u.teach.action(), Action::side);
}

TEST(Teach, TremorAndSmallMovesAnswerNothingAndTimeIsUpByItself) {
    User u(pad());
    u.wait_for_question();
    const std::size_t y = u.at("y");
    const std::int64_t from = u.now;
    while (u.teach.action() == Action::forward && u.now - from < 60'000 * ms) {
        u.state.value[y] = 128 + static_cast<int>(u.now / (10 * ms) % 5) - 2;
        u.state.value[u.at("x")] = 150;
        u.report();
    }
    EXPECT_TRUE(u.teach.learned().empty());
    EXPECT_NEAR(static_cast<double>(u.now - from) * 1e-9, 15, 0.1);
}

TEST(Teach, ADeviceThatSpeaksOnlyWhenItIsMovedIsKnownByItsFirstReport) {
    User u(pad());
    u.state.has_value.reset();
    u.wait_for_question();
    const std::size_t y = u.at("y");
    for (const int value : {120, 80, 40, 0, 0, 60, 128}) {
        test::set(u.state, y, value);
        u.report();
    }
    ASSERT_EQ(u.teach.learned().size(), 1U);
    EXPECT_EQ(u.teach.learned()[0].control, y);
    EXPECT_EQ(u.teach.learned()[0].rest, Rest::centre);
    EXPECT_FALSE(u.teach.learned()[0].positive);
}

TEST(Teach, ASixAxisCapGetsSixAxesThatStream) {
    const Recording r = recorded("spacenavigator-like");
    const HidDevice d = device_of(r);
    User u(d.controls);
    for (std::size_t i = 0; i < d.controls.size(); ++i) test::set(u.state, i, 0);
    u.show("y", -350);
    u.show("x", 350);
    u.show("z", -350);
    u.show("rz", -350);
    u.show("rx", 350);
    u.skip_rest();
    const DeviceMapping m = u.teach.mappings().front();
    EXPECT_EQ(m.sticks.size(), 0U);
    EXPECT_EQ(m.axes.size(), 5U);
    EXPECT_EQ(m.reporting, Reporting::streaming);
    const DeviceMapping usual = default_mapping(d.controls, d.device_class);
    for (const AxisMapping& a : usual.axes)
        for (const AxisMapping& b : m.axes)
            EXPECT_TRUE(a.control.name != b.control.name || a.invert == b.invert) << a.control.name;
}

TEST(Teach, ABallIsLearnedByItsPath) {
    ControlInfo across = test::axis("x", 0x30, -127, 127), along = test::axis("y", 0x31, -127, 127);
    across.relative = along.relative = true;
    User u({across, along});
    u.wait_for_question();
    for (int k = 0; k < 100; ++k) {
        test::set(u.state, 0, k % 2);
        test::set(u.state, 1, -6);
        u.report();
        test::set(u.state, 1, 0);
    }
    ASSERT_GE(u.teach.learned().size(), 1U);
    EXPECT_EQ(u.teach.learned()[0].control, 1U);
    EXPECT_FALSE(u.teach.learned()[0].positive);
}

TEST(Teach, NothingShownIsNothingMapped) {
    User u(pad());
    u.skip_rest();
    EXPECT_TRUE(u.teach.mappings().empty());
}

}  // namespace
}  // namespace surefoot::input
