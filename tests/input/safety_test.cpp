// Safety: rest after loss, silence, overflow and replug; stops that latch; the dead-man. As logic, without devices.
#include "input/safety/safety.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "input/safety/stop_memory.hpp"
#include "rt/base/random.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

using test::Walk;

int ticks_to_rest(Walk& walk, int limit = 1000) {
    for (int i = 0; i < limit; ++i) {
        if (walk.speed() == 0 && walk.last.angular_rad_s == dvec3(0.0)) return i;
        walk.tick();
    }
    return limit;
}

/// A stick at rest, then pushed forward and walking.
int walking(Walk& walk, Reporting reporting = Reporting::streaming) {
    const int device = walk.plug(test::stick_mapping(), reporting);
    walk.hold(device, 128, 128, 10);
    walk.hold(device, 128, 0, 1000);
    EXPECT_GT(walk.speed(), 1.3);
    return device;
}

TEST(Unplug, RestsWithinFiftyMillisecondsWhateverTheDeflection) {
    Random random(2);
    int worst = 0;
    for (int i = 0; i < 200; ++i) {
        Walk walk;
        const int device = walk.plug();
        walk.hold(device, 128, 128, 5);
        const int pieces = 1 + static_cast<int>(random.below(3));
        for (int k = 0; k < pieces; ++k)
            walk.hold(device, static_cast<int>(random.below(256)), static_cast<int>(random.below(256)),
                      static_cast<int>(random.below(300)));
        if (i % 2 == 0) walk.send(device, 255, 0);  // a report in flight
        walk.detach(device);
        if (i % 3 == 0) walk.send(device, 0, 255);  // and one that was read too late
        walk.tick();
        worst = std::max(worst, 1 + ticks_to_rest(walk));
        const Pose still = walk.last.pose;
        for (int k = 0; k < 200; ++k) walk.tick();
        ASSERT_EQ(walk.last.pose.position, still.position);
        ASSERT_TRUE(std::isfinite(still.position.x));
    }
    std::printf("unplugged 200 times with random deflection: at rest after at most %d ms\n", worst);
    EXPECT_LE(worst, 50);
}

TEST(Unplug, AReleaseJustBeforeItDoesNotSlowTheBrake) {
    Walk walk;
    const int device = walking(walk);
    walk.hold(device, 128, 128, 2);
    walk.detach(device);
    walk.tick();
    EXPECT_LE(ticks_to_rest(walk), 49);
}

TEST(Unplug, AtThirtyHertzToo) {
    Walk walk;
    const int device = walking(walk);
    walk.detach(device);
    const auto start = walk.now_ns;
    while (walk.tick(33'333'333).velocity_m_s != dvec3(0.0)) ASSERT_LT(walk.now_ns - start, 1'000'000'000);
    EXPECT_LE(walk.now_ns - start, 50'000'000 + 33'333'333) << "one tick later at most";
}

TEST(Replug, DeflectedStaysAtRestUntilSeenNeutral) {
    Walk walk;
    int device = walking(walk);
    walk.detach(device);
    walk.tick();
    ticks_to_rest(walk);
    device = walk.plug(test::stick_mapping(), Reporting::streaming, device);
    walk.hold(device, 128, 0, 2000);
    EXPECT_EQ(walk.speed(), 0);
    EXPECT_EQ(walk.safety().devices[static_cast<std::size_t>(device)].held, Held::not_neutral);
    walk.hold(device, 128, 128, 1);
    walk.hold(device, 128, 0, 500);
    EXPECT_GT(walk.speed(), 1.0);
    // At rest at once: resumes.
    walk.detach(device);
    device = walk.plug(test::stick_mapping(), Reporting::streaming, device);  // between two ticks: still seen
    walk.hold(device, 128, 0, 300);
    EXPECT_EQ(walk.speed(), 0);
}

TEST(Silence, AStreamingDeviceIsBelievedForAHundredMillisecondsOnly) {
    Walk walk;
    const int device = walking(walk);
    const Pose at = walk.last.pose;
    int until = 0;
    while (walk.tick().velocity_m_s != dvec3(0.0) && until < 1000) ++until;
    EXPECT_GT(until, 95);
    EXPECT_LE(until, 140);
    EXPECT_EQ(walk.safety().timeouts, 1U);
    EXPECT_LT(glm::length(walk.last.pose.position - at.position), 0.25);
    walk.hold(device, 128, 0, 500);
    EXPECT_GT(walk.speed(), 1.0) << "it speaks again: no neutral needed, nobody let go";
}

TEST(Silence, AtRestMeansNothing) {
    Walk walk;
    const int device = walk.plug();
    walk.hold(device, 128, 128, 20);
    for (int i = 0; i < 5000; ++i) walk.tick();
    EXPECT_EQ(walk.safety().timeouts, 0U);
    walk.hold(device, 128, 0, 300);
    EXPECT_GT(walk.speed(), 1.0);
}

TEST(Silence, ADeviceThatReportsChangesOnlyIsNotPutToRest) {
    Walk walk;
    const int device = walk.plug(test::stick_mapping(), Reporting::learn);
    walk.send(device, 128, 128);
    walk.tick();
    for (int y = 120; y >= 0; y -= 8) {
        walk.send(device, 128, y);
        walk.tick(4'000'000);
    }
    for (int i = 0; i < 20'000; ++i) walk.tick();
    EXPECT_GT(walk.speed(), 1.3) << "held for 20 s without a report";
    EXPECT_EQ(walk.safety().timeouts, 0U);
}

TEST(Silence, StreamingIsLearnedFromEqualReportsAndUnlearnedFromGaps) {
    Walk walk;
    int device = walking(walk, Reporting::learn);
    EXPECT_TRUE(walk.safety().devices[0].cadence.learned_streaming);
    for (int i = 0; i < 200; ++i) walk.tick();
    EXPECT_EQ(walk.speed(), 0);
    // It goes on as if nothing had been, twice: so silence is normal for it.
    walk.hold(device, 128, 0, 5);
    EXPECT_FALSE(walk.safety().devices[0].cadence.learned_streaming);
    walk.hold(device, 128, 0, 200);
    for (int i = 0; i < 200; ++i) walk.tick();
    walk.hold(device, 128, 0, 500);
    EXPECT_TRUE(walk.safety().devices[0].cadence.barred);
    for (int i = 0; i < 2000; ++i) walk.tick();
    EXPECT_GT(walk.speed(), 1.3);
    // Our own sleep proves nothing against a device.
    Walk other;
    device = walking(other, Reporting::learn);
    other.now_ns += 500'000'000;
    other.hold(device, 128, 0, 10);
    EXPECT_TRUE(other.safety().devices[0].cadence.learned_streaming);
}

/// 16 bits at 125 Hz: a second at rest, one pushed forward, each with noise of a few counts; then nothing more for a second.
double speed_after_silence(int noise, int drift) {
    const std::vector controls = {test::axis("x", 0x30, 0, 65535), test::axis("y", 0x31, 0, 65535)};
    Steering steering(MotionLimits{}, SafetyLimits{});
    steering.steers.plays();
    const int device = steering.attach(*compile(test::stick_mapping(), controls), controls.size(), Reporting::learn);
    DeviceState state;
    state.connected = true;
    NavigationSample last;
    for (int ms = 0; ms < 3000; ++ms) {
        const std::int64_t now_ns = ms * 1'000'000LL;
        if (ms % 8 == 0 && ms < 2000) {
            const int moved = drift * (ms - 1000) / 8, shaken = noise * ((ms / 8) % 3 - 1);
            test::set(state, 0, 32768 + shaken);
            test::set(state, 1, ms < 1000 ? 32768 + shaken : (drift != 0 ? 25000 : 2000) + shaken + moved);
            ++state.reports;
            state.stamp_ns = now_ns;
            steering.report(device, state, now_ns);
            steering.drained(device, 1);
        }
        last = steering.tick({}, now_ns);
    }
    return glm::length(last.velocity_m_s);
}

TEST(Silence, AFineSticksNoiseProvesStreamingAsEqualReportsDo) {
    EXPECT_EQ(speed_after_silence(20, 0), 0);
    EXPECT_GT(speed_after_silence(20, -150), 0.5) << "a hand that moves on proves nothing: such a stick may report changes only";
}

TEST(Silence, OneReportIdsStreamDoesNotKeepAnothersDeflection) {
    std::vector<ControlInfo> controls;
    for (int i = 0; i < 6; ++i)
        controls.push_back(test::axis(std::string(1, "xyzabc"[i]), static_cast<std::uint16_t>(0x30 + i), -350, 350,
                                      "Multi-axis Controller/Physical"));
    Steering steering(MotionLimits{}, SafetyLimits{});
    steering.steers.plays();
    const DeviceMapping mapping = default_mapping(controls, DeviceClass::navigation);
    const int device = steering.attach(*compile(mapping, controls), controls.size(), mapping.reporting);
    DeviceState state;
    double fastest = 0;
    NavigationSample last;
    for (int ms = 0; ms < 1200; ++ms) {
        const std::int64_t now_ns = ms * 1'000'000LL;
        if (ms % 8 == 0) {  // translation until 600 ms, the last of it pushed forward; rotation always, at rest
            const bool translation = (ms / 8) % 2 == 0 && ms < 600;
            if ((ms / 8) % 2 == 0 && !translation) continue;
            for (std::size_t i = 0; i < 6; ++i) state.carried_over.set(i, translation != (i < 3));
            for (std::size_t i = translation ? 0 : 3; i < (translation ? 3U : 6U); ++i)
                test::set(state, i, i == 1 && ms > 100 ? -350 : 0);
            ++state.reports;
            state.stamp_ns = now_ns;
            steering.report(device, state, now_ns);
            steering.drained(device, 1);
        }
        last = steering.tick({}, now_ns);
        fastest = std::max(fastest, glm::length(last.velocity_m_s));
    }
    EXPECT_GT(fastest, 1.0);
    EXPECT_EQ(glm::length(last.velocity_m_s), 0);
}

TEST(Stall, ASleepOfHalfASecondEndsInTheNewestState) {
    Walk walk;
    const int device = walking(walk);
    // Stopped for 500 ms; 50 reports waited, the last says released.
    walk.now_ns += 500'000'000;
    for (int i = 0; i < 49; ++i) walk.send(device, 128, 0);
    walk.send(device, 128, 128);
    walk.drained(device, 50);
    walk.tick();
    EXPECT_EQ(walk.safety().devices[0].passed.forward, 0) << "within one tick";
    for (int i = 0; i < 400; ++i) walk.tick();
    EXPECT_EQ(walk.speed(), 0);
}

TEST(Stall, AFullRingIsRestUntilSomethingNewComes) {
    for (const std::uint32_t count : {62U, 63U, 64U}) {
        Walk walk;
        const int device = walking(walk);
        walk.now_ns += 500'000'000;
        for (std::uint32_t i = 0; i < count; ++i) walk.send(device, 128, 0);  // the release was dropped
        walk.drained(device, count);
        walk.tick();
        const bool full = count >= 63;
        EXPECT_EQ(walk.safety().devices[0].held, full ? Held::overflow : Held::no);
        if (!full) continue;
        EXPECT_LE(ticks_to_rest(walk), 49);
        EXPECT_EQ(walk.safety().overflows, 1U);
        for (int i = 0; i < 100; ++i) walk.tick();
        EXPECT_EQ(walk.speed(), 0);
        walk.hold(device, 128, 0, 300);
        EXPECT_GT(walk.speed(), 1.0) << "the next report is new";
    }
}

TEST(Stall, RingsOfOurOwnCountToo) {
    Walk walk;
    const int device = walking(walk);
    walk.send(device, 128, 0);
    walk.drained(device, 3, true);
    walk.tick();
    EXPECT_LE(ticks_to_rest(walk), 49);
}

TEST(Merge, TwoFullDevicesAreNoFasterAndSwitchingMakesNoStep) {
    const SafetyLimits limits;
    Walk walk;
    const int a = walk.plug(), b = walk.plug();
    walk.hold(a, 128, 128, 1);
    walk.hold(b, 128, 128, 1);
    MotionRequest before;
    Random random(6);
    for (int i = 0; i < 20'000; ++i) {
        if (i % 97 == 0) walk.state = {};
        walk.send(a, i % 400 < 200 ? 255 : 128, i % 300 < 150 ? 0 : 255);
        walk.send(b, i % 500 < 250 ? 0 : 255, i % 700 < 350 ? 0 : 128);
        walk.tick();
        const MotionRequest& now = walk.safety().slewed;
        const double step = std::hypot(now.forward - before.forward, now.side - before.side, now.up - before.up);
        ASSERT_LE(step, limits.slew_per_s * 1e-3 + 1e-12);
        ASSERT_LE(std::hypot(now.forward, now.side, now.up), 1 + 1e-12);
        ASSERT_LE(walk.speed(), MotionLimits{}.walk_m_s + 1e-9);
        before = now;
    }
}

TEST(EmergencyStop, IsThisTickLatchedAndResetOnlyByHand) {
    Walk walk;
    const int device = walking(walk);
    walk.lines.stop = true;
    walk.send(device, 128, 0);
    walk.tick();
    EXPECT_EQ(walk.speed(), 0) << "in the very tick";
    EXPECT_TRUE(walk.last.stopped);
    walk.lines.stop = false;
    walk.hold(device, 128, 0, 500);
    EXPECT_EQ(walk.speed(), 0) << "latched";
    walk.lines = {true, true, false, false};
    walk.hold(device, 128, 0, 50);
    EXPECT_TRUE(walk.safety().latched) << "no reset while it is asserted";
    walk.lines = {false, true, false, false};
    walk.hold(device, 128, 0, 50);
    EXPECT_TRUE(walk.safety().latched) << "nor by a reset that was held since";
    walk.lines.stop_reset = false;
    walk.hold(device, 128, 0, 50);
    walk.lines.stop_reset = true;
    walk.hold(device, 128, 0, 500);
    EXPECT_FALSE(walk.safety().latched);
    EXPECT_EQ(walk.speed(), 0) << "not by a stick that is still pushed";
    walk.hold(device, 128, 128, 1);
    walk.hold(device, 128, 0, 500);
    EXPECT_GT(walk.speed(), 1.0);
}

TEST(EmergencyStop, APulledDeviceWithAStopIsABrokenWire) {
    DeviceMapping m = test::stick_mapping();
    m.buttons = {{{"button-1", 0, 0, ""}, Action::stop, 1, 0, 0, false}};
    Walk walk;
    const int device = walk.plug(m);
    walk.hold(device, 128, 128, 10);
    EXPECT_FALSE(walk.safety().latched);
    walk.detach(device);
    walk.tick();
    EXPECT_TRUE(walk.safety().latched);
    EXPECT_TRUE(walk.last.stopped);
}

TEST(EmergencyStop, ATouchBetweenTwoTicksCounts) {
    DeviceMapping m = test::stick_mapping();
    m.buttons = {{{"button-1", 0, 0, ""}, Action::stop, 1, 0, 0, false}};
    Walk walk;
    const int device = walk.plug(m);
    walk.hold(device, 128, 128, 10);
    test::set(walk.state, 2, 1);
    walk.send(device, 128, 128);
    test::set(walk.state, 2, 0);
    walk.send(device, 128, 128);
    walk.tick();
    EXPECT_TRUE(walk.safety().latched);
}

TEST(EmergencyStop, IsRememberedAcrossRestarts) {
    const std::string file = (std::filesystem::temp_directory_path() / ("surefoot-stop-" + std::to_string(::getpid()))).string();
    std::filesystem::remove(file);
    EXPECT_FALSE(load_stop(file).latched) << "never stopped";
    StopKeeper keeper(file, false);
    keeper.set(true);
    ASSERT_TRUE(keeper.flush().ok());
    EXPECT_TRUE(load_stop(file).latched);
    Steering again({}, {}, load_stop(file).latched);
    again.steers.plays();
    EXPECT_TRUE(again.tick({}, 1).stopped);
    keeper.set(false);
    ASSERT_TRUE(keeper.flush().ok());
    EXPECT_FALSE(load_stop(file).latched);
    for (const char* garbled : {"", "surefoot emergency stop: cl", "surefoot emergency stop: clear\nx"}) {
        std::ofstream(file) << garbled;
        EXPECT_TRUE(load_stop(file).latched) << garbled;
        EXPECT_FALSE(load_stop(file).note.empty());
    }
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    EXPECT_TRUE(load_stop(file).latched) << "unreadable";
    std::filesystem::remove(file);
    StopKeeper lost("/nowhere/stop", false);
    lost.set(true);
    EXPECT_FALSE(lost.flush().ok());
    EXPECT_FALSE(lost.flush().ok()) << "tried again";
}

TEST(DeadManSwitch, StopsAtTheFirstReleaseAndCountsAPressAfterTwentyMilliseconds) {
    Random random(8);
    Walk walk;
    walk.lines.has_dead_man = true;
    const int device = walk.plug();
    walk.hold(device, 128, 128, 10);
    EXPECT_TRUE(walk.last.stopped);
    for (int round = 0; round < 50; ++round) {
        // Bounces of the press: 1 to 20 edges of 0.2 to 5 ms.
        for (int edge = 0, edges = 1 + static_cast<int>(random.below(20)); edge < edges; ++edge) {
            walk.lines.dead_man = edge % 2 == 0;
            const int pieces = 1 + static_cast<int>(random.below(25));
            for (int k = 0; k < pieces; ++k) {
                walk.send(device, 128, 0);
                walk.tick(200'000);
                ASSERT_TRUE(walk.last.stopped) << "while it bounces";
            }
        }
        walk.lines.dead_man = false;
        walk.tick();
        walk.lines.dead_man = true;
        walk.hold(device, 128, 0, 20);
        ASSERT_TRUE(walk.last.stopped);
        walk.hold(device, 128, 0, 300);
        ASSERT_FALSE(walk.last.stopped);
        ASSERT_GT(walk.speed(), 1.0);
        walk.lines.dead_man = false;
        walk.hold(device, 128, 0, 1);
        ASSERT_EQ(walk.speed(), 0) << "in the very tick";
    }
}

TEST(DeadManSwitch, MustBePressedAnewWhenHeldLongWithoutAWalk) {
    Walk walk;
    walk.lines.has_dead_man = walk.lines.dead_man = true;
    const int device = walk.plug();
    walk.hold(device, 128, 128, 29'000);
    EXPECT_FALSE(walk.last.stopped);
    walk.hold(device, 128, 0, 100);
    walk.hold(device, 128, 128, 29'000);
    EXPECT_FALSE(walk.last.stopped) << "a walk begins the time anew";
    walk.hold(device, 128, 128, 1'100);
    EXPECT_TRUE(walk.last.stopped);
    EXPECT_TRUE(walk.safety().wants_press);
    walk.hold(device, 128, 0, 500);
    EXPECT_TRUE(walk.last.stopped) << "walking does not wake it";
    walk.lines.dead_man = false;
    walk.hold(device, 128, 128, 1);
    walk.lines.dead_man = true;
    walk.hold(device, 128, 128, 25);
    EXPECT_FALSE(walk.last.stopped);
}

TEST(DeadManSwitch, OnAPulledDeviceIsNotHeld) {
    DeviceMapping m = test::stick_mapping();
    m.buttons = {{{"button-1", 0, 0, ""}, Action::dead_man, 1, 0, 0, false}};
    Walk walk;
    const int device = walk.plug(m);
    test::set(walk.state, 2, 0);
    walk.hold(device, 128, 128, 5);
    test::set(walk.state, 2, 1);
    walk.hold(device, 128, 0, 300);
    EXPECT_GT(walk.speed(), 1.0);
    walk.detach(device);
    walk.tick();
    EXPECT_TRUE(walk.last.stopped);
    EXPECT_EQ(walk.speed(), 0);
}

TEST(Edges, NoneLostAndNoneTwice) {
    DeviceMapping m = test::stick_mapping();
    m.buttons = {{{"button-1", 0, 0, ""}, Action::next_viewpoint, 1, 0, 0, false}};
    Walk walk;
    const int device = walk.plug(m);
    test::set(walk.state, 2, 0);
    walk.hold(device, 128, 128, 5);
    Random random(10);
    for (int i = 0; i < 10'000; ++i) {
        test::set(walk.state, 2, 1);
        walk.send(device, 128, 128);
        if (random.below(2) == 0) walk.tick();
        test::set(walk.state, 2, 0);
        walk.send(device, 128, 128);
        walk.tick();
    }
    EXPECT_EQ(walk.last.presses.next_viewpoint, 10'000U);
}

}  // namespace
}  // namespace surefoot::input
