// The walk's charts: which figures go into which, and how they are read.
#include "tools/report/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/report/svg.hpp"
#include "tools/report/times.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {

namespace {

using rt::FrameRecord;

constexpr double small_width = 470;
constexpr double small_height = 210;

template <class Value>
TimeChart over_time(const WalkFrames& walk, std::string label, std::string unit, Value value) {
    TimeChart chart;
    chart.label = std::move(label);
    chart.unit = std::move(unit);
    chart.time_s.reserve(walk.frames.size());
    chart.value.reserve(walk.frames.size());
    for (const FrameRecord* f : walk.frames) {
        chart.time_s.push_back(walk.time_s(*f));
        chart.value.push_back(value(*f));
    }
    return chart;
}

double deadline_ms(const WalkFrames& walk) { return static_cast<double>(walk.period_ns) * 1e-6; }

/// One of the parts that are stacked.
struct StackedPart {
    std::string_view name;
    double (*value)(const FrameRecord&);
};

constexpr std::size_t max_stacked = 5;

/// Means of parts over time, one upon the other. top: of the axis; 0: from the values.
std::string stacked_chart(const WalkFrames& walk, std::string_view label, std::string_view unit,
                          std::span<const StackedPart> parts, std::string_view css, double top) {
    const PlotArea area{52, 24, small_width - 10, 250 - 28};
    constexpr std::size_t columns = 102;
    std::vector<std::array<double, max_stacked>> means(columns);
    std::vector<double> counts(columns);
    const double end_s = walk.frames.empty() ? 1 : std::max(1e-3, walk.time_s(*walk.frames.back()));
    for (const FrameRecord* f : walk.frames) {
        const auto column = std::min(columns - 1, static_cast<std::size_t>(std::max(0.0, walk.time_s(*f) / end_s * columns)));
        for (std::size_t p = 0; p < parts.size(); ++p) means[column][p] += std::max(0.0, parts[p].value(*f));
        counts[column] += 1;
    }
    double highest = 0;
    for (std::size_t c = 0; c < columns; ++c) {
        double sum = 0;
        for (double& mean : means[c]) {
            mean /= std::max(1.0, counts[c]);
            sum += mean;
        }
        highest = std::max(highest, sum);
    }
    const Scale x{0, end_s, area.left, area.right, false};
    const Scale y{0, nice_ceiling(top > 0 ? top : std::max(1.0, highest * 1.02)), area.bottom, area.top, false};
    std::string out = open_chart(small_width, 250, label);
    out += y_axis(area, y, nice_ticks(0, y.to, 4), unit) + x_axis(area, x, nice_ticks(0, end_s, 5), "s");
    const double step = (area.right - area.left) / columns;
    for (std::size_t c = 0; c < columns; ++c) {
        double sum = 0;
        for (const double mean : means[c]) sum += mean;
        // From the last part to the first, each down to the axis: no seams between them.
        for (std::size_t p = parts.size(); p-- > 0;) {
            const double mean = means[c][p], high = y(std::min(sum, y.to));
            sum -= mean;
            if (mean <= 0) continue;
            out += fmt::format(
                "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"stack {}{}\"><title>{}: {:.2f} "
                "{}</title></rect>",
                area.left + step * static_cast<double>(c), high, step + 0.2, std::max(0.0, area.bottom - high), css, p,
                parts[p].name, mean, unit);
        }
    }
    if (top > 0) out += line_between(area.left, y(deadline_ms(walk)), area.right, y(deadline_ms(walk)), "deadline");
    return out + close_chart();
}

}  // namespace

std::string frame_time_chart(const WalkFrames& walk, double budget_ms) {
    auto chart = over_time(walk, "Frame time", "ms", frame_ms);
    const double deadline = deadline_ms(walk);
    chart.lines = {{deadline, fmt::format("deadline {:.1f} ms", deadline), "deadline"}};
    if (budget_ms > 0 && budget_ms < deadline)
        chart.lines.push_back({budget_ms, fmt::format("budget {:.1f} ms", budget_ms), "budget"});
    chart.snapshots_s = walk.snapshots_s;
    for (const FrameRecord* f : walk.frames)
        if (f->missed)
            chart.markers.push_back({walk.time_s(*f), frame_ms(*f),
                                     fmt::format("frame {}: {:.1f} ms, {}{}", f->frame, frame_ms(*f), rt::cause_of(*f),
                                                 f->own_miss ? "" : " (not its own doing)")});
    // One long stall must not flatten the rest: what is above the axis is marked at its top.
    auto values = chart.value;
    const double highest = quantiles(std::move(values)).max;
    chart.top = nice_ceiling(std::clamp(highest * 1.05, deadline * 1.2, deadline * 2.5));
    chart.height = 300;
    return time_chart(chart);
}

std::string frame_histogram(const WalkFrames& walk, double budget_ms) {
    const double deadline = deadline_ms(walk);
    const PlotArea area{44, 24, small_width - 10, 250 - 28};
    const double top = deadline * 1.5;
    constexpr std::size_t bins = 75;  // 50 of them before the deadline
    std::array<std::uint64_t, bins + 1> counts{};
    for (const FrameRecord* f : walk.frames)
        ++counts[std::min(bins, static_cast<std::size_t>(std::max(0.0, frame_ms(*f) / top * static_cast<double>(bins))))];
    const double max_count = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
    const Scale x{0, top, area.left, area.right, false};
    const Scale y{0.5, std::max(10.0, max_count * 1.3), area.bottom, area.top, true};

    std::string out = open_chart(small_width, 250, "Frame times: how many frames took how long");
    out += y_axis(area, y, log_ticks(1, y.to), "frames");
    out += x_axis(area, x, nice_ticks(0, top, 6), "ms");
    const double step = (area.right - area.left) / static_cast<double>(bins + 1);
    for (std::size_t i = 0; i <= bins; ++i) {
        if (counts[i] == 0) continue;
        const double from = top * static_cast<double>(i) / bins;
        const double at = area.left + step * static_cast<double>(i);
        const double height = area.bottom - y(static_cast<double>(counts[i]));
        const std::string what =
            i == bins ? fmt::format("over {:.1f} ms", top) : fmt::format("{:.1f}–{:.1f} ms", from, from + top / bins);
        out += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"bar{}\"><title>{}: {} "
            "frames</title></rect>",
            at + 0.5, area.bottom - height, step - 1, height, from >= deadline ? " late" : "", what, counts[i]);
    }
    const auto mark = [&](double value, std::string_view css, std::string_view text, bool left) {
        out += line_between(x(value), area.top - 4, x(value), area.bottom, css);
        out += text_at(x(value) + (left ? -5 : 5), area.top + 4, fmt::format("note {} {}-text", left ? "end" : "", css), text);
    };
    mark(deadline, "deadline", "deadline", false);
    if (budget_ms > 0 && budget_ms < deadline) mark(budget_ms, "budget", "budget", true);
    return out + close_chart();
}

std::string phases_chart(const WalkFrames& walk) {
    constexpr std::array<StackedPart, 5> phases = {{{"wake", [](const FrameRecord& f) { return wake_us(f) * 1e-3; }},
                                                    {"select", [](const FrameRecord& f) { return select_us(f) * 1e-3; }},
                                                    {"submit", [](const FrameRecord& f) { return submit_us(f) * 1e-3; }},
                                                    {"raster", [](const FrameRecord& f) { return raster_us(f) * 1e-3; }},
                                                    {"present", [](const FrameRecord& f) { return present_us(f) * 1e-3; }}}};
    return stacked_chart(walk, "Where the time of a frame goes: mean of each phase", "ms", phases, "p", deadline_ms(walk) * 1.04);
}

std::string cache_chart(const WalkFrames& walk) {
    constexpr std::array<StackedPart, 3> uses = {
        {{"made", [](const FrameRecord& f) { return static_cast<double>(f.pictures_made); }},
         {"reused", [](const FrameRecord& f) { return static_cast<double>(f.pictures_reused); }},
         {"as triangles", [](const FrameRecord& f) { return static_cast<double>(f.boxes_as_triangles); }}}};
    return stacked_chart(walk, "What the image cache does: mean boxes of a frame", "boxes", uses, "u", 0);
}

std::string budget_chart(const WalkFrames& walk) {
    auto chart = over_time(walk, "Share of the budget spent", "%", [](const FrameRecord& f) { return 100 * share_of_budget(f); });
    chart.lines = {{100, "budget", "budget"}};
    auto values = chart.value;
    chart.top = nice_ceiling(std::clamp(quantiles(std::move(values)).p999 * 1.05, 110.0, 200.0));
    chart.width = small_width;
    chart.height = small_height;
    return time_chart(chart);
}

std::string wake_chart(const WalkFrames& walk) {
    auto chart = over_time(walk, "Woken after it was due", "µs", [](const FrameRecord& f) { return std::max(1.0, wake_us(f)); });
    chart.log = true;
    chart.width = small_width;
    chart.height = small_height;
    return time_chart(chart);
}

std::string accuracy_chart_over_time(const WalkFrames& walk) {
    auto chart = over_time(walk, "Accuracy", "rad⁻¹", [](const FrameRecord& f) { return double{f.accuracy}; });
    chart.width = small_width;
    chart.height = small_height;
    chart.log = true;
    chart.snapshots_s = walk.snapshots_s;
    return time_chart(chart);
}

std::string triangles_chart(const WalkFrames& walk, std::uint64_t model_triangles) {
    auto chart = over_time(walk, "Triangles drawn", "", [](const FrameRecord& f) { return static_cast<double>(f.triangles); });
    double max_value = 0;
    for (const double v : chart.value) max_value = std::max(max_value, v);
    const double model = static_cast<double>(model_triangles);
    if (model > 0 && model < max_value * 4) chart.lines = {{model, "the whole model", "budget"}};
    chart.width = small_width;
    chart.height = small_height;
    chart.snapshots_s = walk.snapshots_s;
    return time_chart(chart);
}

std::string switches_chart(const WalkFrames& walk) {
    auto chart = over_time(walk, "Switches", "", [](const FrameRecord& f) { return static_cast<double>(f.switches); });
    chart.width = small_width;
    chart.height = 250;
    return time_chart(chart);
}

std::string cause_chart(const WalkSummary& s) {
    std::vector<std::pair<std::string, std::uint64_t>> causes(s.miss_causes.begin(), s.miss_causes.end());
    std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    const double height = 14 + 30 * static_cast<double>(causes.size());
    const double max_count = causes.empty() ? 1 : static_cast<double>(causes.front().second);
    std::string out = open_chart(small_width, height, "Misses by cause");
    for (std::size_t i = 0; i < causes.size(); ++i) {
        const double at = 8 + 30 * static_cast<double>(i);
        const double length = 270 * static_cast<double>(causes[i].second) / max_count;
        out += text_at(124, at + 15, "end", causes[i].first);
        out += fmt::format("<rect x=\"134\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"20\" rx=\"3\" class=\"bar late\"/>", at,
                           std::max(2.0, length));
        out += text_at(142 + std::max(2.0, length), at + 15, "strong", std::to_string(causes[i].second));
    }
    return out + close_chart();
}

std::string control_chart(const ControlSummary& control) {
    const PlotArea area{52, 24, 950, 130};
    double max_misses = 1;
    for (const ControlBlock& b : control.blocks) max_misses = std::max(max_misses, static_cast<double>(b.misses));
    const Scale y{0, nice_ceiling(max_misses), area.bottom, area.top, false};
    std::string out = open_chart(960, 150, "Misses in each block of the walk and of the bare loop");
    std::vector<double> ticks = nice_ticks(0, y.to, 3);
    std::erase_if(ticks, [](double t) { return t != std::floor(t); });
    out += y_axis(area, y, ticks, "misses");
    const double step = (area.right - area.left) / static_cast<double>(std::max<std::size_t>(1, control.blocks.size()));
    for (std::size_t i = 0; i < control.blocks.size(); ++i) {
        const ControlBlock& b = control.blocks[i];
        const double at = area.left + step * static_cast<double>(i);
        const double width = std::max(0.6, step * 0.8);
        const double high = b.misses == 0 ? area.bottom - 1.5 : y(b.misses);
        out += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"bar{}\"><title>block {}, {}: {} of {} "
            "frames missed, {} "
            "its own, {:.1f} ms stolen</title></rect>",
            at, high, width, area.bottom - high, b.walk ? "" : " other", i + 1, b.walk ? "walk" : "bare loop", b.misses, b.frames,
            b.own_misses, b.steal_ms);
    }
    out += line_between(area.left, area.bottom, area.right, area.bottom, "axis");
    return out + close_chart();
}

}  // namespace surefoot::report
