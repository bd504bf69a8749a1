// Tremor of two counts must neither move a resting eye nor make representations pop around a switching distance.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "rt/base/random.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

using test::Walk;

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
        Walk walk;
        const int device = walk.plug();
        walk.hold(device, centre, centre, 1);
        Tremor across, along;
        const auto start = walk.last.pose;
        int changes = 0;
        for (int i = 0; i < seconds * 1000; ++i) {
            const auto before = walk.last.pose;
            walk.hold(device, centre + across.at(i * 1e-3), centre + along.at(i * 1e-3 + 0.3), 1);
            changes += before.position != walk.last.pose.position || before.orientation != walk.last.pose.orientation ? 1 : 0;
        }
        EXPECT_EQ(changes, 0) << centre;
        EXPECT_EQ(walk.last.pose.position, start.position);
    }
}

/// Standing at the switching distance with a trembling hand on the stick: the eye sways across it, or not.
TEST(Popping, TremorAtASwitchingDistanceSwitchesNothing) {
    const MotionLimits limits;
    Walk walk;
    const int device = walk.plug();
    walk.hold(device, 128, 128, 1000);
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
        walk.hold(device, 128, 128 + count, 1);
        with.see(walk.last.pose.position.z);
    }
    const double per_s = without.count / double(seconds), filtered = with.count / double(seconds);
    std::printf("switches a second at a switching distance: %.2f without, %.2f with the filter\n", per_s, filtered);
    ASSERT_GE(per_s, 5) << "void: the bare hand did not switch often enough";
    EXPECT_LE(filtered, per_s / 10);
}

/// Walking on with a trembling hand, at a deflection whose speed is just where a representation is chosen by motion (its benefit
/// falls with speed), and turning in the same way. Every place in the travel, the dead zone's edge included.
TEST(Popping, TremorAtASwitchingSpeedSwitchesATenthAtMost) {
    const MotionLimits limits;
    int voids = 0, places = 0;
    double worst = 0, lag = 0;
    for (int hold = 12; hold <= 108; hold += 12) {
        Walk walk;
        const int device = walk.plug();
        walk.hold(device, 128, 128, 20);
        Tremor hand;
        // The filter's own threshold: the speed at which this hand settles.
        for (int i = 0; i < 3000; ++i) walk.hold(device, 128, 128 - hold + hand.at(i * 1e-3), 1);
        Switch with{walk.speed(), false, false, 0}, without{hold / 127.5 * limits.walk_m_s, false, false, 0};
        for (int i = 0; i < seconds * 1000; ++i) {
            const int count = hand.at(3 + i * 1e-3);
            without.see((hold - count) / 127.5 * limits.walk_m_s);
            walk.hold(device, 128, 128 - hold + count, 1);
            with.see(walk.speed());
        }
        const double per_s = without.count / double(seconds), filtered = with.count / double(seconds);
        ++places;
        voids += per_s < 5 ? 1 : 0;
        worst = std::max(worst, filtered / per_s);
        EXPECT_LE(filtered, per_s / 10) << "held at " << hold << " counts: " << per_s << " without";
        lag = walk.steering.worst_lag_s();
    }
    std::printf(
        "switching speeds at %d deflections: at most %.3f of the bare switches; lag of filter and mapping at most %.1f ms\n",
        places, worst, lag * 1e3);
    ASSERT_EQ(voids, 0) << "void: the bare hand did not switch often enough";
}

}  // namespace
}  // namespace surefoot::input
