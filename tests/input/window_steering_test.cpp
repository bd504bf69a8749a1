// A window's keyboard and mouse through the whole steering, in virtual time: they walk, turn exactly as far as the pointer moved,
// stop, and need no memory.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "input/devices/no_devices.hpp"
#include "input/live_source.hpp"
#include "input/map/steering_file.hpp"
#include "input/window/window_keys.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/guard.hpp"

namespace surefoot::input {
namespace {

constexpr std::int64_t window_tick_ns = 2'000'000;

/// The input thread's loop, with a window alone.
struct WindowRig {
    explicit WindowRig(const std::string& steering_toml = "", const MotionLimits& limits = {})
        : steering(limits, SafetyLimits{}) {
        LiveOptions options;
        if (!steering_toml.empty()) {
            auto file = parse_steering(steering_toml, "test.toml");
            EXPECT_TRUE(file.ok()) << (file.ok() ? "" : file.error().text());
            if (file.ok()) options.mappings = file->devices;
        }
        options.window = feed;
        options.stamps = 1000;
        options.devices = false;
        source = std::make_unique<LiveSource>(std::move(options), std::make_unique<NoDevices>());
        steering.steers.plays();
        source->begin(steering, now_ns);
    }
    void push(std::initializer_list<std::uint32_t> symbols, std::int32_t dx = 0, std::int32_t dy = 0) {
        WindowReport report;
        for (const std::uint32_t s : symbols) report.keys |= std::uint64_t{1} << static_cast<unsigned>(window_key_of(s));
        report.dx = dx;
        report.dy = dy;
        report.stamp_ns = now_ns;
        feed->push(report);
    }
    const NavigationSample& run(int ticks) {
        const std::uint64_t before = rt::guard_counters().own_violations;
        for (int i = 0; i < ticks; ++i) {
            now_ns += window_tick_ns;
            const rt::OwnScope own;
            steering.steers.plays();
            const Lines lines = source->drain(steering, now_ns);
            sample = steering.tick(lines, now_ns);
            presses += sample.next_viewpoint ? 1 : 0;
        }
        violations += rt::guard_counters().own_violations - before;
        return sample;
    }
    [[nodiscard]] double yaw_deg() {
        steering.steers.plays();
        return steering.motion().yaw.value * 180 / std::numbers::pi;
    }
    [[nodiscard]] double pitch_deg() {
        steering.steers.plays();
        return steering.motion().pitch.value * 180 / std::numbers::pi;
    }

    std::shared_ptr<WindowFeed> feed = std::make_shared<WindowFeed>();
    Steering steering;
    std::unique_ptr<LiveSource> source;
    NavigationSample sample;
    std::int64_t now_ns = 1'000'000'000;
    std::uint64_t violations = 0;
    int presses = 0;
};

TEST(WindowSteering, KeysWalkRunAndRest) {
    WindowRig rig;
    rig.run(5);
    rig.push({'w'});
    rig.run(300);
    EXPECT_NEAR(rig.sample.velocity_m_s.z, -1.4, 0.02);
    const double walked = rig.sample.velocity_m_s.z;
    rig.push({'w', 0xffe1});
    rig.run(300);
    EXPECT_LT(rig.sample.velocity_m_s.z, 2 * walked) << "Shift runs";
    rig.push({'d'});
    rig.run(300);
    EXPECT_NEAR(rig.sample.velocity_m_s.x, 1.4, 0.02);
    rig.push({0xff51});  // the left arrow
    rig.run(300);
    EXPECT_NEAR(rig.sample.velocity_m_s.x, -1.4, 0.02);
    rig.push({'e'});
    rig.run(300);
    EXPECT_NEAR(rig.sample.velocity_m_s.y, 1.4, 0.02) << "who flies, flies up";
    rig.push({});
    rig.run(300);
    EXPECT_EQ(rig.sample.velocity_m_s, dvec3(0.0));
    EXPECT_EQ(rig.violations, 0U);
    if (!rt::guard_active()) std::printf("allocations are not counted in this build\n");
    EXPECT_EQ(rig.source->log().count(), 6U);
}

TEST(WindowSteering, TwoKeysZoomInAndBack) {
    WindowRig rig;
    rig.run(5);
    const double usual = rig.sample.pose.fov_y_rad;
    rig.push({'z'});
    rig.run(500);
    EXPECT_NEAR(rig.sample.zoom_rate, std::numbers::ln2, 1e-9);
    EXPECT_LT(rig.sample.pose.fov_y_rad, 0.6 * usual);
    rig.push({'x'});
    rig.run(1000);
    EXPECT_EQ(rig.sample.pose.fov_y_rad, usual);
    EXPECT_EQ(rig.violations, 0U);
}

TEST(WindowSteering, ATapOfAKeyBetweenTwoStepsCounts) {
    WindowRig rig;
    rig.run(5);
    rig.push({'n'});
    rig.push({});
    rig.run(5);
    EXPECT_EQ(rig.presses, 1);
    rig.push({'n'});
    rig.run(50);
    EXPECT_EQ(rig.presses, 2) << "held, it is one press";
}

TEST(WindowSteering, LSwitchesTheSunlightOnceAPress) {
    WindowRig rig;
    rig.run(5);
    rig.push({'l'});
    rig.push({});
    rig.run(5);
    EXPECT_EQ(rig.sample.presses.light.sunlight, 1U) << "a tap between two steps";
    rig.push({'l'});
    rig.run(50);
    EXPECT_EQ(rig.sample.presses.light.sunlight, 2U) << "held, it is one press";
    EXPECT_EQ(rig.sample.presses.pause, 0U);
    WindowRig mapped("[[device]]\nproduct_name = \"window\"\n[[device.button]]\ncontrol = \"key-p\"\naction = \"sunlight\"\n");
    mapped.run(5);
    mapped.push({'p'});
    mapped.run(5);
    EXPECT_EQ(mapped.sample.presses.light.sunlight, 1U) << "a steering file may put it elsewhere";
}

TEST(WindowSteering, EachKeyOfTheLightSwitchesItsPartAlone) {
    for (const auto& [key, name] : {std::pair{'l', "sunlight"}, {'j', "shadows"}, {'k', "lamps"}, {'h', "fog"}}) {
        for (const bool mapped : {false, true}) {
            WindowRig rig(mapped ? "[[device]]\nproduct_name = \"window\"\n[[device.button]]\ncontrol = \"key-p\"\naction = \"" +
                                       std::string(name) + "\"\n"
                                 : "");
            rig.run(5);
            rig.push({mapped ? static_cast<std::uint32_t>('p') : static_cast<std::uint32_t>(key)});
            rig.push({});
            rig.run(50);
            for (const rt::Switch& one : rt::light_switches)
                EXPECT_EQ(rig.sample.presses.light.*one.presses, one.name == name ? 1U : 0U) << one.name << " by " << name;
            EXPECT_EQ(rig.sample.presses.pause, 0U);
            EXPECT_EQ(rig.violations, 0U);
        }
    }
}

TEST(WindowSteering, ThePointerTurnsExactlyAsFarAsItMoved) {
    for (const int pixels : {1, 7, 50, 100}) {
        WindowRig rig;
        const int upwards = pixels / 10;
        rig.run(5);
        for (int i = 0; i < 10; ++i) {
            rig.push({}, pixels - 1, -upwards);
            rig.push({}, 1);  // two of them in one step
            rig.run(8);
        }
        rig.run(1500);
        EXPECT_NEAR(rig.yaw_deg(), -0.15 * 10 * pixels, 1e-6) << "to the right by " << pixels;
        EXPECT_NEAR(rig.pitch_deg(), 0.15 * 10 * upwards, 1e-6) << "upwards";
        EXPECT_FALSE(rig.sample.pointed);
        EXPECT_EQ(rig.sample.angular_rad_s, dvec3(0.0));
    }
}

TEST(WindowSteering, AHandFasterThanAnyTurnIsNotFollowedForLong) {
    WindowRig rig;
    rig.run(5);
    for (int i = 0; i < 100; ++i) {
        rig.push({}, 900, -900);
        rig.run(2);
    }
    rig.run(400);
    EXPECT_EQ(rig.sample.angular_rad_s, dvec3(0.0)) << "0.8 s later";
    EXPECT_LT(rig.pitch_deg(), 85);
    EXPECT_GT(rig.pitch_deg(), 83);
}

TEST(WindowSteering, ASmallTurnIsDoneInATenthOfASecond) {
    WindowRig rig;
    rig.run(5);
    rig.push({}, 20);  // three degrees
    rig.run(50);
    EXPECT_LT(rig.yaw_deg(), -2.7);
}

TEST(WindowSteering, NoTurnByThePointerLeavesItsUncertainty) {
    WindowRig rig;
    rig.run(5);
    std::vector<std::pair<std::int64_t, Prediction>> open;
    double used = 0;
    for (int i = 0; i < 3000; ++i) {
        if (i % 5 == 0) rig.push({}, static_cast<std::int32_t>(60 * std::sin(i * 0.01)), i % 40 - 20);
        rig.run(1);
        if (i > 200 && i % 7 == 0) open.emplace_back(rig.now_ns + 50'000'000, predict(rig.sample, MotionLimits{}, 0.05));
        while (!open.empty() && open.front().first <= rig.now_ns) {
            const Prediction& ahead = open.front().second;
            const double w = std::abs(glm::dot(ahead.pose.orientation, rig.sample.pose.orientation));
            const double off = 2 * std::acos(std::min(1.0, w));
            ASSERT_LE(off, ahead.uncertainty_rad + 1e-6) << i;
            used = std::max(used, off / ahead.uncertainty_rad);
            open.erase(open.begin());
        }
    }
    EXPECT_GT(used, 0.05) << "else it says nothing";
}

TEST(WindowSteering, AStopOnAKeyLatchesAndEndsTheTurn) {
    WindowRig rig(R"(
[[device]]
product_name = "window"
[[device.button]]
control = "key-w"
action = "forward"
[[device.button]]
control = "key-space"
action = "stop"
[[device.button]]
control = "key-r"
action = "stop_reset"
[[device.axis]]
control = "pointer-x"
action = "turn"
deg_per_count = 1
)");
    rig.run(5);
    rig.push({'w'}, 5);
    rig.run(200);
    EXPECT_LT(rig.sample.velocity_m_s.z, -1);
    EXPECT_NEAR(rig.yaw_deg(), 5, 1e-6) << "this file does not invert";
    rig.push({'w'}, 40);
    rig.run(5);
    rig.push({'w', ' '}, 50);
    rig.run(1);
    const double stopped_at = rig.yaw_deg();
    EXPECT_LT(stopped_at, 40) << "the turn has not ended";
    EXPECT_TRUE(rig.sample.stopped);
    EXPECT_EQ(rig.sample.velocity_m_s, dvec3(0.0));
    rig.push({'w'}, 50);
    rig.run(200);
    EXPECT_TRUE(rig.sample.stopped) << "it latches";
    EXPECT_EQ(rig.yaw_deg(), stopped_at);
    rig.push({'w', 'r'});
    rig.run(200);
    EXPECT_FALSE(rig.sample.stopped);
    EXPECT_EQ(rig.sample.velocity_m_s, dvec3(0.0)) << "nobody walks off by a key still held";
    EXPECT_EQ(rig.yaw_deg(), stopped_at) << "what was left of the turn is gone";
    rig.push({});
    rig.run(5);
    rig.push({'w'});
    rig.run(200);
    EXPECT_LT(rig.sample.velocity_m_s.z, -1);
}

TEST(WindowSteering, TheKeysThatStopAreKnown) {
    const auto file = parse_steering(
        "[[device]]\nproduct_name = \"window\"\n"
        "[[device.button]]\ncontrol = \"key-w\"\naction = \"forward\"\n"
        "[[device.button]]\ncontrol = \"key-space\"\naction = \"stop\"\n"
        "[[device.button]]\ncontrol = \"0x07:0x28\"\naction = \"stop\"\n",
        "test.toml");
    ASSERT_TRUE(file.ok()) << file.error().text();
    const auto bit = [](std::uint32_t symbol) { return std::uint64_t{1} << static_cast<unsigned>(window_key_of(symbol)); };
    EXPECT_EQ(stop_keys(window_mapping(file->devices, 0.15)), bit(' ') | bit(0xff0d)) << "the second by its usage";
    EXPECT_EQ(stop_keys(window_mapping({}, 0.15)), 0U) << "by default none does";
}

TEST(WindowSteering, AMappingForEveryDeviceIsNotTheWindows) {
    WindowRig rig("[[device]]\nname = \"any\"\n[[device.axis]]\ncontrol = \"x\"\naction = \"turn\"\n");
    ASSERT_EQ(rig.source->devices().size(), 1U);
    EXPECT_EQ(rig.source->devices()[0].mapping, "default: keyboard and mouse");
}

TEST(WindowSteering, AReportWakesTheInputThread) {
    WindowRig rig;
    rt::RealClock clock;
    const std::int64_t begun_ns = clock.now_ns();
    std::thread hand([&] { rig.push({'w'}); });
    rig.source->wait(clock, begun_ns + 2'000'000'000);
    hand.join();
    EXPECT_LT(clock.now_ns() - begun_ns, 1'000'000'000);
}

TEST(WindowSteering, AnAngleNeedsATurn) {
    const auto refused = parse_steering(
        "[[device]]\nproduct_name = \"window\"\n[[device.axis]]\ncontrol = \"pointer-x\"\naction = \"forward\"\ndeg_per_count = "
        "1\n",
        "test.toml");
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().text().find("deg_per_count"), std::string::npos) << refused.error().text();
}

}  // namespace
}  // namespace surefoot::input
