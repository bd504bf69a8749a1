// Between devices and steering, in virtual time: mappings, pulled and replugged devices, reports that are refused, who may steer.
#include "input/devices/device_router.hpp"

#include "tests/input/fake_devices.hpp"
#include "tests/input/plain_stick.hpp"

namespace surefoot::input {
namespace {

using test::at;
using test::stick;

constexpr std::int64_t tick_ns = 1'000'000;

struct Hands {
    explicit Hands(std::vector<DeviceMapping> mappings = {})
        : router(std::move(mappings), steering, [this](std::string_view text) { messages.emplace_back(text); }) {}
    void tick() {
        router.dispatch(source.take());
        source.now_ns += tick_ns;
        steering.steers.plays();
        sample = steering.tick({}, source.now_ns);
    }
    void hold(int device, int x, int y, int times) {
        for (int i = 0; i < times; ++i) {
            source.send(device, at(x, y));
            tick();
        }
    }
    [[nodiscard]] double speed() const { return glm::length(sample.velocity_m_s); }
    /// The steering's numbers that a device has, as of the last tick.
    [[nodiscard]] std::vector<int> numbers() { return test::connected_numbers(steering); }

    test::FakeDevices source;
    Steering steering{MotionLimits{}, SafetyLimits{}};
    std::vector<std::string> messages;
    DeviceRouter router;
    NavigationSample sample;
};

TEST(DeviceRouter, ADeviceSteersAndItsLossIsRestInFiftyMilliseconds) {
    Hands h;
    const int device = h.source.plug(stick());
    h.hold(device, 0, 0, 10);
    h.hold(device, 0, -127, 500);
    ASSERT_GT(h.speed(), 0.5);
    h.source.send(device, at(0, -127));
    h.source.pull(device);
    h.source.send(device, at(0, -127));  // whoever reports after it went is not heard
    int ticks = 0;
    for (; h.speed() > 0 && ticks < 1000; ++ticks) h.tick();
    EXPECT_LE(ticks, 50);
    EXPECT_EQ(h.router.steering_now(), 0);
}

TEST(DeviceRouter, TheSameDeviceGetsItsNumberAgainAndAnotherDoesNot) {
    Hands h;
    const int a = h.source.plug(stick(), "0001"), b = h.source.plug(stick(), "0002");
    h.hold(a, 0, 0, 5);
    h.hold(b, 0, 0, 5);
    ASSERT_EQ(h.numbers(), (std::vector{0, 1}));
    h.source.pull(a);
    h.source.pull(b);
    h.tick();
    EXPECT_TRUE(h.numbers().empty());
    h.source.plug(stick(), "0002", "usb-7/input0");  // into another socket
    h.tick();
    EXPECT_EQ(h.numbers(), std::vector{1});
    h.source.plug(stick(), "0003");
    h.tick();
    EXPECT_EQ(h.numbers(), (std::vector{0, 1})) << "nobody waits for the first number";
}

TEST(DeviceRouter, AThousandPluggingsUseUpNothing) {
    Hands h;
    for (int i = 0; i < 1000; ++i) {
        const int device = h.source.plug(stick(), std::to_string(i));
        h.hold(device, 0, 0, 2);
        ASSERT_EQ(h.router.steering_now(), 1) << i;
        h.source.pull(device);
        h.tick();
    }
}

TEST(DeviceRouter, RefusedReportsChangeNothingAndAreCounted) {
    Hands h;
    const int device = h.source.plug(stick());
    h.hold(device, 0, 0, 10);
    h.hold(device, 0, -127, 200);
    const double speed = h.speed();
    h.source.send(device, {std::byte{0}});
    h.source.send(device, {std::byte{0}, std::byte{0}, std::byte{0}});
    h.tick();
    EXPECT_NEAR(h.speed(), speed, 0.2);
    EXPECT_EQ(h.router.refused_reports(), 2U);
    EXPECT_EQ(h.router.accepted_reports(), 210U);
}

TEST(DeviceRouter, TheConfigurationComesBeforeTheClassAndAcceptsMice) {
    DeviceMapping mouse;
    mouse.name = "my mouse";
    mouse.match.product_name = "mouse";
    AxisMapping walk;
    walk.control.name = "y";
    walk.action = Action::forward;
    walk.counts_per_s = 500;
    mouse.axes.push_back(walk);
    Recording r = recorded("boot-mouse");
    PluggedDevice p;
    p.name = r.name = "Some Mouse";
    p.device = device_of(r);
    EXPECT_FALSE(wanted_by({})(p));
    EXPECT_TRUE(wanted_by({mouse})(p));
    DeviceMapping nothing = mouse;
    nothing.axes.clear();
    EXPECT_FALSE(wanted_by({nothing})(p)) << "a mapping without controls switches a device off";
    Hands h({mouse});
    h.source.plug(r);
    h.tick();
    ASSERT_EQ(h.router.known_devices().size(), 1U);
    EXPECT_EQ(h.router.known_devices()[0].mapping, "my mouse");
}

TEST(DeviceRouter, WhatAMappingNamesInVainIsReported) {
    DeviceMapping m;
    m.name = "shown";
    AxisMapping a;
    a.control.name = "throttle";
    a.action = Action::forward;
    m.axes.push_back(a);
    Hands h({m});
    h.source.plug(stick());
    h.tick();
    ASSERT_GE(h.messages.size(), 2U);
    EXPECT_NE(h.messages[0].find("throttle"), std::string::npos) << h.messages[0];
}

TEST(DeviceRouter, TheSeventeenthDeviceIsRefused) {
    Hands h;
    for (int i = 0; i < 17; ++i) h.source.plug(stick(), std::to_string(i));
    h.tick();
    EXPECT_EQ(h.router.steering_now(), static_cast<int>(max_devices));
    EXPECT_NE(h.messages.back().find("16 devices"), std::string::npos) << h.messages.back();
}

TEST(PluggedDevice, IsKnownBySerialElseBySocket) {
    PluggedDevice a;
    a.vendor = 1;
    a.product = 2;
    a.socket = "usb-1/input0";
    PluggedDevice b = a;
    b.socket = "usb-1/input1";
    EXPECT_NE(a.identity(), b.identity());
    a.serial = b.serial = "s";
    EXPECT_NE(a.identity(), b.identity()) << "two interfaces of one device";
    b.socket = "usb-9/input0";
    EXPECT_EQ(a.identity(), b.identity());
}

}  // namespace
}  // namespace surefoot::input
