// `surefoot top`: the last seconds as a chart of slots, what is left and what is spent, causes, devices, threads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "rt/base/modes.hpp"
#include "tools/monitor/text.hpp"
#include "tools/monitor/view.hpp"

namespace surefoot::monitor {

namespace {

using nlohmann::json;

constexpr std::size_t chart_rows = 5, label_places = 9;

/// How much a total has grown a second; NaN where there is no earlier one, or the service was started anew.
double rate_of(const json& s, const json& before, double between_s, const char* pointer) {
    const double now = number_at(s, pointer), then = number_at(before, pointer);
    return between_s > 0 && now >= then ? (now - then) / between_s : std::nan("");
}

std::string rate_text(double rate) { return std::isnan(rate) ? "-" : fmt::format("{:.{}f}", rate, rate < 9.95 ? 1 : 0); }

/// The texts of a list, between commas.
std::string joined_at(const json& s, const char* pointer) {
    std::string out;
    const json::json_pointer at(pointer);
    if (!s.contains(at) || !s.at(at).is_array()) return out;
    for (const json& text : s.at(at))
        if (text.is_string()) out += (out.empty() ? "" : ", ") + text.get<std::string>();
    return out;
}

/// `left` and `right` at the two ends of the line.
std::string spread(const std::string& left, const std::string& right, std::size_t width) {
    const std::size_t used = places(left) + places(right);
    return used + 2 <= width ? left + std::string(width - used, ' ') + right : left;
}

void add_title(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    const std::string state = text_at(s, "/state");
    const double age = number_at(s, "/last_frame_age_s");
    const bool stalled = state == "walking" && age > 2;
    const std::string what = text_at(s, "/walk/model");
    std::string left = inked(style, Ink::bold, what.empty() ? "surefoot" : what.substr(what.rfind('/') + 1));
    if (!what.empty())
        left += fmt::format("  {:.4g} Hz {}, {}, {}", number_at(s, "/walk/rate_hz"), text_at(s, "/walk/late"),
                            text_at(s, "/walk/selector"), text_at(s, "/walk/backend"));
    const std::string right = stalled ? inked(style, Ink::bad, fmt::format("no frame for {:.0f} s", age))
                                      : inked(style, state == "walking" ? Ink::good : Ink::warn, state);
    lines.push_back(spread(left, right + "  up " + duration(number_at(s, "/up_s")), style.width));
}

void add_totals(const json& s, const json& before, double between_s, const TerminalStyle& style,
                std::vector<std::string>& lines) {
    const auto alarm = [&](const char* pointer) {
        const double value = number_at(s, pointer);
        return inked(style, value > 0 ? Ink::bad : Ink::plain, grouped(value));
    };
    const std::string left = fmt::format("frames {}  skipped {}  misses {} (own {})", grouped(number_at(s, "/totals/frames")),
                                         alarm("/totals/skipped"), alarm("/totals/misses"), alarm("/totals/own_misses"));
    lines.push_back(spread(left, rate_text(rate_of(s, before, between_s, "/totals/frames")) + " frames/s", style.width));
    std::string lacks;
    if (s.contains("degraded") && s["degraded"].is_array())
        for (const json& d : s["degraded"]) lacks += (lacks.empty() ? "" : ", ") + text_at(d, "/reason");
    if (!lacks.empty())
        lines.push_back(inked(style, Ink::warn, "not fully real-time: " + lacks + "  (surefoot status says more)"));
}

void add_chart(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    const double period_ms = number_at(s, "/walk/period_ms");
    if (!(period_ms > 0) || !(number_at(s, "/recent/frames") > 0)) {
        lines.push_back("no frames yet");
        return;
    }
    const auto ms = [&](const char* q) { return short_number(number_at(s, fmt::format("/recent/frame_ms/{}", q).c_str())); };
    lines.push_back(fmt::format("{}  p50 {}  p99 {}  max {} ms, last {:.0f} s", inked(style, Ink::bold, "frame time"), ms("p50"),
                                ms("p99"), ms("max"), number_at(s, "/recent/seconds")));
    const std::size_t columns = style.width > label_places + 10 ? style.width - label_places : 10;
    const auto chart = frame_chart(s["recent"]["frame_ms_skipped_missed"], period_ms, style, columns, chart_rows);
    for (std::size_t i = 0; i < chart.size(); ++i) {
        // The second line from above ends at the deadline.
        std::string label(label_places, ' ');
        if (i == 1) label = fmt::format("{:>5} ms ", short_number(period_ms));
        if (i == 3) label = fmt::format("{:>5} ms ", short_number(period_ms / 2));
        lines.push_back(inked(style, Ink::dim, label) + chart[i]);
    }
}

std::string guarantee_line(const json& s, const TerminalStyle& style, double guaranteed) {
    const std::string now = text_at(s, "/now/guarantee");
    const Ink ink = now == rt::name_of(rt::Guarantee::kept) ? Ink::good : Ink::bad;
    const double reached = number_at(s, "/now/reached_accuracy"), node = number_at(s, "/now/binding_node");
    return fmt::format(
        "guaranteed {} /rad: {}, {}; {} frames without it", short_number(guaranteed), inked(style, ink, now),
        std::isnan(reached) ? "all is exact" : fmt::format("reached {} by node {:.0f}", short_number(reached), node),
        grouped(number_at(s, "/totals/broken_guarantees")));
}

/// The image cache: what the newest frame shows, and what is made and lost a second.
void add_pictures(const json& s, const json& before, double between_s, std::vector<std::string>& lines) {
    if (!flag_at(s, "/walk/cache") || !(number_at(s, "/recent/frames") > 0)) return;
    lines.push_back(fmt::format("pictures {} shown, {} of them reused; {} boxes as triangles; {}",
                                grouped(number_at(s, "/now/pictures/shown")), grouped(number_at(s, "/now/pictures/reused")),
                                grouped(number_at(s, "/now/pictures/boxes_as_triangles")),
                                mebibytes(number_at(s, "/now/pictures/bytes"))));
    const auto rate = [&](const char* pointer) { return rate_of(s, before, between_s, pointer); };
    const double per_frame_ms = rate("/totals/captures_ms") / rate("/totals/frames");
    lines.push_back(fmt::format(
        "  a second: {} made, in {} ms a frame; {} items in place of failed ones", rate_text(rate("/totals/pictures_made")),
        std::isfinite(per_frame_ms) ? short_number(per_frame_ms) : "-", rate_text(rate("/totals/uncovered_items"))));
}

void add_gauges(const json& s, const TerminalStyle& style, std::vector<std::string>& lines) {
    if (!(number_at(s, "/recent/frames") > 0)) return;
    const double period_ms = number_at(s, "/walk/period_ms");
    const std::size_t width = std::clamp<std::size_t>(style.width > 60 ? style.width - 52 : 8, 8, 40);
    const double slack = number_at(s, "/recent/slack_ms/p50"), min_slack = number_at(s, "/recent/slack_ms/min");
    lines.push_back(fmt::format("slack    {} {:>6} ms   least {}", share_bar(style, slack / period_ms, width),
                                short_number(slack),
                                inked(style, min_slack < 0 ? Ink::bad : Ink::plain, short_number(min_slack) + " ms")));
    const double used = number_at(s, "/recent/budget_used/mean");
    lines.push_back(fmt::format("used     {} {:>6.0f} %    p99 {:.0f} % of the period", share_bar(style, used, width), 100 * used,
                                100 * number_at(s, "/recent/budget_used/p99")));
    const double accuracy = number_at(s, "/recent/accuracy/mean");
    lines.push_back(std::isnan(accuracy) ? fmt::format("accuracy exact, {} triangles", grouped(number_at(s, "/now/triangles")))
                                         : fmt::format("accuracy {} /rad, least {}, {} triangles", short_number(accuracy),
                                                       short_number(number_at(s, "/recent/accuracy/min")),
                                                       grouped(number_at(s, "/now/triangles"))));
    if (const std::string value = value_text(s); !value.empty()) lines.push_back("value    " + value);
    if (const double guaranteed = number_at(s, "/now/guaranteed_accuracy"); guaranteed > 0)
        lines.push_back(guarantee_line(s, style, guaranteed));
    if (flag_at(s, "/now/at_rest"))
        lines.push_back(number_at(s, "/now/rest_samples") > 0
                            ? fmt::format("at rest  full detail, {:.0f} samples", number_at(s, "/now/rest_samples"))
                            : std::string("at rest  full detail is being drawn"));
    const double drawn = number_at(s, "/recent/resolution/min");
    if (drawn < 1)
        lines.push_back(fmt::format("resolution {:.1f} % of the sides, least {:.1f} %",
                                    100 * number_at(s, "/recent/resolution/mean"), 100 * drawn));
    if (number_at(s, "/totals/trilinear_frames") > 0)
        lines.push_back(fmt::format("filter   {}, {} frames with two mip levels", text_at(s, "/now/filter"),
                                    grouped(number_at(s, "/totals/trilinear_frames"))));
    if (const std::string dropped = joined_at(s, "/now/dropped_parts"); !dropped.empty())
        lines.push_back("no time for " + dropped);
    if (number_at(s, "/now/samples") > 1) lines.push_back(fmt::format("samples {:.0f} a pixel", number_at(s, "/now/samples")));
}

void add_events(const json& s, const json& before, double between_s, const TerminalStyle& style,
                std::vector<std::string>& lines) {
    const auto rate = [&](const char* pointer) { return rate_text(rate_of(s, before, between_s, pointer)); };
    lines.push_back(fmt::format("a second: {} switches, {} downgrades, {} faults (driver {}), {} reports",
                                rate("/totals/switches"), rate("/totals/downgrades"), rate("/totals/page_faults"),
                                rate("/totals/driver_faults"), rate("/totals/input_reports")));
    const std::string causes = causes_text(s["totals"]["miss_causes"]);
    lines.push_back("misses   " + (causes.empty() ? inked(style, Ink::good, "none") : inked(style, Ink::bad, causes)));
    if (flag_at(s, "/input/emergency_stop"))
        lines.push_back(inked(style, Ink::bad, "EMERGENCY STOP: the walk stands still"));
    else if (flag_at(s, "/now/standing_still"))
        lines.push_back(inked(style, Ink::warn, "the walk stands still: stop or dead-man"));
    if (const std::string barrier = text_at(s, "/input/barrier_text"); !barrier.empty())
        lines.push_back(inked(style, Ink::warn, "the visitor stands: " + barrier));
    const std::string note = s.contains("notes") && !s["notes"].empty() ? text_at(s["notes"].back(), "/text") : "";
    if (flag_at(s, "/input/live"))
        lines.push_back(
            fmt::format("devices  {} steer{}{}", grouped(number_at(s, "/input/devices")), note.empty() ? "" : "; ", note));
    else if (!note.empty())
        lines.push_back("note     " + note);
    lines.push_back(fmt::format("process  memory {}, {} descriptors, {} threads, host stole {} ms/s",
                                mebibytes(number_at(s, "/process/rss_bytes")), grouped(number_at(s, "/process/descriptors")),
                                grouped(number_at(s, "/process/threads")),
                                rate_text(1e3 * rate_of(s, before, between_s, "/process/host_steal_s"))));
}

struct ThreadLine {
    std::string name, policy, cores;
    double priority = 0, share = 0;
};

/// By the CPU time that they took since `before`, most first.
std::vector<ThreadLine> thread_lines(const json& s, const json& before, double between_s) {
    std::map<double, double> spent;
    if (before.contains("threads"))
        for (const json& t : before["threads"]) spent[number_at(t, "/tid")] = number_at(t, "/cpu_s");
    std::vector<ThreadLine> all;
    if (!s.contains("threads") || !s["threads"].is_array()) return all;
    for (const json& t : s["threads"]) {
        const auto then = spent.find(number_at(t, "/tid"));
        const double share =
            then != spent.end() && between_s > 0 ? (number_at(t, "/cpu_s") - then->second) / between_s : std::nan("");
        all.push_back({text_at(t, "/name"), text_at(t, "/policy"), text_at(t, "/cores"), number_at(t, "/priority"), share});
    }
    std::stable_sort(all.begin(), all.end(), [](const ThreadLine& a, const ThreadLine& b) {
        return (std::isnan(a.share) ? 0 : a.share) > (std::isnan(b.share) ? 0 : b.share);
    });
    return all;
}

void add_threads(const json& s, const json& before, double between_s, const TerminalStyle& style,
                 std::vector<std::string>& lines) {
    if (lines.size() + 3 > style.height) return;
    const auto all = thread_lines(s, before, between_s);
    const report::Columns columns({{"thread", 16}, {"policy", 12}, {"prio", -4}, {"cores", 10, 2}, {"CPU %", -6}});
    lines.push_back(inked(style, Ink::dim, columns.heading()));
    for (const ThreadLine& t : all) {
        if (lines.size() + 2 > style.height) break;
        lines.push_back(columns.row(
            {t.name, t.policy, grouped(t.priority), t.cores, std::isnan(t.share) ? "-" : fmt::format("{:.1f}", 100 * t.share)}));
    }
}

}  // namespace

std::vector<std::string> top_page(const json& status, const json& before, double between_s, const TerminalStyle& style) {
    std::vector<std::string> lines;
    add_title(status, style, lines);
    add_totals(status, before, between_s, style, lines);
    lines.emplace_back();
    add_chart(status, style, lines);
    add_gauges(status, style, lines);
    add_pictures(status, before, between_s, lines);
    add_events(status, before, between_s, style, lines);
    if (lines.size() + 4 <= style.height) lines.emplace_back();
    add_threads(status, before, between_s, style, lines);
    if (lines.size() >= style.height) lines.resize(style.height - 1);
    lines.push_back(inked(style, Ink::dim, "q: quit"));
    for (std::string& line : lines) line = cut_to(line, style.width);
    return lines;
}

std::string top_line(const json& s, const json& before, double between_s) {
    const double age = number_at(s, "/last_frame_age_s"), accuracy = number_at(s, "/recent/accuracy/mean");
    std::string line =
        fmt::format("{} {} frames/s, {} skipped, {} misses ({} own)", text_at(s, "/state"),
                    rate_text(rate_of(s, before, between_s, "/totals/frames")), grouped(number_at(s, "/totals/skipped")),
                    grouped(number_at(s, "/totals/misses")), grouped(number_at(s, "/totals/own_misses")));
    if (age > 2) line += fmt::format(", no frame for {:.0f} s", age);
    if (!(number_at(s, "/recent/frames") > 0)) return line;
    return line +
           fmt::format(", frame p50 {} p99 {} max {} ms, least slack {} ms, used {:.0f} %, accuracy {}",
                       short_number(number_at(s, "/recent/frame_ms/p50")), short_number(number_at(s, "/recent/frame_ms/p99")),
                       short_number(number_at(s, "/recent/frame_ms/max")), short_number(number_at(s, "/recent/slack_ms/min")),
                       100 * number_at(s, "/recent/budget_used/mean"), std::isnan(accuracy) ? "exact" : short_number(accuracy));
}

}  // namespace surefoot::monitor
