// surefoot devices list, watch, record and map, the tool itself, on synthetic devices behind the real hidapi and libudev.
#include <fmt/format.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "input/map/steering_file.hpp"
#include "tests/input/testbed/testbed.hpp"
#include "tests/input/testbed/tool.hpp"

namespace surefoot::input {
namespace {

using nlohmann::json;
using test::Testbed;
using test::Tool;
using test::Wire;

std::string temporary(const std::string& name) { return fmt::format("{}/{}-{}", testing::TempDir(), getpid(), name); }

TEST(DevicesTool, ListsWhatIsThereOncePerDevice) {
    Testbed bed;
    bed.plug(recorded("spacenavigator-like"));
    bed.plug(recorded("nested-applications"), {.node = "hidraw1", .socket = "b"});
    bed.plug(recorded("boot-mouse"), {.node = "hidraw2", .socket = "c"});
    auto broken = recorded("dualshock4-like");
    broken.descriptor.resize(20);
    bed.plug(broken, {.node = "hidraw3", .socket = "d"});
    for (const auto& arguments : std::vector<std::vector<std::string>>{{"list", "--json"}, {"--json"}}) {
        Tool tool(arguments);
        ASSERT_EQ(tool.wait(), 0) << tool.err();
        const json list = json::parse(tool.out())["devices"];
        ASSERT_EQ(list.size(), 4U);
        EXPECT_EQ(list[0]["vid_pid"], "046d:c626");
        EXPECT_EQ(list[0]["class"], "navigation");
        EXPECT_EQ(list[0]["mapping"], "default: six axes");
        EXPECT_EQ(list[0]["steers"], true);
        EXPECT_EQ(list[0]["permitted"], true);
        EXPECT_EQ(list[2]["steers"], false);
        EXPECT_NE(list[3]["reason"].get<std::string>().find("byte"), std::string::npos);
    }
    Tool plain({});
    ASSERT_EQ(plain.wait(), 0);
    EXPECT_NE(plain.out().find("/dev/hidraw0"), std::string::npos);
    EXPECT_NE(plain.out().find("3Dconnexion SpaceNavigator"), std::string::npos);
}

TEST(DevicesTool, ReportsThatNothingIsThere) {
    Testbed bed;
    Tool list({"list"});
    EXPECT_EQ(list.wait(), 0);
    EXPECT_NE(list.out().find("No HID device"), std::string::npos);
    Tool record({"record", "hidraw0", "-o", temporary("none.hid")});
    EXPECT_EQ(record.wait(), 1);
    EXPECT_NE(record.err().find("No such device"), std::string::npos) << record.err();
    EXPECT_FALSE(std::filesystem::exists(temporary("none.hid")));
    Tool wrong({"record", "hidraw0"});
    EXPECT_EQ(wrong.wait(), 2);
}

class Record : public ::testing::TestWithParam<const char*> {};

TEST_P(Record, EndsWithAValidFileHoweverItEnds) {
    Testbed bed;
    const auto r = recorded("spacenavigator-like");
    auto plug = bed.plug(r, {.wire = Wire::terminal});
    const std::string file = temporary("record.hid"), how = GetParam();
    std::filesystem::remove(file);
    std::vector<std::string> arguments = {"record", "046d:c626", "-o", file, "--json"};
    if (how == "time") arguments.insert(arguments.end(), {"--seconds", "3"});
    Tool tool(arguments);
    ASSERT_TRUE(tool.until("The reports of /dev/hidraw0 (3Dconnexion SpaceNavigator) are recorded to " + file)) << tool.err();
    for (std::size_t i = 0; i < r.reports.size(); ++i) {
        ASSERT_TRUE(Testbed::send(plug, r.report(i)));
        usleep(30'000);  // a device's pace
        ASSERT_TRUE(Testbed::taken(plug, 5000));
    }
    EXPECT_FALSE(std::filesystem::exists(file)) << "it shows before it is whole";
    if (how == "stopped") tool.signal(SIGINT);
    if (how == "unplugged") bed.pull(plug);
    ASSERT_EQ(tool.wait(), 0) << tool.err();
    EXPECT_EQ(json::parse(tool.out())["ended"], how);
    const auto read = read_recording(file);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->descriptor, r.descriptor);
    EXPECT_EQ(read->name, r.name);
    EXPECT_EQ(read->vendor, r.vendor);
    EXPECT_EQ(read->bytes, r.bytes);
    EXPECT_EQ(read->reports.size(), r.reports.size());
    std::filesystem::remove(file);
}
INSTANTIATE_TEST_SUITE_P(Ends, Record, ::testing::Values("time", "stopped", "unplugged"),
                         [](const auto& i) { return std::string(i.param); });

TEST(DevicesTool, WatchDrawsBarsAndPutsTheCursorBack) {
    Testbed bed;
    auto plug = bed.plug(recorded("dualshock4-like"));
    Tool tool({"watch"}, true);
    ASSERT_TRUE(tool.until("x      ")) << tool.out();
    EXPECT_NE(tool.out().find("\033[?25l"), std::string::npos);
    const auto r = recorded("dualshock4-like");
    ASSERT_TRUE(Testbed::send(plug, r.report(1)));
    EXPECT_TRUE(tool.until("1 reports")) << tool.out();
    EXPECT_TRUE(tool.until("button-")) << tool.out();
    tool.signal(SIGINT);
    EXPECT_EQ(tool.wait(), 0);
    EXPECT_TRUE(tool.out().ends_with("\033[?25h")) << "the cursor stays hidden";
}

TEST(DevicesTool, WatchPrintsLinesElsewhere) {
    Testbed bed;
    const auto r = recorded("spacenavigator-like");
    auto plug = bed.plug(r);
    Tool lines({"watch", "--seconds", "1.5"}), objects({"watch", "--seconds", "1.5", "--json"});
    ASSERT_TRUE(lines.until("plugged in"));
    ASSERT_TRUE(Testbed::send(plug, r.report(0)));
    EXPECT_EQ(lines.wait(), 0);
    EXPECT_EQ(objects.wait(), 0);
    EXPECT_EQ(lines.out().find('\033'), std::string::npos) << "escape sequences in a pipe";
    std::istringstream all(objects.out());
    std::size_t n = 0;
    for (std::string line; std::getline(all, line); ++n) EXPECT_TRUE(json::parse(line).contains("event"));
    EXPECT_GE(n, 1U);
}

TEST(DevicesTool, MapPromptsAndWritesASteeringFile) {
    Testbed bed;
    const auto r = recorded("spacenavigator-like");
    auto plug = bed.plug(r);
    const std::string file = temporary("steering.toml");
    {
        std::ofstream out(file);
        out << "[motion]\nwalk_m_s = 2.5\n";
    }
    Tool tool({"map", "-o", file, "--json"});
    ASSERT_TRUE(tool.until("walks forward")) << tool.err();
    const auto send = [&](const char* text) {
        ASSERT_TRUE(Testbed::send(plug, hex(text)));
        usleep(30'000);  // a hand's pace
    };
    send("01 00 00 00 00 00 00");
    send("01 00 00 a2 fe 00 00");  // the cap is pushed away: y = -350
    send("01 00 00 00 00 00 00");
    ASSERT_TRUE(tool.until("walks to the right")) << tool.err();
    tool.key("\n");  // not this one
    ASSERT_TRUE(tool.until("rises")) << tool.err();
    for (const char* question : {"turns to the left", "looks up", "faster", "next viewpoint"}) {
        tool.key("\n");
        ASSERT_TRUE(tool.until(question)) << tool.err();
    }
    send("03 01 00");
    send("03 00 00");
    ASSERT_TRUE(tool.until("back to the start")) << tool.err();
    for (const char* question : {"tour", "pauses"}) {
        tool.key("\n");
        ASSERT_TRUE(tool.until(question)) << tool.err();
    }
    tool.key("\n");
    ASSERT_EQ(tool.wait(), 0) << tool.err();
    const auto steering = read_steering(file);
    ASSERT_TRUE(steering.ok()) << steering.error().text();
    EXPECT_EQ(steering->motion.walk_m_s, 2.5) << "what was in the file is lost";
    ASSERT_EQ(steering->devices.size(), 1U);
    const DeviceMapping& m = steering->devices.front();
    ASSERT_EQ(m.axes.size(), 1U);
    EXPECT_EQ(m.axes[0].action, Action::forward);
    EXPECT_EQ(m.axes[0].control.name, "y");
    EXPECT_TRUE(m.axes[0].invert);
    ASSERT_EQ(m.buttons.size(), 1U);
    EXPECT_EQ(m.buttons[0].action, Action::next_viewpoint);
    std::filesystem::remove(file);
}

TEST(DevicesTool, MapStoppedOrUnansweredWritesNothing) {
    Testbed bed;
    bed.plug(recorded("dualshock4-like"));
    const std::string file = temporary("unwritten.toml");
    Tool stopped({"map", "-o", file});
    ASSERT_TRUE(stopped.until("walks forward")) << stopped.err();
    stopped.signal(SIGINT);
    EXPECT_EQ(stopped.wait(), 130);
    Tool timed_out({"map", "-o", file, "--timeout", "0.1"});
    EXPECT_EQ(timed_out.wait(20'000), 1);
    EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace surefoot::input
