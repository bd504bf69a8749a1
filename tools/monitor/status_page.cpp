// `surefoot status`: what runs, whether it is real-time, what was missed and why, how long things take.
#include <fmt/format.h>

#include <cmath>

#include "tools/monitor/text.hpp"
#include "tools/monitor/view.hpp"

namespace surefoot::monitor {

namespace {

using nlohmann::json;

struct TimeRow {
    const char* label;
    const char* series;
    const char* unit;
};
constexpr TimeRow time_rows[] = {{"frame", "frame_ms", "ms"},
                                 {"  wake-up", "wake_us", "us"},
                                 {"  select", "select_us", "us"},
                                 {"  submit", "submit_ms", "ms"},
                                 {"  raster", "raster_ms", "ms"},
                                 {"  present", "present_ms", "ms"},
                                 {"prepare (CPU)", "prepare_cpu_us", "us"},
                                 {"late by", "lateness_ms", "ms"},
                                 {"frame interval", "shown_interval_ms", "ms"},
                                 {"off the grid", "shown_error_us", "us"},
                                 {"animation error", "animation_error_ms", "ms"},
                                 {"input age", "input_age_ms", "ms"},
                                 {"input to shown", "input_to_shown_ms", "ms"}};

void add_head(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    const std::string state = text_at(s, "/state");
    const Ink ink = state == "walking" ? Ink::good : state == "failed" ? Ink::bad : Ink::warn;
    lines.push_back(fmt::format("surefoot {}, pid {}, up {}: {}", text_at(s, "/version"), number_at(s, "/pid"),
                                duration(number_at(s, "/up_s")), inked(style, ink, state)));
    if (const double age = number_at(s, "/last_frame_age_s"); state == "walking" && age > 2)
        lines.push_back(inked(style, Ink::bad, fmt::format("no frame for {:.1f} s", age)));
    if (!s.contains("walk") || !s["walk"].is_object()) return;
    lines.push_back(
        fmt::format("{} along {}, by {}", text_at(s, "/walk/model"), text_at(s, "/walk/path"), text_at(s, "/walk/selector")));
    lines.push_back(fmt::format("{:.4g} Hz ({} ms), late frames: {}, {} on {}", number_at(s, "/walk/rate_hz"),
                                short_number(number_at(s, "/walk/period_ms")), text_at(s, "/walk/late"),
                                text_at(s, "/walk/backend"), text_at(s, "/walk/renderer")));
}

void add_lacks(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    if (!s.contains("degraded") || s["degraded"].empty()) {
        if (s.contains("walk") && s["walk"].is_object()) lines.push_back(inked(style, Ink::good, "fully real-time"));
        return;
    }
    lines.push_back(inked(style, Ink::warn, "not fully real-time:"));
    for (const json& d : s["degraded"]) {
        lines.push_back("  " + text_at(d, "/what"));
        if (const std::string remedy = text_at(d, "/remedy"); !remedy.empty()) lines.push_back("    -> " + remedy);
    }
}

void add_counts(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    const double misses = number_at(s, "/totals/misses"), skipped = number_at(s, "/totals/skipped");
    const auto count = [&](double value, Ink if_any) { return inked(style, value > 0 ? if_any : Ink::plain, grouped(value)); };
    lines.push_back(fmt::format("{} slots: {} frames, {} skipped, {} misses ({} own)", grouped(number_at(s, "/totals/slots")),
                                grouped(number_at(s, "/totals/frames")), count(skipped, Ink::bad), count(misses, Ink::bad),
                                count(number_at(s, "/totals/own_misses"), Ink::bad)));
    if (misses > 0) lines.push_back("  by cause: " + causes_text(s["totals"]["miss_causes"]));
    if (const double lost = number_at(s, "/totals/lost"); lost > 0)
        lines.push_back(fmt::format("  the records of {} slots did not reach the monitor", grouped(lost)));
    lines.push_back(fmt::format("{} downgraded slices, {} switches, page faults {} (driver {}), {} guard violations",
                                grouped(number_at(s, "/totals/downgrades")), grouped(number_at(s, "/totals/switches")),
                                grouped(number_at(s, "/totals/page_faults")), grouped(number_at(s, "/totals/driver_faults")),
                                grouped(number_at(s, "/totals/guard_violations"))));
}

/// Checks that failed without ending the program: bugs to report.
void add_rare_checks(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    if (!s.contains("rare_checks") || !s["rare_checks"].is_array()) return;
    for (const json& c : s["rare_checks"])
        lines.push_back(inked(style, Ink::bad,
                              fmt::format("a check failed {} times: {} ({})", grouped(number_at(c, "/count")),
                                          text_at(c, "/sentence"), text_at(c, "/place"))));
}

void add_times(const json& s, std::vector<std::string>& lines) {
    const report::Columns columns(
        {{"since the start", 20}, {"p50", -10, 0}, {"p99", -10, 0}, {"p99.9", -10, 0}, {"max", -10, 0}});
    lines.push_back(columns.heading());
    for (const TimeRow& row : time_rows) {
        const auto at = [&](const char* q) {
            return short_number(number_at(s, fmt::format("/times/{}/{}", row.series, q).c_str()));
        };
        if (std::isnan(number_at(s, fmt::format("/times/{}/count", row.series).c_str()))) continue;
        lines.push_back(columns.row({row.label, at("p50"), at("p99"), at("p999"), at("max")}) + " " + row.unit);
    }
    if (const double low = number_at(s, "/times/one_percent_low_hz"); !std::isnan(low))
        lines.push_back(columns.row({"1 % low", short_number(low)}) + " Hz");
}

void add_recent(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    if (!(number_at(s, "/recent/frames") > 0)) return;
    const double misses = number_at(s, "/recent/misses"), skipped = number_at(s, "/recent/skipped");
    lines.push_back(fmt::format(
        "last {:.0f} s: {}, slack min {} ms, p50 {} ms, budget used {:.0f} %", number_at(s, "/recent/seconds"),
        misses + skipped > 0 ? inked(style, Ink::bad, fmt::format("{} missed, {} skipped", grouped(misses), grouped(skipped)))
                             : inked(style, Ink::good, "no misses"),
        short_number(number_at(s, "/recent/slack_ms/min")), short_number(number_at(s, "/recent/slack_ms/p50")),
        100 * number_at(s, "/recent/budget_used/mean")));
    const double accuracy = number_at(s, "/recent/accuracy/mean");
    lines.push_back(std::isnan(accuracy) ? "  accuracy: exact"
                                         : fmt::format("  accuracy {} /rad, min {}; {} triangles now", short_number(accuracy),
                                                       short_number(number_at(s, "/recent/accuracy/min")),
                                                       grouped(number_at(s, "/now/triangles"))));
    if (const std::string value = value_text(s); !value.empty()) lines.push_back("  value: " + value);
}

void add_input(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    if (flag_at(s, "/input/emergency_stop"))
        lines.push_back(inked(style, Ink::bad, "emergency stop: the walk stands still"));
    else if (flag_at(s, "/now/standing_still"))
        lines.push_back(inked(style, Ink::warn, "the walk stands still: stop or dead-man"));
    if (const std::string barrier = text_at(s, "/input/barrier_text"); !barrier.empty())
        lines.push_back(inked(style, Ink::warn, "the visitor stands: " + barrier));
    if (flag_at(s, "/input/live")) lines.push_back(fmt::format("steered by {} devices", grouped(number_at(s, "/input/devices"))));
    if (!s.contains("notes") || !s["notes"].is_array()) return;
    for (const json& n : s["notes"])
        lines.push_back(fmt::format("  {} ago: {}", duration(number_at(n, "/age_s")), text_at(n, "/text")));
}

void add_house(const json& s, std::vector<std::string>& lines) {
    const bool locked = number_at(s, "/process/locked_bytes") > 0;
    lines.push_back(fmt::format("memory {}{}, {} threads, {} descriptors, host stole {} s since boot",
                                mebibytes(number_at(s, "/process/rss_bytes")), locked ? ", locked" : "",
                                grouped(number_at(s, "/process/threads")), grouped(number_at(s, "/process/descriptors")),
                                short_number(number_at(s, "/process/host_steal_s"))));
    if (const double bursts = number_at(s, "/monitor/bursts"); bursts > 0)
        lines.push_back(fmt::format("{} bursts of misses: {} recorded, {} suppressed, {} failed", grouped(bursts),
                                    grouped(number_at(s, "/monitor/incidents/written")),
                                    grouped(number_at(s, "/monitor/incidents/suppressed")),
                                    grouped(number_at(s, "/monitor/incidents/failed"))));
}

}  // namespace

Result<json> parse_status(const Address& address, const std::string& text) {
    json status = json::parse(text, nullptr, false);
    if (status.is_object() && status.contains("totals") && status.contains("version")) return status;
    return Error{address.text(), "Something other than a surefoot monitor answers there",
                 "Name the monitor's address with --socket", ErrorKind::damaged};
}

std::vector<std::string> status_page(const json& status, const TerminalStyle& style) {
    std::vector<std::string> lines;
    add_head(status, style, lines);
    add_lacks(status, style, lines);
    lines.emplace_back();
    add_counts(status, style, lines);
    add_rare_checks(status, style, lines);
    add_recent(status, style, lines);
    add_input(status, style, lines);
    lines.emplace_back();
    add_times(status, lines);
    lines.emplace_back();
    add_house(status, lines);
    return lines;
}

}  // namespace surefoot::monitor
