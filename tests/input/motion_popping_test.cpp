// Tremor of two counts must neither move a resting eye nor make representations pop around a switching distance. The counts are
// bytes of a joystick's reports: they go the way of every device, through its descriptor, the decoder and its default mapping.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "rt/base/random.hpp"
#include "tests/input/hid_test.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

/// X, Y and a twist of 0..255, a byte each, every millisecond: X and Y walk, the twist rests.
class Stick : public test::Walk {
public:
    Stick()
        : live_(describe_device(layout_of(hex("05 01 09 04 a1 01 15 00 26 ff 00 75 08 95 03 09 30 09 31 09 35 81 02 c0")), {})),
          device_(attach()) {}

    void hold(int x, int y, int milliseconds) {
        for (int i = 0; i < milliseconds; ++i) {
            const std::array bytes = {static_cast<std::byte>(x), static_cast<std::byte>(y), std::byte{128}};
            EXPECT_EQ(live_.decoder.decode(bytes, now_ns, live_.state), ReportFate::accepted);
            steering.steers.plays();
            steering.report(device_, live_.state, now_ns);
            steering.drained(device_, 1);
            tick();
        }
    }

private:
    int attach() {
        const HidDevice& d = live_.device;
        EXPECT_EQ(d.device_class, DeviceClass::navigation) << d.reason;
        steering.steers.plays();
        return steering.attach(*compile(default_mapping(d.controls, d.device_class), d.controls), d.controls.size(),
                               Reporting::streaming);
    }

    Live live_;
    int device_;
};

/// A hand's tremor: 8 to 12 Hz, and the converter's noise, together at most two counts.
class Tremor {
public:
    int at(double t) {
        const double hand =
            1.3 * std::sin(6.283185 * 9.1 * t) + 0.6 * std::sin(6.283185 * 11.7 * t + 1) + random_.range(-0.6, 0.6);
        return static_cast<int>(std::lround(std::clamp(hand, -2.0, 2.0)));
    }

private:
    Random random_{77};
};

/// How often a quantity crosses a threshold: each crossing is a switch of a representation that is chosen by it.
struct Switch {
    double threshold;
    bool above = false, known = false;
    int count = 0;
    void see(double value) {
        const bool now = value > threshold;
        if (known && now != above) ++count;
        above = now;
        known = true;
    }
};

constexpr int seconds = 60;

TEST(Popping, TremorAtRestChangesNoPose) {
    for (const int centre : {127, 128, 131, 124}) {
        Stick walk;
        walk.hold(centre, centre, 1);
        Tremor across, along;
        const auto start = walk.last.pose;
        int changes = 0;
        for (int i = 0; i < seconds * 1000; ++i) {
            const auto before = walk.last.pose;
            walk.hold(centre + across.at(i * 1e-3), centre + along.at(i * 1e-3 + 0.3), 1);
            changes += before.position != walk.last.pose.position || before.orientation != walk.last.pose.orientation ? 1 : 0;
        }
        EXPECT_EQ(changes, 0) << centre;
        EXPECT_EQ(walk.last.pose.position, start.position);
        walk.hold(centre, 10, 200);
        EXPECT_GT(walk.speed(), 0) << "void: the stick does not steer";
    }
}

/// Standing at the switching distance with a trembling hand on the stick: the eye sways across it, or not.
TEST(Popping, TremorAtASwitchingDistanceSwitchesNothing) {
    const MotionLimits limits;
    Stick walk;
    walk.hold(128, 128, 1000);
    Tremor hand;
    Switch with{walk.last.pose.position.z, false, false, 0}, without{0, false, false, 0};
    double raw_z = 0;
    // The bare walk sways about its threshold; its slow drift is taken out, so that it stays there.
    double mean = 0;
    for (int i = 0; i < seconds * 1000; ++i) {
        const int count = hand.at(i * 1e-3);
        raw_z += count / 127.5 * limits.walk_m_s * 1e-3;
        mean += (raw_z - mean) * 1e-3 * 6;
        without.see(raw_z - mean);
        walk.hold(128, 128 + count, 1);
        with.see(walk.last.pose.position.z);
    }
    const double per_s = without.count / double(seconds), filtered = with.count / double(seconds);
    std::printf("switches a second at a switching distance: %.2f without, %.2f with the filter\n", per_s, filtered);
    ASSERT_GE(per_s, 5) << "void: the bare hand did not switch often enough";
    EXPECT_LE(filtered, per_s / 10);
    walk.hold(128, 10, 200);
    EXPECT_GT(walk.speed(), 0) << "void: the stick does not steer";
}

/// Walking on with a trembling hand, at a deflection whose speed is just where a representation is chosen by motion (its benefit
/// falls with speed), and turning in the same way. Every place in the travel, the dead zone's edge included.
TEST(Popping, TremorAtASwitchingSpeedSwitchesATenthAtMost) {
    const MotionLimits limits;
    int voids = 0, places = 0;
    double worst = 0, lag = 0;
    for (int hold = 12; hold <= 108; hold += 12) {
        Stick walk;
        walk.hold(128, 128, 20);
        Tremor hand;
        // The filter's own threshold: the speed at which this hand settles.
        for (int i = 0; i < 3000; ++i) walk.hold(128, 128 - hold + hand.at(i * 1e-3), 1);
        if (hold > 20) {
            ASSERT_GT(walk.speed(), 0) << "void: the stick does not steer";
        }
        Switch with{walk.speed(), false, false, 0}, without{hold / 127.5 * limits.walk_m_s, false, false, 0};
        for (int i = 0; i < seconds * 1000; ++i) {
            const int count = hand.at(3 + i * 1e-3);
            without.see((hold - count) / 127.5 * limits.walk_m_s);
            walk.hold(128, 128 - hold + count, 1);
            with.see(walk.speed());
        }
        const double per_s = without.count / double(seconds), filtered = with.count / double(seconds);
        ++places;
        voids += per_s < 5 ? 1 : 0;
        worst = std::max(worst, filtered / per_s);
        EXPECT_LE(filtered, per_s / 10) << "held at " << hold << " counts: " << per_s << " without";
        walk.steering.steers.plays();
        lag = walk.steering.worst_lag_s();
    }
    std::printf(
        "switching speeds at %d deflections: at most %.3f of the bare switches; lag of filter and mapping at most %.1f ms\n",
        places, worst, lag * 1e3);
    ASSERT_EQ(voids, 0) << "void: the bare hand did not switch often enough";
}

}  // namespace
}  // namespace surefoot::input
