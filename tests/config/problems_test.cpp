// Everything that is wrong in a settings file is told at once, in words and in parts; and what the tool writes, it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "config/settings.hpp"
#include "tests/config/toy_schema.hpp"

namespace surefoot::config {
namespace {

using test::toy_schema;

TEST(Problems, AreAllReportedByLineWithTheirParts) {
    const auto problems = problems_in_text(
        toy_schema(), "width = \"wide\"\n[profile.kiosk]\nrate_hz = 0\nselektor = \"flat\"\n[profile.lab]\nfifo = [1]\n",
        "s.toml");
    ASSERT_EQ(problems.size(), 4U);
    EXPECT_EQ(problems[0].error.place, "s.toml:1");
    EXPECT_EQ(problems[0].key, "width");
    EXPECT_EQ(problems[0].found, "\"wide\"");
    EXPECT_EQ(problems[0].allowed, "a whole number from 16 to 16384 (px)");
    EXPECT_EQ(problems[1].line, 3);
    EXPECT_EQ(problems[1].found, "0");
    EXPECT_EQ(problems[2].line, 4);
    EXPECT_EQ(problems[2].key, "selektor");
    EXPECT_EQ(problems[2].nearest, "selector");
    EXPECT_TRUE(problems[2].allowed.empty());
    EXPECT_EQ(problems[3].line, 6);
    EXPECT_TRUE(problems[3].found.empty()) << "a list is no value";
    EXPECT_EQ(problems[3].allowed, "true or false");
    for (const Problem& problem : problems) EXPECT_EQ(problem.file, "s.toml");
}

TEST(Problems, RulesAcrossKeysHoldInEveryProfile) {
    constexpr std::string_view text =
        "rate_hz = 30\nbudget_ms = 30\n[profile.fast]\nrate_hz = 60\n[profile.slow]\nrate_hz = 20\n";
    Configuration plain(toy_schema());
    ASSERT_TRUE(load_text(plain, text, "s.toml").ok());
    ASSERT_TRUE(check(plain).ok());
    const auto problems = problems_in_text(toy_schema(), text, "s.toml");
    ASSERT_EQ(problems.size(), 1U);
    EXPECT_EQ(problems[0].key, "budget_ms");
    EXPECT_EQ(problems[0].line, 2);
    const auto always =
        problems_in_text(toy_schema(), "raster_priority = 80\n[profile.a]\nwidth = 640\n[profile.b]\nwidth = 800\n", "s.toml");
    EXPECT_EQ(always.size(), 1U) << "one rule that is broken everywhere is told once";
}

TEST(Problems, AMissingFileAndBrokenSyntaxAreProblemsToo) {
    const auto missing = problems_in_file(toy_schema(), "/nonexistent/s.toml");
    ASSERT_EQ(missing.size(), 1U);
    EXPECT_EQ(missing[0].error.place, "/nonexistent/s.toml");
    const auto broken = problems_in_text(toy_schema(), "rate_hz = 30\nwidth = \n", "s.toml");
    ASSERT_EQ(broken.size(), 1U);
    EXPECT_EQ(broken[0].line, 2);
}

TEST(Problems, DefaultsWrittenOutAreTakenCommentedOrNot) {
    std::string text = commented_defaults(toy_schema());
    EXPECT_TRUE(problems_in_text(toy_schema(), text, "d.toml").empty());
    for (const Entry& entry : toy_schema().entries()) {
        const std::string line = "\n# " + std::string(entry.key) + " = ";
        const auto at = text.find(line);
        ASSERT_NE(at, std::string::npos) << entry.key;
        text.erase(at + 1, 2);
    }
    EXPECT_TRUE(problems_in_text(toy_schema(), text, "d.toml").empty());
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, text, "d.toml").ok());
    EXPECT_EQ(c.origins.size(), toy_schema().entries().size());
    for (const Entry& entry : toy_schema().entries())
        EXPECT_EQ(value_text(c.values, entry), value_text(toy_schema().defaults(), entry)) << entry.key;
}

TEST(Problems, ExplainNamesLimitsAndOrigins) {
    Configuration c(toy_schema());
    ASSERT_TRUE(load_text(c, "width = 640\n[profile.kiosk]\nrate_hz = 60\n", "s.toml", "kiosk").ok());
    ASSERT_TRUE(set_value(c, "height", "480").ok());
    const std::string text = explain(c);
    const auto line = [&](const std::string& key) {
        const auto at = text.find("\n" + key + " ");
        const auto from = at == std::string::npos ? 0 : at + 1;
        return text.substr(from, text.find('\n', from) - from);
    };
    EXPECT_NE(line("rate_hz").find("s.toml:3 (profile kiosk)"), std::string::npos) << text;
    EXPECT_NE(line("rate_hz").find("from 1 to 1000"), std::string::npos);
    EXPECT_NE(line("width").find("px"), std::string::npos);
    EXPECT_NE(line("width").find("s.toml:1 "), std::string::npos);
    EXPECT_NE(line("height").find("command line"), std::string::npos);
    EXPECT_NE(line("late").find("default"), std::string::npos);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), static_cast<std::ptrdiff_t>(toy_schema().entries().size()));
}

}  // namespace
}  // namespace surefoot::config
