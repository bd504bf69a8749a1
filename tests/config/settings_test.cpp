// Settings: every refused value is named with file, line and key, and leaves what was there.
#include "config/settings.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace surefoot::config {
namespace {

void refused(std::string_view text, int line, std::string_view what, std::string_view remedy = {}) {
    Configuration c;
    const auto loaded = load_text(c, text, "s.toml");
    ASSERT_FALSE(loaded.ok()) << text;
    EXPECT_EQ(loaded.error().place, "s.toml:" + std::to_string(line)) << text;
    EXPECT_NE(loaded.error().what.find(what), std::string::npos) << loaded.error().text();
    EXPECT_NE(loaded.error().remedy.find(remedy), std::string::npos) << loaded.error().text();
    EXPECT_EQ(explain(c), explain(Configuration{})) << "a refused file changed something";
}

TEST(Settings, DefaultsLieWithinTheirOwnLimits) {
    Configuration c;
    for (const Entry& entry : schema()) {
        auto text = value_text(c.values, entry);
        if (text.front() == '"') text = text.substr(1, text.size() - 2);
        const auto set = set_value(c, entry.key, text);
        EXPECT_TRUE(set.ok()) << entry.key;
    }
    EXPECT_TRUE(check(c).ok());
}

TEST(Settings, KeysAreUniqueAndExplained) {
    std::set<std::string_view> keys;
    for (const Entry& entry : schema()) {
        EXPECT_TRUE(keys.insert(entry.key).second) << entry.key;
        EXPECT_GT(entry.help.size(), 10U) << entry.key;
        EXPECT_TRUE(entry.help.ends_with('.')) << entry.key;
    }
}

TEST(Settings, LaterSourcesWinAndOriginsAreKept) {
    Configuration c;
    ASSERT_TRUE(load_text(c, "rate_hz = 60\n\nwidth = 640\n", "a.toml").ok());
    ASSERT_TRUE(load_text(c, "rate_hz = 50.5\n", "b.toml").ok());
    ASSERT_TRUE(set_value(c, "height", "480").ok());
    EXPECT_EQ(c.values.rate_hz, 50.5);
    EXPECT_EQ(c.origin("rate_hz").text(), "b.toml:1");
    EXPECT_EQ(c.values.width, 640);
    EXPECT_EQ(c.origin("width").text(), "a.toml:3");
    EXPECT_EQ(c.values.height, 480);
    EXPECT_EQ(c.origin("height").text(), "command line");
    EXPECT_EQ(c.origin("late").text(), "default");
}

TEST(Settings, FilesAreRelativeToTheFileThatNamesThem) {
    Configuration c;
    ASSERT_TRUE(load_text(c, "model = \"m.walk\"\npath = \"/p.csv\"\ninput = \"devices\"\n", "/etc/surefoot/s.toml").ok());
    EXPECT_EQ(file_setting(c, "model"), "/etc/surefoot/m.walk");
    EXPECT_EQ(file_setting(c, "path"), "/p.csv");
    EXPECT_EQ(file_setting(c, "input", "devices"), "devices");
    EXPECT_EQ(file_setting(c, "input"), "/etc/surefoot/devices");
    EXPECT_EQ(file_setting(c, "state"), "");
    ASSERT_TRUE(set_value(c, "model", "here.walk").ok());
    EXPECT_EQ(file_setting(c, "model"), "here.walk") << "a command line is relative to where it is typed";
    refused("model = \"a\\nb\"\n", 1, "is not a file name of at most 4095 bytes");
    refused("model = \"" + std::string(4096, 'x') + "\"\n", 1, "is not a file name");
    refused("model = 3\n", 1, "model = 3 is not a file name");
    Configuration again;
    ASSERT_TRUE(set_value(again, "model", "a \"b\" \\c").ok());
    const std::string written = "model = " + value_text(again.values, *find_entry("model")) + "\n";
    Configuration read;
    ASSERT_TRUE(load_text(read, written, "s.toml").ok()) << written;
    EXPECT_EQ(read.values.model, again.values.model);
}

TEST(Settings, UnknownKeySuggestsTheNearest) {
    refused("widht = 3\n", 1, "unknown key 'widht'", "'width'");
    refused("\nselektor = \"flat\"\n", 2, "unknown key", "'selector'");
    refused("rate = 30\n", 1, "unknown key", "'rate_hz'");
    refused("[window]\nx = 1\n", 1, "unknown key 'window'");
    EXPECT_TRUE(nearest_key("zzzzzzzzzz").empty());
    EXPECT_TRUE(nearest_key(std::string(100000, 'w')).empty());
}

TEST(Settings, WrongTypesAndLimitsAreNamed) {
    refused("width = \"wide\"\n", 1, "width = \"wide\" is not a whole number");
    refused("width = 640.5\n", 1, "whole number");
    refused("width = 8\n", 1, "from 16 to 16384 (px)");
    refused("rate_hz = nan\n", 1, "from 1 to 1000 (Hz)");
    refused("rate_hz = inf\n", 1, "rate_hz");
    refused("rate_hz = [1]\n", 1, "rate_hz is not");
    refused("fifo = 1\n", 1, "true or false");
    refused("selector = \"best\"\n", 1, "one of flat");
    refused("sky = \"blue\"\n", 1, "#rrggbb");
    refused("height = 720\nlate = true\n", 2, "late = true is not one of lock, float");
}

TEST(Settings, BrokenSyntaxNamesItsLine) {
    refused("rate_hz = 30\nwidth = \n", 2, "");
    refused("width = 640\nwidth = 641\n", 2, "");
}

TEST(Settings, ProfileIsLaidOverTheRest) {
    constexpr std::string_view text = "rate_hz = 30\nwidth = 640\n[profile.kiosk]\nrate_hz = 60\n[profile.lab]\nstrict = true\n";
    Configuration c;
    ASSERT_TRUE(load_text(c, text, "s.toml", "kiosk").ok());
    EXPECT_EQ(c.values.rate_hz, 60);
    EXPECT_EQ(c.values.width, 640);
    EXPECT_FALSE(c.values.strict);
    EXPECT_EQ(c.origin("rate_hz").text(), "s.toml:4 (profile kiosk)");
    const auto missing = load_text(c, text, "s.toml", "kisok");
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.error().remedy.find("kiosk, lab"), std::string::npos);
    EXPECT_EQ(c.values.rate_hz, 60);
}

TEST(Settings, SlipsInUnusedProfilesAreFound) {
    refused("[profile.kiosk]\nwidht = 3\n", 2, "unknown key 'widht'");
    refused("profile = 3\n", 1, "not a table");
}

TEST(Settings, CommandLineTakesDashesAndWords) {
    Configuration c;
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
    Configuration c;
    ASSERT_TRUE(set_value(c, "worker_priority", "75").ok());
    const auto checked = check(c);
    ASSERT_FALSE(checked.ok());
    EXPECT_NE(checked.error().place.find("worker_priority (command line)"), std::string::npos);
}

TEST(Settings, BudgetLongerThanTheFrameIsRefusedUnderLock) {
    Configuration c;
    ASSERT_TRUE(set_value(c, "budget_ms", "40").ok());
    EXPECT_FALSE(check(c).ok());
    ASSERT_TRUE(set_value(c, "late", "float").ok());
    EXPECT_TRUE(check(c).ok());
}

TEST(Settings, CommentedDefaultsChangeNothingWithOrWithoutTheComments) {
    Configuration c;
    std::string text = commented_defaults();
    ASSERT_TRUE(load_text(c, text, "d.toml").ok());
    EXPECT_TRUE(c.origins.empty());
    std::string live;
    for (const Entry& entry : schema()) live += std::string(entry.key) + " = " + value_text(Settings{}, entry) + "\n";
    ASSERT_TRUE(load_text(c, live, "d.toml").ok());
    EXPECT_EQ(c.origins.size(), schema().size());
    for (const Entry& entry : schema()) {
        EXPECT_EQ(value_text(c.values, entry), value_text(Settings{}, entry));
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
    Configuration c;
    const auto loaded = load_file(c, "/nonexistent/surefoot.toml");
    ASSERT_FALSE(loaded.ok());
    EXPECT_EQ(loaded.error().place, "/nonexistent/surefoot.toml");
}

}  // namespace
}  // namespace surefoot::config
