// Adapters for several pads: one device whose sockets are like applications, of which any may be without a pad.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "input/map/mapper.hpp"
#include "input/steering.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

/// Of an application with X, Y, Z and Rz of 0..255 and eight buttons.
std::string pad(const std::string& usage, const std::string& report_id) {
    return "05 01 09 " + usage + " a1 01 85 " + report_id +
           " 15 00 26 ff 00 75 08 95 04 09 30 09 31 09 32 09 35 81 02"
           " 05 09 19 01 29 08 15 00 25 01 75 01 95 08 81 02 c0 ";
}

struct Adapter {
    explicit Adapter(const std::string& descriptor)
        : live(describe_device(layout_of(hex(descriptor)), {})),
          mapping(default_mapping(live.device.controls, live.device.device_class)),
          mapper(*compile(mapping, live.device.controls)) {}
    DeviceOutput after(const std::string& report) {
        EXPECT_EQ(live.feed(report), ReportFate::accepted) << report;
        return evaluate(mapper, live.state, now_ns += 500'000'000);  // what is smoothed has come to its end
    }
    Live live;
    DeviceMapping mapping;
    Mapper mapper;
    std::int64_t now_ns = 0;
};

TEST(Adapter, APadSteersFromWhicheverSocketItIsIn) {
    Adapter two(pad("04", "01") + pad("04", "02"));
    EXPECT_EQ(two.mapping.name, "default: gamepad, 2 ports");
    EXPECT_TRUE(two.after("01 80 80 80 80 00").neutral);
    EXPECT_TRUE(two.after("02 80 80 80 80 00").neutral);
    EXPECT_NEAR(two.after("01 80 00 80 80 00").request.forward, 1, 1e-4);
    EXPECT_NEAR(two.after("01 80 80 80 80 00").request.forward, 0, 1e-9);
    EXPECT_NEAR(two.after("02 80 00 80 80 00").request.forward, 1, 1e-4);
    EXPECT_LE(two.after("01 80 00 80 80 00").request.forward, 1 + 1e-9) << "two hands are no faster than one";
    two.after("01 80 80 80 80 00");
    two.after("02 80 80 80 80 00");
    EXPECT_TRUE(two.after("02 80 80 80 80 01").request.next_viewpoint);
    EXPECT_FALSE(two.after("01 80 80 80 80 00").request.next_viewpoint);
    EXPECT_TRUE(two.after("01 80 80 80 80 02").request.reset);
}

TEST(Adapter, AnEmptySocketThatIsNeverAtRestHoldsNobody) {
    for (const bool first_is_empty : {true, false}) {
        Adapter two(pad("05", "01") + pad("05", "02"));
        const std::string empty = first_is_empty ? "01" : "02", used = first_is_empty ? "02" : "01";
        EXPECT_EQ(two.after(empty + " 00 00 00 00 00").request.forward, 0) << "never seen at rest";
        EXPECT_TRUE(two.after(used + " 80 80 80 80 00").neutral);
        const DeviceOutput pushed = two.after(used + " 80 00 80 80 00");
        EXPECT_NEAR(pushed.request.forward, 1, 1e-4);
        EXPECT_NEAR(pushed.request.side, 0, 0.01) << "the other socket's corner";
        EXPECT_TRUE(two.after(used + " 80 80 80 80 00").neutral);
    }
}

/// The same pad with a hat of eight directions in a byte of its own.
std::string pad_with_hat(const std::string& report_id) {
    return "05 01 09 05 a1 01 85 " + report_id +
           " 15 00 26 ff 00 75 08 95 04 09 30 09 31 09 32 09 35 81 02"
           " 25 07 95 01 09 39 81 42"
           " 05 09 19 01 29 08 25 01 75 01 95 08 81 02 c0 ";
}

TEST(Adapter, AnEmptySocketsHatAndButtonsAreUnknownUntilItReports) {
    Adapter two(pad_with_hat("01") + pad_with_hat("02"));
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(two.after("02 80 80 80 80 0f 00").neutral);
    for (int i = 0; i < 3; ++i) {
        const DeviceOutput empty = two.after("01 00 00 00 00 00 ff");
        EXPECT_EQ(empty.request.up, 0) << "a hat that was never seen centred";
        EXPECT_FALSE(empty.request.next_viewpoint || empty.request.reset || empty.request.tour || empty.request.pause)
            << "buttons that were held when they were first heard of";
    }
    EXPECT_GT(two.after("02 80 80 80 80 00 00").request.up, 0.4) << "the pad's own hat";
    EXPECT_TRUE(two.after("02 80 80 80 80 0f 01").request.next_viewpoint);
}

TEST(Adapter, APadThatIsPulledOutPushedStopsWhileAnotherReportsOn) {
    const HidDevice d = describe_device(layout_of(hex(pad("05", "01") + pad("05", "02"))), {});
    Steering steering(MotionLimits{}, SafetyLimits{});
    steering.steers.plays();
    const DeviceMapping mapping = default_mapping(d.controls, d.device_class);
    const int device = steering.attach(*compile(mapping, d.controls), d.controls.size(), mapping.reporting);
    ReportDecoder decoder(d);
    DeviceState state;
    NavigationSample last;
    double fastest = 0;
    for (int ms = 0; ms < 3000; ++ms) {
        const std::int64_t now_ns = ms * 1'000'000LL;
        const bool first = (ms / 4) % 2 == 0, pulled = ms >= 1500;
        if (ms % 4 == 0 && !(first && pulled)) {
            const std::string hand = first ? ms < 200 ? "01 80 80 80 80 00" : "01 80 00 80 80 00" : "02 80 80 80 80 00";
            ASSERT_EQ(decoder.decode(hex(hand), now_ns, state), ReportFate::accepted);
            steering.report(device, state, now_ns);
            steering.drained(device, 1);
        }
        last = steering.tick({}, now_ns);
        fastest = std::max(fastest, glm::length(last.velocity_m_s));
        if (ms == 1400) {
            EXPECT_GT(glm::length(last.velocity_m_s), 1) << "held, it walks on";
        }
    }
    EXPECT_EQ(glm::length(last.velocity_m_s), 0);
}

TEST(Adapter, OfPucksStreamsAsAPuckDoes) {
    const auto puck = [](const std::string& id) {
        return "05 01 09 08 a1 01 85 " + id + " 16 a2 fe 26 5e 01 75 10 95 06 09 30 09 31 09 32 09 33 09 34 09 35 81 02 c0 ";
    };
    const Adapter two(puck("01") + puck("02"));
    EXPECT_EQ(two.mapping.name, "default: six axes, 2 ports");
    EXPECT_EQ(two.mapping.reporting, Reporting::streaming);
}

TEST(Adapter, APadThatComesDeflectedIsAtRestUntilSeenNeutral) {
    Adapter two(pad("04", "01") + pad("04", "02"));
    two.after("02 80 80 80 80 00");
    EXPECT_EQ(two.after("01 ff 00 80 80 00").request.forward, 0);
    EXPECT_EQ(two.after("01 80 80 80 80 00").request.forward, 0);
    EXPECT_GT(two.after("01 80 00 80 80 00").request.forward, 0.99);
}

TEST(Adapter, WhatIsNoSecondPadIsNoPort) {
    // Two halves of one control, as pucks have; a pad with a mouse beside; a joystick beside a game pad.
    const std::string halves =
        "05 01 09 08 a1 01 a1 00 85 01 16 a2 fe 26 5e 01 75 10 95 03 09 30 09 31 09 32 81 02 c0"
        " a1 00 85 02 95 03 09 33 09 34 09 35 81 02 c0 c0";
    const std::string mouse =
        "05 01 09 02 a1 01 85 02 09 01 a1 00 15 81 25 7f 75 08 95 02 09 30 09 31 81 06"
        " 05 09 19 01 29 03 15 00 25 01 75 01 95 03 81 02 75 05 95 01 81 03 c0 c0";
    for (const std::string& descriptor : {halves, pad("05", "01") + mouse, pad("05", "01") + pad("04", "02")}) {
        const HidDevice d = describe_device(layout_of(hex(descriptor)), {});
        for (const ControlInfo& c : d.controls) EXPECT_EQ(c.port, 0) << c.name;
        EXPECT_EQ(default_mapping(d.controls, d.device_class).name.find("ports"), std::string::npos);
    }
}

}  // namespace
}  // namespace surefoot::input
