// Frames from which a host took the core, as the loop recorded them: written by bench_stolen_frames, read by bench_blame and by
// the tests of the classifier. CSV, a column a field that the classifier looks at, and what the kernel's steal clock said
// meanwhile.
#pragma once

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/base/result.hpp"
#include "rt/frame/record.hpp"

namespace surefoot::bench {

constexpr std::string_view stolen_header =
    "deadline_ns,woken_ns,selected_ns,submitted_ns,rastered_ns,presented_ns,cpu_ns,stolen_ns,voluntary,involuntary,minor_faults,"
    "steal_ms";

/// Times from the frame's due time on.
inline std::string stolen_row(const rt::FrameRecord& r, double steal_ms) {
    const auto since = [&](std::int64_t ns) { return ns - r.due_ns; };
    return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.0f}\n", since(r.deadline_ns), since(r.woken_ns), since(r.selected_ns),
                       since(r.submitted_ns), since(r.rastered_ns), since(r.complete_ns), r.cpu_ns, r.stolen_ns, r.voluntary,
                       r.involuntary, r.minor_faults, steal_ms);
}

inline Result<std::vector<rt::FrameRecord>> read_stolen_frames(const std::string& file) {
    auto text = read_text(file);
    if (!text) return text.error();
    std::vector<rt::FrameRecord> records;
    std::string_view rest = *text;
    std::size_t line_number = 0;
    while (!rest.empty()) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        if (++line_number == 1 || line.empty()) continue;
        std::array<std::int64_t, 12> v{};
        const char* at = line.data();
        const char* const end = line.data() + line.size();
        for (std::size_t i = 0; i < v.size(); ++i) {
            const auto [next, error] = std::from_chars(at, end, v[i]);
            if (error != std::errc{} || (i + 1 < v.size() && (next == end || *next != ',')))
                return Error{fmt::format("{}:{}", file, line_number), "is not a row of twelve whole numbers", "record it anew"};
            at = next + 1;
        }
        rt::FrameRecord r;
        r.deadline_ns = v[0], r.woken_ns = v[1], r.selected_ns = v[2], r.submitted_ns = v[3], r.rastered_ns = v[4];
        r.complete_ns = v[5], r.cpu_ns = v[6], r.stolen_ns = v[7];
        r.voluntary = static_cast<std::uint32_t>(v[8]), r.involuntary = static_cast<std::uint32_t>(v[9]);
        r.minor_faults = static_cast<std::uint32_t>(v[10]);
        r.core_steal_ns = v[11] * 1'000'000;
        r.prepared_age = 1;
        r.missed = r.complete_ns > r.deadline_ns;
        records.push_back(r);
    }
    return records;
}

}  // namespace surefoot::bench
