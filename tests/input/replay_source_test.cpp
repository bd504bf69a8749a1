// A recording as a source: every report once and in its time, whatever its times are; rest when it has ended.
#include <gtest/gtest.h>

#include "input/replay/replay_source.hpp"
#include "input/steering.hpp"
#include "rt/base/file.hpp"
#include "tests/input/gamepad_session.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/time_units.hpp"

namespace surefoot::input {
namespace {

using test::GamepadSession;

RecordedDevice device_of(const GamepadSession& session) {
    const surefoot::test::TemporaryFolder folder;
    const std::string file = folder / "session.hid";
    EXPECT_TRUE(write_text(file, session.text()).ok());
    auto opened = open_recorded(file, {}, "");
    EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().text());
    return opened.ok() ? std::move(*opened) : RecordedDevice{};
}

/// Steps every millisecond until `until_ns`.
NavigationSample run(ReplaySource& source, Steering& steering, std::int64_t& now_ns, std::int64_t until_ns) {
    steering.steers.plays();
    NavigationSample last;
    for (; now_ns <= until_ns; now_ns += ms) last = steering.tick(source.drain(steering, now_ns), now_ns);
    return last;
}

TEST(ReplaySource, ReportsComeWhenTheirTimeHasComeStampedWithIt) {
    GamepadSession session;
    session.report({}, 5'000'000).report({}, 3000).report({}, 4500);  // the first one's time is the start
    ReplaySource source(device_of(session));
    Steering steering({}, {});
    steering.steers.plays();
    source.begin(steering, 100 * ms);
    EXPECT_EQ(source.next_ns(), 100 * ms);
    source.drain(steering, 99 * ms);
    EXPECT_EQ(source.log().count(), 0U);
    source.drain(steering, 100 * ms);
    EXPECT_EQ(source.log().count(), 1U);
    EXPECT_EQ(source.next_ns(), 103 * ms);
    rt::VirtualClock clock(100 * ms);
    source.wait(clock, 102 * ms);
    EXPECT_EQ(clock.now_ns(), 102 * ms);
    source.wait(clock, 200 * ms);
    EXPECT_EQ(clock.now_ns(), 103 * ms);
    source.drain(steering, 500 * ms);  // late: the stamps say by how much
    EXPECT_EQ(source.next_ns(), never_ns);
    const auto stamps = source.log().stamps();
    EXPECT_EQ(std::vector<std::int64_t>(stamps.begin(), stamps.end()),
              (std::vector<std::int64_t>{100 * ms, 103 * ms, 107 * ms + ms / 2}));
}

TEST(ReplaySource, TimesThatGoBackAndReportsThatDoNotFitLoseNothing) {
    GamepadSession session;
    session.report({}).report({}, 10'000).report({}, -8'000).report({}, 20'000);
    session.recording().add(15'000, std::vector<std::byte>(2));  // short, and earlier than the last
    ReplaySource source(device_of(session));
    Steering steering({}, {});
    steering.steers.plays();
    source.begin(steering, ms);
    std::int64_t now = ms;
    run(source, steering, now, 100 * ms);
    EXPECT_EQ(source.log().count(), 4U);
    EXPECT_EQ(source.refused(), 1U);
    EXPECT_TRUE(std::is_sorted(source.log().stamps().begin(), source.log().stamps().end()));
}

TEST(ReplaySource, AHandThatIsHeldWhenTheRecordingEndsComesToRestThoughItsPadReportsChangesOnly) {
    GamepadSession session;
    session.report({}).report({}, 20'000).report({.forward = 1}, 20'000).report({.side = 0.1, .forward = 1}, 900'000);
    ReplaySource source(device_of(session));
    Steering steering({}, {});
    steering.steers.plays();
    source.begin(steering, ms);
    std::int64_t now = ms;
    EXPECT_GT(glm::length(run(source, steering, now, 800 * ms).velocity_m_s), 1.0) << "held, and silent for long: it walks";
    EXPECT_GT(glm::length(run(source, steering, now, 1000 * ms).velocity_m_s), 1.0);
    EXPECT_EQ(glm::length(run(source, steering, now, 1200 * ms).velocity_m_s), 0.0);
    EXPECT_EQ(steering.safety().timeouts, 1U);
    EXPECT_EQ(steering.safety().losses, 0U) << "an end is no pulled cable";
}

TEST(ReplaySource, ADeviceOfARejectedClassSteersWhereTheConfigurationNamesIt) {
    const std::string keyboard = std::string(SUREFOOT_SOURCE_DIR) + "/tests/input/devices/boot-keyboard.hid";
    const auto refused = open_recorded(keyboard, {}, "");
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().text().find("does not steer"), std::string::npos) << refused.error().text();
    auto described = read_recording(keyboard);
    ASSERT_TRUE(described.ok());
    Layout layout;
    ASSERT_FALSE(parse_descriptor(described->descriptor, layout));
    const HidDevice device = describe_device(std::move(layout), {described->vendor, described->product, described->name});
    ASSERT_FALSE(device.controls.empty());
    auto steering = parse_steering(
        "[[device]]\nname = \"keys\"\n[[device.button]]\ncontrol = \"" + device.controls[0].name + "\"\naction = \"forward\"\n",
        "keys.toml");
    ASSERT_TRUE(steering.ok()) << steering.error().text();
    const auto opened = open_recorded(keyboard, *steering, "keys.toml");
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    EXPECT_EQ(opened->mapping, "keys");
}

}  // namespace
}  // namespace surefoot::input
