// A function fits on a screen: at most 70 lines from its head to its closing brace.
// Read are the product's sources as clang-format leaves them: a function's head and its last brace stand in the first column.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path tree_of_functions = SUREFOOT_SOURCE_DIR;

constexpr std::size_t max_lines_of_function = 70;

struct Function {
    std::size_t line = 0, lines = 0;  ///< line: of its head, from 1
    std::string head;
};

/// Whether a line in the first column begins a function: names with a bracket, and no table, type or namespace.
bool begins_function(std::string_view line) {
    if (line.empty() || line[0] == ' ' || line[0] == '}' || line[0] == '#' || line[0] == '/') return false;
    for (const std::string_view other : {"namespace", "struct ", "class ", "enum ", "union ", "template", "TEST"})
        if (line.starts_with(other)) return false;
    const auto bracket = line.find('('), assigned = line.find('=');
    return bracket != std::string_view::npos && (assigned == std::string_view::npos || bracket < assigned);
}

std::vector<Function> functions_of(const std::string& source) {
    std::vector<Function> found;
    std::istringstream lines(source);
    std::size_t number = 0, begin = 0;
    std::string head;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (begins_function(line)) {
            begin = number;
            head = line;
        }
        if (begin == 0) continue;
        if (line.starts_with('}')) found.push_back({begin, number - begin + 1, head});
        const auto opened = std::count(line.begin(), line.end(), '{'), closed = std::count(line.begin(), line.end(), '}');
        const bool one_line = begin == number && (line.ends_with(';') || (opened > 0 && opened == closed));
        if (line.starts_with('}') || one_line) begin = 0;
    }
    return found;
}

TEST(Functions, FitOnAScreen) {
    std::size_t count = 0;
    for (const auto* top : {"config", "input", "render", "rt", "tools", "systemd"}) {
        for (const auto& entry : fs::recursive_directory_iterator(tree_of_functions / top)) {
            if (!entry.is_regular_file() || entry.path().extension() != ".cpp") continue;
            const auto source = read_text(entry.path().string());
            ASSERT_TRUE(source) << entry.path();
            for (const Function& function : functions_of(*source)) {
                ++count;
                EXPECT_LE(function.lines, max_lines_of_function) << fs::relative(entry.path(), tree_of_functions).generic_string()
                                                                 << ":" << function.line << ": " << function.head;
            }
        }
    }
    EXPECT_GT(count, 2000U) << "the functions were not found";
}

TEST(Functions, AreFoundWithTheirLines) {
    const auto found = functions_of(
        "struct A {\n    int a;\n};\nint b(int c);\nconstexpr int table[] = {\n    f(1),\n};\nint one() {\n    return 1;\n}\n"
        "Result<void> Two::two(int a,\n                       int b) {\n    if (a) {\n    }\n}\nint main() { return 0; }  // "
        "0\n\nstruct B {\n};\n");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].line, 8U);
    EXPECT_EQ(found[0].lines, 3U);
    EXPECT_EQ(found[1].line, 11U);
    EXPECT_EQ(found[1].lines, 5U);
}

}  // namespace
}  // namespace surefoot::house
