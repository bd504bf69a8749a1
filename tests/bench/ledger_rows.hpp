// Rows of a ledger, as benches read them: what each frame promised and reached, its cut and its pose.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/base/geometry.hpp"
#include "rt/base/result.hpp"

namespace surefoot::bench {

/// What a frame promised and reached, and where the eye was.
struct LedgerRow {
    double guaranteed = 0, reached = 0;
    std::string guarantee, node, cut;
    Pose pose;
};

inline std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
        if (c == ',')
            cells.emplace_back();
        else
            cells.back() += c;
    }
    return cells;
}

/// By the frame's number.
using LedgerRows = std::map<std::uint64_t, LedgerRow>;

inline Result<LedgerRows> read_ledger_rows(const char* file) {
    auto text = read_text(file);
    if (!text) return text.error();
    std::istringstream lines(*text);
    std::string line;
    std::getline(lines, line);
    std::map<std::string, std::size_t> columns;
    for (const std::string& name : cells_of(line)) columns.emplace(name, columns.size());
    for (const char* name : {"frame", "guaranteed_accuracy", "reached_accuracy", "guarantee", "binding_node", "cut_hash", "x",
                             "y", "z", "qx", "qy", "qz", "qw"})
        if (columns.count(name) == 0) return Error{file, fmt::format("There is no column {}", name), "Walk with --ledger"};
    LedgerRows rows;
    while (std::getline(lines, line)) {
        const std::vector<std::string> cells = cells_of(line);
        const auto cell = [&](const char* name) { return cells.at(columns.at(name)); };
        const auto number = [&](const char* name) { return std::strtod(cell(name).c_str(), nullptr); };
        LedgerRow& row = rows[std::strtoull(cell("frame").c_str(), nullptr, 10)];
        row = {number("guaranteed_accuracy"), number("reached_accuracy"), cell("guarantee"),
               cell("binding_node"),          cell("cut_hash"),           {}};
        row.pose.position = {number("x"), number("y"), number("z")};
        row.pose.orientation = dquat(number("qw"), number("qx"), number("qy"), number("qz"));
    }
    return rows;
}

}  // namespace surefoot::bench
