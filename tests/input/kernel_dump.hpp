// Reads what Linux says about a device in debugfs (hid/*/rdesc): every field with its usages, then the event of each usage.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace surefoot::input {

/// Ranges without extent are not printed and stay 0.
struct DumpedNumbers {
    std::int64_t kind = 0, id = 0, offset = 0, size = 0, count = 0, logical_min = 0, logical_max = 0, physical_min = 0,
                 physical_max = 0, exponent = 0, flags = 0;
    bool operator==(const DumpedNumbers&) const = default;
};

struct DumpedField {
    DumpedNumbers numbers;
    std::string physical, logical, application;  ///< usages of the nearest collections of each type; empty for none
    std::string unit;                            ///< empty for none
    std::vector<std::string> usages;
};

/// "GenericDesktop.X" gives "Absolute.X"; "Sync.Report" where the kernel makes no event.
struct DumpedEvent {
    std::string usage, event;
};

struct KernelDump {
    std::vector<DumpedField> fields;  ///< in the order of Layout::fields_by_report
    std::vector<DumpedEvent> events;  ///< one a usage, in the same order
    bool cut = false;                 ///< the file ends at the size where dumps were cut; only `events` are incomplete
};

constexpr std::uintmax_t cut_dump_bytes = 200'000;  ///< what was read of one dump at most

inline std::int64_t flags_of(std::string_view text) {
    static constexpr std::pair<std::string_view, std::int64_t> words[] = {
        {"Constant", 1},          {"Variable", 2},   {"Relative", 4},   {"Wrap", 8},          {"NonLinear", 16},
        {"NoPreferredState", 32}, {"NullState", 64}, {"Volatile", 128}, {"BufferedByte", 256}};
    std::int64_t flags = 0;
    for (const auto& [word, bit] : words)
        if (text.find(word) != std::string_view::npos) flags |= bit;
    return flags;
}

/// "INPUT(3)[INPUT]" gives kind 0 and id 3; false for any other line.
inline bool read_dumped_report(std::string_view line, std::int64_t& kind, std::int64_t& id) {
    static constexpr std::string_view kinds[] = {"INPUT", "OUTPUT", "FEATURE"};
    for (std::int64_t k = 0; k < 3; ++k) {
        if (!line.starts_with(kinds[k])) continue;
        const std::string_view rest = line.substr(kinds[k].size());
        if (!rest.starts_with("[") && !rest.starts_with("(")) continue;
        kind = k;
        id = rest[0] == '(' ? std::strtoll(std::string(rest.substr(1)).c_str(), nullptr, 10) : 0;
        return true;
    }
    return false;
}

inline void read_dumped_property(std::string_view key, const std::string& value, DumpedField& field) {
    DumpedNumbers& f = field.numbers;
    const std::int64_t number = std::strtoll(value.c_str(), nullptr, 10);
    if (key == "Logical Minimum") f.logical_min = number;
    if (key == "Logical Maximum") f.logical_max = number;
    if (key == "Physical Minimum") f.physical_min = number;
    if (key == "Physical Maximum") f.physical_max = number;
    if (key == "Unit Exponent") f.exponent = number;
    if (key == "Report Size") f.size = number;
    if (key == "Report Count") f.count = number;
    if (key == "Report Offset") f.offset = number;
    if (key == "Flags") f.flags = flags_of(value);
    if (key == "Unit") field.unit = value;
    if (key == "Physical") field.physical = value;
    if (key == "Logical") field.logical = value;
    if (key == "Application") field.application = value;
}

/// Empty where the file cannot be read.
inline KernelDump read_kernel_dump(const std::filesystem::path& file) {
    KernelDump dump;
    std::error_code problem;
    dump.cut = std::filesystem::file_size(file, problem) == cut_dump_bytes;
    std::ifstream stream(file);
    std::int64_t kind = -1, id = 0, usages_left = 0;
    for (std::string text; std::getline(stream, text);) {
        const auto indent = text.find_first_not_of(' ');
        const std::string line = indent == std::string::npos ? "" : text.substr(indent);
        const auto arrow = line.find(" ---> ");
        const auto open = line.find('('), close = line.rfind(')');
        if (usages_left > 0) {
            dump.fields.back().usages.push_back(line);
            --usages_left;
        } else if (arrow != std::string::npos) {
            dump.events.push_back({line.substr(0, arrow), line.substr(arrow + 6)});
        } else if (read_dumped_report(line, kind, id) || kind < 0 || open == std::string::npos || close == std::string::npos) {
            continue;
        } else if (line.starts_with("Field(")) {
            dump.fields.emplace_back();
            dump.fields.back().numbers.kind = kind;
            dump.fields.back().numbers.id = id;
        } else if (!dump.fields.empty()) {
            const std::string value = line.substr(open + 1, close - open - 1);
            if (line.starts_with("Usage(")) usages_left = std::strtoll(value.c_str(), nullptr, 10);
            read_dumped_property(std::string_view(line).substr(0, open), value, dump.fields.back());
        }
    }
    // The last line of a file that was cut is no whole line.
    if (dump.cut && !dump.events.empty()) dump.events.pop_back();
    return dump;
}

}  // namespace surefoot::input
