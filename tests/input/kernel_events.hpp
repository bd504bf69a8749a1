// Reads what evdev said of a device's reports: each node's axes, then the events of every report by its number.
//
//   node 0 name "pad"                                    report 3
//     ABS: 0x00[0..255 fuzz 0 flat 15 res 0] 0x10[...]     0 ABS 0x10 -1          (node, type, code, value)
//
// An event of a key follows an MSC 0x04 with the key's full usage; without one it is no key that a person presses.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace surefoot::input {

enum class EventType : std::uint8_t { key, relative, absolute, key_without_usage };

/// `code` is evdev's code, but of a key its full usage.
struct KernelEvent {
    EventType type = EventType::key;
    std::uint32_t code = 0;
    std::int32_t value = 0;
    bool operator==(const KernelEvent&) const = default;
    bool operator<(const KernelEvent& o) const { return std::tie(type, code, value) < std::tie(o.type, o.code, o.value); }
};

/// What evdev says of an absolute axis.
struct KernelAxis {
    std::int32_t min = 0, max = 0, fuzz = 0;
    bool operator==(const KernelAxis&) const = default;
};

struct KernelEvents {
    std::size_t nodes = 0;
    std::map<std::uint32_t, KernelAxis> axes;       ///< by code
    std::vector<std::vector<KernelEvent>> reports;  ///< by report number
    std::vector<std::string> problems;              ///< lines that were not understood
};

inline void read_kernel_axes(const std::string& line, KernelEvents& events) {
    std::istringstream words(line.substr(line.find(':') + 1));
    for (std::string word; words >> word;) {
        unsigned code = 0;
        KernelAxis axis;
        if (std::sscanf(word.c_str(), "0x%x[%d..%d", &code, &axis.min, &axis.max) != 3) continue;
        words >> word >> axis.fuzz;
        if (events.axes.try_emplace(code, axis).first->second != axis) events.problems.push_back(line);
    }
}

inline KernelEvents read_kernel_events(const std::filesystem::path& file) {
    KernelEvents events;
    std::ifstream stream(file);
    std::uint32_t usage = 0;
    for (std::string line; std::getline(stream, line);) {
        unsigned node = 0, code = 0, number = 0;
        char type[4] = {};
        int value = 0;
        if (line.empty() || line.starts_with("  KEY:") || line.starts_with("  REL:")) continue;
        const bool event = std::sscanf(line.c_str(), " %u %3s %x %d", &node, type, &code, &value) == 4 && !events.reports.empty();
        const std::string t = event ? type : "";
        bool understood = true;
        if (std::sscanf(line.c_str(), "report %u", &number) == 1) {
            understood = number == events.reports.size() && usage == 0;
            events.reports.emplace_back();
        } else if (line.starts_with("  ABS:")) {
            read_kernel_axes(line, events);
        } else if (line.starts_with("node ")) {
            ++events.nodes;
        } else if (t == "MSC" && code == 4 && usage == 0) {
            usage = static_cast<std::uint32_t>(value);
        } else if (t == "KEY") {
            events.reports.back().push_back(usage != 0 ? KernelEvent{EventType::key, usage, value}
                                                       : KernelEvent{EventType::key_without_usage, code, value});
            usage = 0;
        } else if (t == "REL" || t == "ABS") {
            events.reports.back().push_back({t == "REL" ? EventType::relative : EventType::absolute, code, value});
        } else {
            understood = false;
        }
        if (!understood) events.problems.push_back(line);
    }
    return events;
}

}  // namespace surefoot::input
