// Reads every include line of the project and fails on an arrow that the table of rooms does not allow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "tests/house/house.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path root = SUREFOOT_SOURCE_DIR;
constexpr std::size_t max_lines = 500;

bool is_source(const fs::path& path) {
    const auto ending = path.extension();
    return ending == ".cpp" || ending == ".hpp" || ending == ".h" || ending == ".c";
}

/// Every source file, as a path from the root with '/'.
std::vector<std::string> sources() {
    std::vector<std::string> files;
    for (const auto* top : {"rt", "render", "input", "config", "systemd", "tools", "tests"}) {
        if (!fs::exists(root / top)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / top))
            if (entry.is_regular_file() && is_source(entry.path()))
                files.push_back(fs::relative(entry.path(), root).generic_string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

void for_each_line(const std::string& file, const std::function<void(std::size_t, const std::string&)>& use) {
    std::ifstream stream(root / file);
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) use(++number, line);
}

TEST(House, EveryIncludeIsAnArrowOfTheTable) {
    const auto files = sources();
    EXPECT_GT(files.size(), 50U) << "the sources were not found";
    for (const auto& file : files)
        for_each_line(file, [&](std::size_t number, const std::string& line) {
            const auto include = include_in(line);
            if (include.empty()) return;
            const auto name = include.substr(1);
            const auto problem = include.front() == '"' ? include_problem(file, name) : system_include_problem(file, name);
            EXPECT_EQ(problem, "") << file << ":" << number;
        });
}

TEST(House, ForbiddenArrowsAreFound) {
    EXPECT_NE(include_problem("render/model/model.cpp", "render/gl/device.hpp"), "");
    EXPECT_NE(include_problem("render/draw/tables.cpp", "render/gl/device.hpp"), "");
    EXPECT_NE(include_problem("render/gl/device.cpp", "render/effects/effects.hpp"), "");
    EXPECT_NE(include_problem("render/prepare/prepare.cpp", "render/select/select.hpp"), "");
    EXPECT_NE(include_problem("render/select/depth_first.cpp", "rt/frame/record.hpp"), "");
    EXPECT_NE(include_problem("config/schema.cpp", "render/engine.hpp"), "");
    EXPECT_NE(include_problem("rt/base/file.cpp", "rt/frame/record.hpp"), "");
    EXPECT_NE(include_problem("rt/frame/loop.cpp", "config/settings.hpp"), "");
    EXPECT_NE(include_problem("tools/report/page.cpp", "tools/walk/walk.hpp"), "");
    EXPECT_NE(include_problem("systemd/daemon/daemon.cpp", "tools/cli/command.hpp"), "");
    EXPECT_NE(include_problem("systemd/daemon/daemon.cpp", "render/engine.hpp"), "");
    for (const char* file :
         {"tools/walk/walk.cpp", "tools/soak/soak.cpp", "tools/accuracy/sweep.cpp", "tools/monitor/monitor.cpp",
          "tools/doctor/check.cpp", "tools/selftest/hard.cpp", "tools/report/page.cpp", "tools/scenes/room.cpp"})
        EXPECT_NE(include_problem(file, "tools/cli/command.hpp"), "") << "a command is above all";
    for (const char* file :
         {"tools/cli/walk.cpp", "tools/walk/walk.cpp", "tools/soak/soak.cpp", "tools/accuracy/sweep.cpp",
          "tools/monitor/monitor.cpp", "tools/doctor/check.cpp", "tools/selftest/hard.cpp", "render/engine.cpp"})
        EXPECT_NE(include_problem(file, "systemd/daemon/daemon.hpp"), "") << "the service is above all";
    EXPECT_NE(include_problem("tools/soak/soak.cpp", "tools/monitor/monitor.hpp"), "");
    EXPECT_NE(include_problem("tools/doctor/check.cpp", "tools/soak/soak.hpp"), "");
    EXPECT_NE(include_problem("tools/doctor/check.cpp", "tools/accuracy/sweep.hpp"), "");
    EXPECT_NE(include_problem("tools/doctor/check.cpp", "tools/monitor/monitor.hpp"), "");
    EXPECT_NE(include_problem("tools/accuracy/sweep.cpp", "tools/scenes/scenes.hpp"), "");
    EXPECT_NE(include_problem("tools/selftest/hard.cpp", "tools/walk/walk.hpp"), "");
    EXPECT_NE(include_problem("render/stream/pages.cpp", "render/model/model.hpp"), "") << "a room that is not there";
    EXPECT_NE(include_problem("render/splats/splats.cpp", "render/model/model.hpp"), "") << "a room that is not there";
    EXPECT_NE(include_problem("render/cache/update.cpp", "render/gl/device.hpp"), "") << "a plan is data";
    EXPECT_NE(include_problem("render/model/model.cpp", "render/cache/validity.hpp"), "") << "the other way";
    EXPECT_NE(include_problem("tools/cache_study/study.cpp", "tools/walk/walk.hpp"), "");
    EXPECT_NE(include_problem("tools/cli/walk.cpp", "tests/house/house.hpp"), "");
    EXPECT_NE(include_problem("render/newroom/x.cpp", "rt/base/hash.hpp"), "") << "an unplanned room";
    EXPECT_NE(include_problem("rt/frame/loop.cpp", "record.hpp"), "") << "not relative to the root";
    EXPECT_NE(include_problem("rt/frame/loop.cpp", "../base/hash.hpp"), "");
    EXPECT_NE(include_problem("rt/frame/loop.cpp", "rt/frame/../../render/engine.hpp"), "") << "a way round";
    EXPECT_NE(include_problem("rt/frame/loop.cpp", "rt/./frame/record.hpp"), "");
    EXPECT_NE(include_problem("input/newroom/x.cpp", "rt/base/hash.hpp"), "") << "an unplanned room";
    EXPECT_NE(include_problem("tools/walk/walk.cpp", "input/newroom/x.hpp"), "") << "an unplanned room";
    EXPECT_NE(include_problem("input/map/mapper.cpp", "render/engine.hpp"), "");
    EXPECT_NE(include_problem("render/select/slices.cpp", "rt/clock/clock.hpp"), "");
    EXPECT_NE(system_include_problem("render/engine.cpp", "GL/gl.h"), "");
    EXPECT_NE(system_include_problem("tools/walk/walk.cpp", "EGL/egl.h"), "");
}

TEST(House, AllowedArrowsAreLeftAlone) {
    EXPECT_EQ(include_problem("render/model/model.cpp", "render/model/model.hpp"), "");
    EXPECT_EQ(include_problem("config/schema.cpp", "rt/base/result.hpp"), "");
    EXPECT_EQ(include_problem("rt/frame/loop.cpp", "rt/clock/clock.hpp"), "");
    EXPECT_EQ(include_problem("render/engine.cpp", "render/gl/device.hpp"), "");
    EXPECT_EQ(include_problem("render/cache/update.cpp", "render/model/view.hpp"), "");
    EXPECT_EQ(include_problem("input/steering.cpp", "input/map/mapper.hpp"), "");
    EXPECT_EQ(include_problem("input/gpio/backend/lines_v2.cpp", "input/gpio/lines.hpp"), "");
    EXPECT_EQ(include_problem("tools/cli/walk.cpp", "tools/walk/walk.hpp"), "");
    EXPECT_EQ(include_problem("tools/walk/walk.cpp", "tools/report/report.hpp"), "");
    EXPECT_EQ(include_problem("tools/doctor/machine.cpp", "tools/walk/walk.hpp"), "");
    EXPECT_EQ(include_problem("tools/cli/doctor.cpp", "tools/doctor/check.hpp"), "");
    EXPECT_EQ(include_problem("systemd/daemon/daemon.cpp", "tools/monitor/monitor.hpp"), "");
    EXPECT_EQ(include_problem("tests/daemon/reload_test.cpp", "systemd/daemon/daemon.hpp"), "");
    EXPECT_EQ(include_problem("tests/gl/slices_test.cpp", "render/gl/device.hpp"), "");
    EXPECT_EQ(system_include_problem("render/gl/egl.cpp", "EGL/egl.h"), "");
    EXPECT_EQ(system_include_problem("render/engine.cpp", "vector"), "");
}

/// Release builds leave assert() out: what cannot happen is a CHECK, which stays in every build.
bool uses_assert(const std::string& line) {
    const std::string code = line.substr(0, line.find("//"));
    if (code.find("<cassert>") != std::string::npos || code.find("<assert.h>") != std::string::npos) return true;
    for (std::size_t at = code.find("assert("); at != std::string::npos; at = code.find("assert(", at + 1))
        if (at == 0 || (std::isalnum(static_cast<unsigned char>(code[at - 1])) == 0 && code[at - 1] != '_')) return true;
    return false;
}

TEST(House, ProductCodeChecksInEveryBuildAndNeverAsserts) {
    for (const auto& file : sources()) {
        if (file.starts_with("tests/")) continue;
        for_each_line(file, [&](std::size_t number, const std::string& line) {
            EXPECT_FALSE(uses_assert(line)) << file << ":" << number << ": use CHECK of rt/base/check.hpp";
        });
    }
    EXPECT_TRUE(uses_assert("    assert(false);"));
    EXPECT_TRUE(uses_assert("#include <cassert>"));
    EXPECT_TRUE(uses_assert("static_assert(a), assert(b);"));
    EXPECT_FALSE(uses_assert("static_assert(sizeof(int) == 4);"));
    EXPECT_FALSE(uses_assert("// never assert() here"));
}

TEST(House, IncludeLinesAreReadHoweverTheyAreSpaced) {
    EXPECT_EQ(include_in("#include \"a/b.hpp\"  // why"), "\"a/b.hpp");
    EXPECT_EQ(include_in("  #  include <GL/gl.h>"), "<GL/gl.h");
    EXPECT_EQ(include_in("#include\"a.hpp\""), "\"a.hpp");
    EXPECT_EQ(include_in("// #include \"a.hpp\""), "");
    EXPECT_EQ(include_in("#if 1"), "");
    EXPECT_EQ(include_in(""), "");
}

TEST(House, TopLevelHoldsOnlyWhatIsPlanned) {
    for (const auto& entry : fs::directory_iterator(root))
        EXPECT_TRUE(top_level_allowed(entry.path().filename().string())) << entry.path() << " is not in the table of rooms";
    EXPECT_TRUE(top_level_allowed(".clang-format"));
    EXPECT_FALSE(top_level_allowed("src"));
    EXPECT_FALSE(top_level_allowed("notes.txt"));
}

TEST(House, EveryFileFitsInAHeadAndNamesItsJobFirst) {
    const std::string unfinished = std::string("TO") + "DO";
    for (const auto& file : sources()) {
        std::size_t lines = 0;
        std::string first;
        for_each_line(file, [&](std::size_t number, const std::string& line) {
            lines = number;
            if (number == 1) first = line;
            EXPECT_EQ(line.find(unfinished), std::string::npos) << file << ":" << number;
        });
        EXPECT_LE(lines, max_lines) << file;
        EXPECT_TRUE(first.starts_with("// ")) << file << " does not begin with a comment that says its job";
    }
}

}  // namespace
}  // namespace surefoot::house
