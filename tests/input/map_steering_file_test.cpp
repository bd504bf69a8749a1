// The steering file: every slip is named with line, key and remedy; what is written reads back the same.
#include "input/map/steering_file.hpp"

#include <gtest/gtest.h>

#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

constexpr std::string_view example = R"(# The lobby's stick, a stop and a dead-man
[motion]
walk_m_s = 1.2

[safety]
dead_man_idle_s = 20

[[device]]
name = "lobby stick"
vendor = 0x044f
product = 0xb10a

[[device.stick]]
controls = ["x", "y"]
actions = ["side", "forward"]
invert = [false, true]
dead_zone = 0.12
curve = "power"
strength = 1.5

[[device.axis]]
control = "0x01:0x35"
collection = "Joystick"
action = "turn"
smoothing_ms = 30

[[device.hat]]
control = "hat"
actions = ["none", "look"]

[[device.button]]
control = "button-1"
action = "next_viewpoint"

[[gpio]]
name = "stop"
chip = "gpiochip0"
line = "ESTOP"
role = "stop"
bias = "pull_up"
)";

void refused(std::string_view text, int line, std::string_view what, std::string_view remedy = {}) {
    const auto parsed = parse_steering(text, "s.toml");
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.error().place, "s.toml:" + std::to_string(line)) << parsed.error().text();
    EXPECT_NE(parsed.error().what.find(what), std::string::npos) << parsed.error().text();
    EXPECT_NE(parsed.error().remedy.find(remedy), std::string::npos) << parsed.error().text();
}

TEST(SteeringFile, ReadsWhatTheReadmeShows) {
    const auto parsed = parse_steering(example, "s.toml");
    ASSERT_TRUE(parsed.ok()) << parsed.error().text();
    EXPECT_EQ(parsed->motion.walk_m_s, 1.2);
    EXPECT_EQ(parsed->safety.dead_man.idle_limit_ns, 20'000'000'000);
    ASSERT_EQ(parsed->devices.size(), 1U);
    const DeviceMapping& d = parsed->devices[0];
    EXPECT_EQ(d.match.vendor, 0x044f);
    EXPECT_EQ(d.sticks[0].shape.dead_zone, 0.12);
    EXPECT_TRUE(d.sticks[0].invert[1]);
    EXPECT_EQ(d.axes[0].control.usage, 0x35);
    EXPECT_NEAR(d.axes[0].shape.smoothing_s, 0.03, 1e-12);
    EXPECT_EQ(d.buttons[0].action, Action::next_viewpoint);
    EXPECT_TRUE(parsed->lines[0].normally_closed);
    EXPECT_NE(find_mapping(parsed->devices, {0x044f, 0xb10a, "T.16000M", DeviceClass::navigation}), nullptr);
    EXPECT_EQ(find_mapping(parsed->devices, {0x046d, 0xb10a, "", DeviceClass::navigation}), nullptr);
}

TEST(SteeringFile, WritesWhatItReads) {
    const auto once = parse_steering(example, "s.toml");
    ASSERT_TRUE(once.ok());
    const std::string written = steering_text(*once);
    const auto twice = parse_steering(written, "written");
    ASSERT_TRUE(twice.ok()) << twice.error().text() << "\n" << written;
    EXPECT_EQ(steering_text(*twice), written);
    EXPECT_EQ(twice->devices[0].sticks[0].shape.strength, 1.5);
    DeviceMapping odd;
    odd.name = "quotes \" and \\ and\nlines\tand ü";
    const auto read = parse_steering(device_text(odd), "odd");
    ASSERT_TRUE(read.ok()) << read.error().text() << device_text(odd);
    EXPECT_EQ(read->devices[0].name, odd.name);
}

TEST(SteeringFile, ZoomIsReadAndWritten) {
    const std::string text =
        "[motion]\nmax_zoom = 4.0\nzoom_per_s = 3.0\n\n[[device]]\nname = \"box\"\n\n[[device.button]]\ncontrol = \"button-1\"\n"
        "action = \"zoom\"\nscale = -1\n";
    const auto parsed = parse_steering(text, "s.toml");
    ASSERT_TRUE(parsed.ok()) << parsed.error().text();
    EXPECT_EQ(parsed->motion.max_zoom, 4);
    EXPECT_EQ(parsed->motion.zoom_per_s, 3);
    EXPECT_EQ(parsed->devices[0].buttons[0].action, Action::zoom);
    const auto again = parse_steering(steering_text(*parsed), "t.toml");
    ASSERT_TRUE(again.ok()) << again.error().text();
    EXPECT_EQ(again->motion.max_zoom, 4);
    EXPECT_EQ(again->motion.zoom_per_s, 3);
    EXPECT_EQ(again->devices[0].buttons[0].action, Action::zoom);
}

TEST(SteeringFile, DefaultsOfEveryClassSurviveTheFile) {
    const auto m = default_mapping(test::stick_controls(), DeviceClass::navigation);
    SteeringFile file;
    file.devices = {m};
    const auto read = parse_steering(steering_text(file), "d");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(device_text(read->devices[0]), device_text(m));
    EXPECT_TRUE(compile(read->devices[0], test::stick_controls()).ok());
}

TEST(SteeringFile, SlipsAreNamedWithLineKeyAndRemedy) {
    refused("[motoin]\n", 1, "The key 'motoin' is unknown", "'motion'");
    refused("[motion]\nwalk = 1\n", 2, "The key 'motion.walk' is unknown", "'walk_m_s'");
    refused("[motion]\nwalk_m_s = -1\n", 2, "motion.walk_m_s = -1 is not allowed", "a number from 0.01 to 100 (m/s)");
    refused("[motion]\nmax_zoom = 0.5\n", 2, "motion.max_zoom = 0.5 is not allowed", "a number from 1 to 50 (factor)");
    refused("[motion]\nwalk_m_s = nan\n", 2, "motion.walk_m_s");
    refused("[motion]\nwalk_m_s = \"fast\"\n", 2, "motion.walk_m_s");
    refused("device = 3\n", 1, "device = 3 is not allowed", "Use a list of tables. Write [[device]]");
    refused("[[device]]\n[[device.axis]]\naction = \"turn\"\n", 2, "device.axis.control is missing");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\n", 2, "device.axis.action is missing");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\naction = \"tunr\"\n", 4, "tunr", "Did you mean \"turn\"?");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\naction = \"reset\"\n", 4, "no action for an axis", "forward");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\naction = \"turn\"\ndeadzone = 0.1\n", 5,
            "The key 'device.axis.deadzone' is unknown", "'dead_zone'");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\naction = \"turn\"\ndead_zone = 0.01\n", 5,
            "narrower than the hysteresis");
    refused("[[device]]\n[[device.axis]]\ncontrol = \"x\"\naction = \"turn\"\nsaturation = 0.12\n", 5, "leaves nothing");
    refused("[[device]]\n[[device.stick]]\ncontrols = [\"x\"]\nactions = [\"side\", \"up\"]\n", 3, "is not allowed",
            "an array of two texts");
    refused("[[device]]\n[[device.stick]]\ncontrols = [\"x\", \"y\"]\nactions = [\"side\", \"stop\"]\n", 4, "stop");
    refused("[[device]]\nvendor = 70000\n", 2, "70000 is not allowed", "a whole number from 0 to 65535");
    refused("[[device]]\nclass = \"joystick\"\n", 2, "joystick", "\"navigation\"");
    refused("[[gpio]]\nname = \"s\"\nchip = \"c\"\nline = \"l\"\nrole = \"stop\"\nnormally_closed = false\n", 6,
            "not allowed for a stop", "normally closed");
    refused("[[gpio]]\nname = \"s\"\nchip = \"c\"\n", 1, "gpio.line is missing");
    refused("x = \n", 1, "");
    refused("a = 1\n[motion]\n", 1, "The key 'a' is unknown", "\"motion\"");
    const auto twice = parse_steering("[[gpio]]\nname=\"e\"\nchip=\"c\"\nline=\"1\"\nrole=\"encoder_a\"\n", "s.toml");
    ASSERT_FALSE(twice.ok());
    EXPECT_NE(twice.error().text().find("one encoder_a and one encoder_b"), std::string::npos) << twice.error().text();
    EXPECT_FALSE(read_steering("/nowhere/steering.toml").ok());
}

}  // namespace
}  // namespace surefoot::input
