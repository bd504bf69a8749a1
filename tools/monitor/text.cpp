// Words and the frame chart.
#include "tools/monitor/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace surefoot::monitor {

namespace {

using nlohmann::json;

const json* find_at(const json& j, const char* pointer) {
    const json::json_pointer at(pointer);
    return j.contains(at) ? &j.at(at) : nullptr;
}

struct Column {
    double ms = 0;
    bool missed = false, skipped = false;
};

/// A column a slot, the last `most` of them.
std::vector<Column> columns_of(const json& frames, std::size_t max_columns) {
    std::vector<Column> columns;
    if (!frames.is_array()) return columns;
    for (const json& f : frames) {
        if (!f.is_array() || f.size() != 3 || !f[0].is_number() || !f[1].is_number_unsigned() || !f[2].is_boolean()) continue;
        const auto gap = std::min<std::uint64_t>(f[1].get<std::uint64_t>(), max_columns);
        for (std::uint64_t i = 0; i < gap; ++i) columns.push_back({0, false, true});
        columns.push_back({f[0].get<double>(), f[2].get<bool>(), false});
    }
    if (columns.size() > max_columns) columns.erase(columns.begin(), columns.end() - static_cast<std::ptrdiff_t>(max_columns));
    return columns;
}

}  // namespace

double number_at(const json& j, const char* pointer) {
    const json* found = find_at(j, pointer);
    return found != nullptr && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string text_at(const json& j, const char* pointer) {
    const json* found = find_at(j, pointer);
    return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

bool flag_at(const json& j, const char* pointer) {
    const json* found = find_at(j, pointer);
    return found != nullptr && found->is_boolean() && found->get<bool>();
}

std::string grouped(double whole) {
    if (!std::isfinite(whole)) return "-";
    std::string digits = fmt::format("{:.0f}", std::abs(whole));
    for (std::ptrdiff_t at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ' ');
    return (whole < 0 ? "-" : "") + digits;
}

std::string short_number(double value) {
    if (!std::isfinite(value)) return "-";
    const double size = std::abs(value);
    if (size >= 1000) return grouped(value);
    if (size >= 100) return fmt::format("{:.0f}", value);
    if (size >= 10) return fmt::format("{:.1f}", value);
    return fmt::format("{:.2f}", value);
}

std::string duration(double seconds) {
    if (!std::isfinite(seconds)) return "-";
    const auto s = static_cast<std::int64_t>(seconds);
    const std::string clock = fmt::format("{}:{:02}:{:02}", s / 3600 % 24, s / 60 % 60, s % 60);
    return s >= 86400 ? fmt::format("{} d {}", s / 86400, clock) : clock;
}

std::string mebibytes(double bytes) { return std::isfinite(bytes) ? fmt::format("{:.0f} MiB", bytes / 1048576.0) : "-"; }

std::string value_text(const nlohmann::json& status) {
    const double value = number_at(status, "/now/value"), more = number_at(status, "/now/one_more_ms_value");
    if (std::isnan(value)) return {};
    std::string text = fmt::format("{:.2f} % of full detail", 100 * value);
    if (more > 0) text += fmt::format(", one more millisecond would add {:.2f} %", 100 * more);
    return text;
}

std::string causes_text(const json& causes) {
    std::string text;
    if (!causes.is_object()) return text;
    for (const auto& [cause, count] : causes.items())
        if (count.is_number()) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", cause, grouped(count.get<double>()));
    return text;
}

std::vector<std::string> frame_chart(const json& frames, double period_ms, const TerminalStyle& style, std::size_t columns,
                                     std::size_t rows) {
    constexpr std::array<std::string_view, 9> blocks = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    constexpr std::array<std::string_view, 9> plain = {" ", ".", ".", ":", ":", "|", "|", "#", "#"};
    const std::vector<Column> slots = columns_of(frames, columns);
    std::vector<std::string> lines;
    const double row_ms = period_ms / static_cast<double>(rows - 1);
    for (std::size_t row = rows; row-- > 0;) {
        std::string line(columns - slots.size(), ' ');
        for (const Column& c : slots) {
            if (c.skipped) {
                line += row == 0 ? inked(style, Ink::bad, style.unicode ? "×" : "x") : " ";
                continue;
            }
            const double filled = std::clamp(c.ms / row_ms - static_cast<double>(row), 0.0, 1.0);
            const auto eighths = static_cast<std::size_t>(std::lround(filled * 8));
            const std::string_view block =
                (style.unicode ? blocks : plain)[row == 0 ? std::max<std::size_t>(eighths, 1) : eighths];
            line += c.missed && eighths > 0 ? inked(style, Ink::bad, block) : std::string(block);
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace surefoot::monitor
