// Wrong use of a command line: each message names the place and the remedy, in one wording, whatever CLI11 calls it.
#include "config/wrong_use.hpp"

#include <gtest/gtest.h>

#include <array>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"
#include "tests/config/toy_schema.hpp"

namespace surefoot::config {
namespace {

constexpr const char* hidden = "Experiments";
constexpr std::array renamed_options = {Renamed{"--fps", "--rate"}, Renamed{"--blur", "", "Leave it out"}};

/// What a toy program says of these arguments; empty where they are right.
std::string refused(const std::vector<std::string_view>& arguments) {
    struct {
        std::string model, out, name, size;
        double rate = 0;
        int frames = 0;
        unsigned workers = 0;
        bool json = false;
    } a;
    CLI::App app{"A toy", "toy"};
    app.require_subcommand(1);
    CLI::App* walk = app.add_subcommand("walk", "Walk");
    walk->add_option("model", a.model, "The model")->required();
    walk->add_option("-o,--out", a.out, "Output")->required();
    walk->add_option("--rate", a.rate, "Rate");
    walk->add_option("--frames", a.frames, "Frames");
    walk->add_option("--workers", a.workers, "Workers");
    walk->add_option("--size", a.size, "Size")
        ->check(CLI::Validator(
            [](std::string& text) {
                return Error{text, "This is no size", "Write 4x3", ErrorKind::misuse}.text();
            },
            ""));
    walk->add_option("--slice", a.rate, "For experiments")->group(hidden);
    walk->add_flag("--json", a.json, "JSON");
    CLI::App* devices = app.add_subcommand("devices", "Devices");
    devices->add_subcommand("list", "List");
    devices->add_subcommand("watch", "Watch")->add_option("name", a.name, "Name");
    std::vector<const char*> words = {"toy"};
    for (const std::string_view argument : arguments) words.push_back(argument.data());
    try {
        app.parse(static_cast<int>(words.size()), words.data());
        return {};
    } catch (const CLI::ParseError& error) {
        return wrong_use(app, error, arguments, renamed_options, hidden).text();
    }
}

TEST(WrongUse, RightUseIsTaken) {
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "--rate", "30", "--json"}), "");
    EXPECT_EQ(refused({"walk", "-o", "x", "--slice", "3", "--", "m"}), "");
    EXPECT_EQ(refused({"devices", "list"}), "");
    EXPECT_EQ(refused({"devices", "watch", "pad"}), "");
}

TEST(WrongUse, OfAValueNamesTheOptionAndWhatItTakes) {
    const auto walk = [](std::vector<std::string_view> more) {
        more.insert(more.begin(), {"walk", "m", "-o", "x"});
        return refused(more);
    };
    EXPECT_EQ(walk({"--rate"}), "--rate: The option's value is missing. Write it after --rate.");
    EXPECT_EQ(walk({"--json=maybe"}), "--json: The option takes no value. Write --json alone.");
    EXPECT_EQ(walk({"--rate", "30", "--rate", "60"}), "--rate: The option is given 2 times. Keep one of them.");
    EXPECT_EQ(walk({"--out", "y"}), "--out: The option is given 2 times. Keep one of them.");
    EXPECT_EQ(walk({"--rate", "abc"}), "--rate abc: The value is not allowed. Use a number.");
    EXPECT_EQ(walk({"--frames", "1.5"}), "--frames 1.5: The value is not allowed. Use a whole number.");
    EXPECT_EQ(walk({"--workers", "two"}), "--workers two: The value is not allowed. Use a whole number from 0.");
    EXPECT_EQ(walk({"--size", "big"}), "--size big: This is no size. Write 4x3.");
}

TEST(WrongUse, OfAWordNamesTheCommandAndTheNearestOne) {
    EXPECT_EQ(refused({"wlak"}), "There is no command 'wlak'. Did you mean 'walk'?");
    EXPECT_EQ(refused({"xyz"}), "There is no command 'xyz'. See `toy --help`.");
    EXPECT_EQ(refused({"devices", "lst"}), "devices: There is no command 'lst'. Did you mean 'list'?");
    const std::string list = " is superfluous. Remove it, or see `toy devices list --help`.";
    EXPECT_EQ(refused({"devices", "list", "extra"}), "devices list: The argument 'extra'" + list);
    const std::string walk = " is superfluous. Remove it, or see `toy walk --help`.";
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "extra"}), "walk: The argument 'extra'" + walk);
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "--", "extra"}), "walk: The argument 'extra'" + walk);
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "-5"}), "walk: The argument '-5'" + walk);
}

TEST(WrongUse, OfAnOptionNamesTheCommandAndTheNearestOne) {
    EXPECT_EQ(refused({"--json"}), "The option '--json' is unknown. See `toy --help`.");
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "--rte=5"}), "walk: The option '--rte' is unknown. Did you mean '--rate'?");
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "-x"}), "walk: The option '-x' is unknown. See `toy walk --help`.");
    EXPECT_EQ(refused({"walk", "m", "-o", "x", "--slic", "3"}).find("slice"), std::string::npos) << "it is hidden";
    EXPECT_EQ(refused({"devices", "list", "--rate", "3"}),
              "devices list: The option '--rate' is unknown. See `toy devices list --help`.");
}

TEST(WrongUse, OfTooFewWordsNamesTheOneThatIsMissing) {
    EXPECT_EQ(refused({"walk", "m"}), "walk: The option '--out' is required. Add it, or see `toy walk --help`.");
    EXPECT_EQ(refused({"walk", "-o", "x"}), "walk: The argument 'model' is required. Add it, or see `toy walk --help`.");
    EXPECT_EQ(refused({}), "No command is named. Use one of walk, devices, or see `toy --help`.");
}

/// What tests/old_names_cli.sh looks for behind a name: it has no renamed name of its own to look at yet.
std::regex by_name() {
    const auto script = read_text(std::string(SUREFOOT_SOURCE_DIR) + "/tests/old_names_cli.sh");
    EXPECT_TRUE(script);
    const std::string begin = "\nby_name=\"";
    const auto from = script->find(begin);
    EXPECT_NE(from, std::string::npos) << "the script has no pattern";
    const std::string pattern = script->substr(from + begin.size(), script->find("\"\n", from) - from - begin.size());
    return std::regex(pattern, std::regex::extended);
}

TEST(WrongUse, OfARenamedOptionIsRefusedByNameAsTheScriptOfOldNamesWantsIt) {
    const std::string now = refused({"walk", "m", "-o", "x", "--fps", "30"});
    EXPECT_EQ(now, "command line: The name '--fps' is now '--rate'. Write --rate and keep the value.");
    const std::string removed = refused({"walk", "m", "-o", "x", "--blur=3"});
    EXPECT_EQ(removed, "command line: The name '--blur' was removed. Leave it out.");
    EXPECT_TRUE(std::regex_search(now, by_name()));
    EXPECT_TRUE(std::regex_search(removed, by_name()));
    for (const std::string& other : {refused({"walk", "m", "-o", "x", "--rte", "5"}), std::string()})
        EXPECT_FALSE(std::regex_search(other, by_name())) << other;
}

TEST(WrongUse, ARenamedKeyIsRefusedByNameAsTheScriptOfOldNamesWantsIt) {
    for (const Renamed& one : test::renamed) {
        Configuration c(test::toy_schema());
        const auto loaded = load_text(c, std::string(one.before) + " = 1\n", "old.toml");
        ASSERT_FALSE(loaded.ok()) << one.before;
        const std::string text = loaded.error().text();
        EXPECT_TRUE(text.starts_with("old.toml:1: The name '" + std::string(one.before) + "' ")) << text;
        EXPECT_TRUE(std::regex_search(text, by_name())) << text;
    }
    Configuration c(test::toy_schema());
    const auto unknown = load_text(c, "rat_hz = 1\n", "old.toml");
    ASSERT_FALSE(unknown.ok());
    EXPECT_FALSE(std::regex_search(unknown.error().text(), by_name())) << "a key that never was is not an old one";
}

}  // namespace
}  // namespace surefoot::config
