// Settings: every refused value is named with file, line and key, and leaves what was there.
#include "config/settings.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>

#include "config/values.hpp"
#include "tests/config/toy_schema.hpp"

namespace surefoot::config {
namespace {

using test::toy_schema;

void refused(std::string_view text, int line, std::string_view what, std::string_view remedy = {}) {
    Configuration c(toy_schema());
    const auto loaded = load_text(c, text, "s.toml");
    ASSERT_FALSE(loaded.ok()) << text;
    EXPECT_EQ(loaded.error().place, "s.toml:" + std::to_string(line)) << text;
    EXPECT_NE(loaded.error().what.find(what), std::string::npos) << loaded.error().text();
    EXPECT_NE(loaded.error().remedy.find(remedy), std::string::npos) << loaded.error().text();
    EXPECT_EQ(explain(c), explain(Configuration(toy_schema()))) << "a refused file changed something";
}

TEST(Values, ControlCharactersAreEscaped) {
    EXPECT_EQ(text_of(Value{std::string("a\nb\x7f \"c\"\\")}), R"("a\u000Ab\u007F \"c\"\\")");
}

TEST(Settings, DefaultsLieWithinTheirOwnLimits) {
    Configuration c(toy_schema());
    for (const Entry& entry : toy_schema().entries()) {
        auto text = value_text(c.values, entry);
        if (text.front() == '"') text = text.substr(1, text.size() - 2);
        const auto set = set_value(c, entry.key, text);
        EXPECT_TRUE(set.ok()) << entry.key;
    }
    EXPECT_TRUE(check(c).ok());
}

TEST(Settings, KeysAreUniqueAndExplained) {
    std::set<std::string_view> keys;
    for (const Entry& entry : toy_schema().entries()) {
        EXPECT_TRUE(keys.insert(entry.key).second) << entry.key;
        EXPECT_GT(entry.help.size(), 10U) << entry.key;
        EXPECT_TRUE(entry.help.ends_with('.')) << entry.key;
        if (value_text(toy_schema().defaults(), entry) == "\"\"") {
            EXPECT_NE(entry.help.find("\"\""), std::string_view::npos) << entry.key << ": what does the empty default mean?";
        }
    }
}

TEST(Settings, LaterSourcesWinAndOriginsAreKept) {
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, "rate_hz = 60\n\nwidth = 640\n", "a.toml").ok());
    ASSERT_TRUE(load_text(c, "rate_hz = 50.5\n", "b.toml").ok());
    ASSERT_TRUE(set_value(c, "height", "480").ok());
    EXPECT_EQ(c.values.rate_hz, 50.5);
    EXPECT_EQ(c.origin("rate_hz").text(), "b.toml:1");
    EXPECT_EQ(c.values.width, 640U);
    EXPECT_EQ(c.origin("width").text(), "a.toml:3");
    EXPECT_EQ(c.values.height, 480U);
    EXPECT_EQ(c.origin("height").text(), "command line");
    EXPECT_EQ(c.origin("late").text(), "default");
}

TEST(Settings, FilesAreRelativeToTheFileThatNamesThem) {
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, "model = \"m.walk\"\npath = \"/p.csv\"\ninput = \"devices\"\n", "/etc/surefoot/s.toml").ok());
    EXPECT_EQ(file_setting(c, "model"), "/etc/surefoot/m.walk");
    EXPECT_EQ(file_setting(c, "path"), "/p.csv");
    EXPECT_EQ(file_setting(c, "input", "devices"), "devices");
    EXPECT_EQ(file_setting(c, "input"), "/etc/surefoot/devices");
    EXPECT_EQ(file_setting(c, "state"), "");
    ASSERT_TRUE(set_value(c, "model", "here.walk").ok());
    EXPECT_EQ(file_setting(c, "model"), "here.walk") << "a command line is relative to where it is typed";
    refused("model = \"a\\nb\"\n", 1, "is not allowed", "Use a file name of at most 4095 bytes");
    refused("model = \"" + std::string(4096, 'x') + "\"\n", 1, "is not allowed", "a file name");
    refused("model = 3\n", 1, "model = 3 is not allowed", "a file name");
    Configuration again(toy_schema());
    ASSERT_TRUE(set_value(again, "model", "a \"b\" \\c").ok());
    const std::string written = "model = " + value_text(again.values, *toy_schema().find("model")) + "\n";
    Configuration read(toy_schema());
    ASSERT_TRUE(load_text(read, written, "s.toml").ok()) << written;
    EXPECT_EQ(read.values.model_file, again.values.model_file);
}

TEST(Settings, UnknownKeySuggestsTheNearest) {
    refused("widht = 3\n", 1, "The key 'widht' is unknown", "Did you mean 'width'");
    refused("\nselektor = \"flat\"\n", 2, "The key 'selektor' is unknown", "'selector'");
    refused("rate = 30\n", 1, "The key 'rate' is unknown", "'rate_hz'");
    refused("[window]\nx = 1\n", 1, "The table 'window' is unknown", "[profile.NAME]");
    EXPECT_TRUE(toy_schema().nearest("zzzzzzzzzz").empty());
    EXPECT_TRUE(toy_schema().nearest(std::string(100000, 'w')).empty());
}

TEST(Settings, WrongTypesAndLimitsAreNamed) {
    refused("width = \"wide\"\n", 1, "width = \"wide\" is not allowed", "Use a whole number");
    refused("width = 640.5\n", 1, "width = 640.5 is not allowed", "whole number");
    refused("width = 8\n", 1, "width = 8 is not allowed", "from 16 to 16384 (px)");
    refused("rate_hz = nan\n", 1, "rate_hz = nan is not allowed", "from 1 to 1000 (Hz)");
    refused("rate_hz = inf\n", 1, "rate_hz");
    refused("rate_hz = [1]\n", 1, "rate_hz is not allowed", "Use a number from 1 to 1000 (Hz)");
    for (const std::string odd : {"0", "3", "2.5", "5", "-4", "nan", "inf"})
        refused("samples = " + odd + "\n", 1, "samples = " + odd + " is not allowed", "Use one of 1, 2, 4");
    refused("filter = \"cubic\"\n", 1, "filter = \"cubic\" is not allowed", "one of auto, bilinear, trilinear");
    refused("fifo = 1\n", 1, "fifo = 1 is not allowed", "Use true or false");
    refused("selector = \"best\"\n", 1, "selector = \"best\" is not allowed", "one of flat");
    refused("sky = \"blue\"\n", 1, "sky = \"blue\" is not allowed", "#rrggbb");
    refused("height = 720\nlate = true\n", 2, "late = true is not allowed", "Use one of lock, float");
}

TEST(Settings, NamesThatAreHandedInAreChoicesDefaultsAndHelp) {
    Configuration c(toy_schema());
    EXPECT_EQ(c.values.selector, "steep");
    EXPECT_EQ(c.values.backend, "paper");
    ASSERT_TRUE(load_text(c, "selector = \"flat\"\nbackend = \"glass\"\n", "s.toml").ok());
    EXPECT_EQ(c.values.selector, "flat");
    EXPECT_EQ(value_text(c.values, *toy_schema().find("backend")), "\"glass\"");
    refused("selector = \"two-stage\"\n", 1, "is not allowed", "Use one of flat, steep");
    refused("backend = \"smoke\"\n", 1, "backend = \"smoke\" is planned", "Use one of paper, glass");
    const std::string page = commented_defaults(toy_schema());
    EXPECT_NE(page.find("#   steep             what is near\n"), std::string::npos) << page;
    EXPECT_NE(page.find("# selector = \"steep\"\n"), std::string::npos) << page;
}

TEST(Settings, ChoicesOfTheCoreAreEnums) {
    Configuration c(toy_schema());
    EXPECT_EQ(c.values.late, rt::LatePolicy::lock);
    EXPECT_EQ(c.values.clock, rt::ClockKind::real);
    ASSERT_TRUE(load_text(c, "late = \"float\"\nclock = \"virtual\"\n", "s.toml").ok());
    EXPECT_EQ(c.values.late, rt::LatePolicy::floating);
    EXPECT_EQ(c.values.clock, rt::ClockKind::virtual_time);
    EXPECT_EQ(choice_of(c.values, *toy_schema().find("late")), "float");
    EXPECT_EQ(value_text(c.values, *toy_schema().find("clock")), "\"virtual\"");
    refused("late = \"loose\"\n", 1, "late = \"loose\" is not allowed", "one of lock, float");
    refused("clock = 1\n", 1, "clock = 1 is not allowed", "one of real, virtual");
}

TEST(Settings, RenamedKeysAreRefusedByNameWithTheNewOne) {
    for (const auto* key : {"frame_rate", "frame-rate", "Frame_Rate"}) {
        refused(std::string("width = 640\n") + key + " = 60\n", 2, "is now 'rate_hz'", "rate_hz");
        Configuration c(toy_schema());
        const auto set = set_value(c, key, "60");
        ASSERT_FALSE(set.ok()) << key;
        EXPECT_NE(set.error().what.find("'rate_hz'"), std::string::npos) << set.error().text();
        EXPECT_EQ(c.values.rate_hz, 30);
    }
    refused("smoothing = 1\n", 1, "The name 'smoothing' was removed", "Take it out");
    refused("[profile.kiosk]\nframe_rate = 60\n", 2, "is now 'rate_hz'");
    const auto problems = problems_in_text(toy_schema(), "frame_rate = 60\nrate_hz = 60\n", "s.toml");
    ASSERT_EQ(problems.size(), 1U) << "the new key beside the old one does not hide it";
    EXPECT_EQ(problems[0].nearest, "rate_hz");
    for (const Renamed& one : test::renamed) EXPECT_EQ(toy_schema().find(one.before), nullptr) << one.before;
    for (const Renamed& one : renamed_keys()) {
        EXPECT_EQ(toy_schema().find(one.before), nullptr) << one.before;
        EXPECT_TRUE(one.now.empty() ? !one.remedy.empty() : toy_schema().find(one.now) != nullptr) << one.before;
    }
}

TEST(Settings, RenamedOptionsAreRefusedByNameWithTheNewOne) {
    constexpr std::array options = {Renamed{"--fps", "--rate"}, Renamed{"--blur", "", "leave it out"}};
    const auto renamed = renamed_error(options, "surefoot walk", "--fps");
    ASSERT_TRUE(renamed.has_value());
    EXPECT_EQ(renamed->text().find("surefoot walk: The name '--fps' is now '--rate'"), 0U) << renamed->text();
    EXPECT_NE(renamed_error(options, "", "--blur")->remedy.find("leave it out"), std::string::npos);
    EXPECT_FALSE(renamed_error(options, "", "--rate").has_value());
    EXPECT_FALSE(renamed_error({}, "", "--fps").has_value());
}

TEST(Settings, BrokenSyntaxNamesItsLine) {
    refused("rate_hz = 30\nwidth = \n", 2, "");
    refused("width = 640\nwidth = 641\n", 2, "");
}

TEST(Settings, ProfileIsLaidOverTheRest) {
    constexpr std::string_view text = "rate_hz = 30\nwidth = 640\n[profile.kiosk]\nrate_hz = 60\n[profile.lab]\nstrict = true\n";
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, text, "s.toml", "kiosk").ok());
    EXPECT_EQ(c.values.rate_hz, 60);
    EXPECT_EQ(c.values.width, 640U);
    EXPECT_FALSE(c.values.strict);
    EXPECT_EQ(c.origin("rate_hz").text(), "s.toml:4 (profile kiosk)");
    const auto missing = load_text(c, text, "s.toml", "kisok");
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.error().remedy.find("kiosk, lab"), std::string::npos);
    EXPECT_EQ(c.values.rate_hz, 60);
}

TEST(Settings, SlipsInUnusedProfilesAreFound) {
    refused("[profile.kiosk]\nwidht = 3\n", 2, "The key 'widht' is unknown");
    refused("profile = 3\n", 1, "not a table");
}

TEST(Settings, CommandLineTakesDashesAndWords) {
    Configuration c(toy_schema());
    EXPECT_TRUE(set_value(c, "rate-hz", "25").ok());
    EXPECT_TRUE(set_value(c, "fifo", "off").ok());
    EXPECT_EQ(c.values.rate_hz, 25);
    EXPECT_FALSE(c.values.fifo);
    EXPECT_FALSE(set_value(c, "rate-hz", "25fps").ok());
    EXPECT_FALSE(set_value(c, "rate-hz", "").ok());
    EXPECT_FALSE(set_value(c, "nope", "1").ok());
    EXPECT_EQ(c.values.rate_hz, 25);
}

TEST(Settings, PrioritiesMustDescend) {
    Configuration c(toy_schema());
    ASSERT_TRUE(set_value(c, "worker_priority", "75").ok());
    const auto checked = check(c);
    ASSERT_FALSE(checked.ok());
    EXPECT_NE(checked.error().place.find("worker_priority (command line)"), std::string::npos);
}

TEST(Settings, BudgetLongerThanTheFrameIsRefusedUnderLock) {
    Configuration c(toy_schema());
    ASSERT_TRUE(set_value(c, "budget_ms", "40").ok());
    EXPECT_FALSE(check(c).ok());
    ASSERT_TRUE(set_value(c, "late", "float").ok());
    EXPECT_TRUE(check(c).ok());
}

TEST(Settings, AnHourIsOnTheClockAndOnlyAnHourRuns) {
    refused("hour = 24.5\n", 1, "hour = 24.5 is not allowed", "from -1 to 24 (h)");
    refused("hour = -2\n", 1, "hour = -2 is not allowed", "from -1 to 24 (h)");
    refused("hour = 12\nhour_speed = 601\n", 2, "hour_speed = 601 is not allowed", "from -600 to 600 (h/min)");
    refused("hour = nan\n", 1, "hour = nan is not allowed");
    const auto checked = [](const std::string& text) {
        Configuration c(toy_schema());
        EXPECT_TRUE(load_text(c, text, "s.toml").ok()) << text;
        const auto ok = check(c);
        return ok ? std::string("ok") : ok.error().text();
    };
    EXPECT_EQ(checked(""), "ok");
    for (const std::string hour : {"-1", "0", "6.5", "24"}) EXPECT_EQ(checked("hour = " + hour + "\n"), "ok");
    EXPECT_NE(checked("hour = -0.5\n").find("hour (s.toml:1): The hour -0.5 is not on a clock"), std::string::npos);
    EXPECT_NE(checked("\nhour_speed = 2\n").find("hour_speed (s.toml:2): A speed of 2 h/min needs an hour to begin at"),
              std::string::npos);
    EXPECT_EQ(checked("hour_speed = 2\nhour = 0\n"), "ok");
    EXPECT_EQ(checked("hour_speed = -2\nhour = 12\n"), "ok");
}

TEST(Settings, CommentedDefaultsChangeNothingWithOrWithoutTheComments) {
    Configuration c(toy_schema());
    std::string text = commented_defaults(toy_schema());
    ASSERT_TRUE(load_text(c, text, "d.toml").ok());
    EXPECT_TRUE(c.origins.empty());
    std::string live;
    for (const Entry& entry : toy_schema().entries())
        live += std::string(entry.key) + " = " + value_text(toy_schema().defaults(), entry) + "\n";
    ASSERT_TRUE(load_text(c, live, "d.toml").ok());
    EXPECT_EQ(c.origins.size(), toy_schema().entries().size());
    for (const Entry& entry : toy_schema().entries()) {
        EXPECT_EQ(value_text(c.values, entry), value_text(toy_schema().defaults(), entry));
        EXPECT_NE(text.find("# " + std::string(entry.key) + " = "), std::string::npos) << entry.key;
    }
}

TEST(Settings, ColourIsRead) {
    const auto colour = colour_of("#ff0080");
    EXPECT_EQ(colour[0], 1.0F);
    EXPECT_EQ(colour[1], 0.0F);
    EXPECT_NEAR(colour[2], 128.0F / 255.0F, 1e-6F);
}

TEST(Settings, MissingFileIsNamed) {
    Configuration c(toy_schema());
    const auto loaded = load_file(c, "/nonexistent/surefoot.toml");
    ASSERT_FALSE(loaded.ok());
    EXPECT_EQ(loaded.error().place, "/nonexistent/surefoot.toml");
}

}  // namespace
}  // namespace surefoot::config
