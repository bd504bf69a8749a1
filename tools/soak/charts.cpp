// A soak's charts. Hours lie in a few hundred columns, each from its fastest to its slowest frame: no slow frame is averaged
// away.
#include "tools/soak/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/report/svg.hpp"

namespace surefoot::soak {

namespace {

constexpr double wide_px = 960, half_px = 470;
constexpr double strip_px = 17;

/// Seconds, minutes or hours: whichever gives figures that can be read.
struct TimeUnit {
    double s = 1;
    std::string_view name = "s";
};
TimeUnit unit_of(double seconds) {
    if (seconds > 3 * 3600) return {3600, "h"};
    if (seconds > 180) return {60, "min"};
    return {};
}

/// The time axis in its own unit; ticks come back in pixels through `x`, which is in seconds.
std::string time_axis(const report::PlotArea& area, const report::Scale& x, int about) {
    const TimeUnit unit = unit_of(x.to);
    const report::Scale in_units{x.from / unit.s, x.to / unit.s, x.low_px, x.high_px, false};
    return report::x_axis(area, in_units, report::nice_ticks(in_units.from, in_units.to, about), unit.name);
}

double length_of(const SoakSummary& s) { return std::max({s.ran_s, s.phases.empty() ? 0.0 : s.phases.back().to_s, 1e-3}); }

std::string frame_band(const SoakSummary& s, const report::Scale& x, const report::Scale& y) {
    std::string up, down;
    std::vector<report::Point> highest, mean;
    for (const SoakColumn& c : s.columns) {
        const double at = x(c.from_s + s.column_s / 2);
        const double high = y(std::min<double>(c.high_ms, y.to)), low = y(std::min<double>(c.low_ms, y.to));
        up += fmt::format("{}{:.1f} {:.1f}", up.empty() ? "M" : "L", at, high);
        down.insert(0, fmt::format("L{:.1f} {:.1f}", at, low));
        highest.push_back({at, high});
        mean.push_back({at, y(std::min<double>(c.mean_ms, y.to))});
    }
    return fmt::format("<path d=\"{}{}Z\" class=\"band\"/>", up, down) + report::polyline(highest, "peaks") +
           report::polyline(mean, "line");
}

std::string miss_marks(const SoakSummary& s, const report::Scale& x, const report::Scale& y) {
    std::string out;
    for (const SoakMiss& m : s.misses) {
        out += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" class=\"miss\"><title>{:.1f} s: {:.1f} ms, {}{}{}</title></circle>",
            x(m.time_s), y(std::min(m.frame_ms, y.to)), m.own ? 4.5 : 3.2, m.time_s, m.frame_ms, m.cause,
            m.own ? ", its own doing" : "", m.skipped > 0 ? fmt::format(", {} slots skipped", m.skipped) : "");
    }
    return out;
}

/// One row a kind of load, a bar where it was on.
std::string load_strips(const SoakSummary& s, const report::PlotArea& area, const report::Scale& x, double top) {
    std::string out;
    for (std::size_t row = 0; row < s.loads.size(); ++row) {
        const SoakLoad& load = s.loads[row];
        const double at = top + strip_px * static_cast<double>(row);
        out += report::text_at(area.left - 8, at + strip_px - 5, "tick end", load.name);
        out += report::line_between(area.left, at + strip_px - 0.5, area.right, at + strip_px - 0.5, "grid");
        for (const SoakPhase& p : s.phases) {
            if (std::find(p.loads.begin(), p.loads.end(), load.name) == p.loads.end() || p.from_s >= s.ran_s) continue;
            const double from = x(p.from_s), to = x(std::min(p.to_s, s.ran_s));
            out += fmt::format(
                "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"load l{}{}\"><title>{}, "
                "{:.0f}–{:.0f} s: "
                "{} of {} frames missed, {} of them own; slowest {:.1f} ms</title></rect>",
                from, at + 2, std::max(0.5, to - from), strip_px - 5, row % 8, load.ran ? "" : " idle",
                report::escaped(load.name), p.from_s, std::min(p.to_s, s.ran_s), p.misses, p.frames, p.own_misses,
                p.frame_ms_max);
        }
    }
    return out;
}

std::vector<SoakSample> thinned(const std::vector<SoakSample>& samples) {
    const std::size_t step = std::max<std::size_t>(1, samples.size() / 600);
    std::vector<SoakSample> kept;
    for (std::size_t i = 0; i < samples.size(); i += step) kept.push_back(samples[i]);
    return kept;
}

}  // namespace

std::string soak_time_chart(const SoakSummary& s) {
    const double strips = strip_px * static_cast<double>(s.loads.size());
    const report::PlotArea area{64, 24, wide_px - 10, 270};
    const double deadline_ms = s.walk.rate_hz > 0 ? 1000 / s.walk.rate_hz : 0;
    const double highest = s.walk.frame_ms.max;
    const report::Scale x{0, length_of(s), area.left, area.right, false};
    const report::Scale y{0, report::nice_ceiling(std::clamp(highest * 1.05, deadline_ms * 1.2, deadline_ms * 2.5)), area.bottom,
                          area.top, false};
    std::string out =
        report::open_chart(wide_px, area.bottom + 30 + strips + 6, "Frame times over the soak, and what loaded the machine when");
    out += report::y_axis(area, y, report::nice_ticks(0, y.to, 5), "ms") + time_axis(area, x, 10);
    out += frame_band(s, x, y);
    out += report::line_between(area.left, y(deadline_ms), area.right, y(deadline_ms), "deadline");
    out +=
        report::text_at(area.right, y(deadline_ms) - 6, "note end deadline-text", fmt::format("deadline {:.1f} ms", deadline_ms));
    out += miss_marks(s, x, y);
    return out + load_strips(s, area, x, area.bottom + 30) + report::close_chart();
}

std::string soak_memory_chart(const SoakSummary& s) {
    const report::PlotArea area{64, 24, half_px - 10, 182};
    const std::vector<SoakSample> samples = thinned(s.samples);
    double min_kib = 1e300, max_kib = 0;
    for (const SoakSample& p : samples) min_kib = std::min(min_kib, p.memory_kib), max_kib = std::max(max_kib, p.memory_kib);
    if (samples.empty()) min_kib = max_kib = 0;
    // A quarter of a MiB is the least that fills the chart: noise of single pages must not look like a mountain.
    const double room = std::max(256.0, (max_kib - min_kib) * 1.3), middle = (max_kib + min_kib) / 2;
    const report::Scale x{0, length_of(s), area.left, area.right, false};
    const report::Scale y{(middle - room / 2) / 1024, (middle + room / 2) / 1024, area.bottom, area.top, false};
    std::string out = report::open_chart(half_px, 210, "Memory over the soak, with its trend");
    for (const double tick : report::nice_ticks(y.from, y.to, 4)) {
        out += report::line_between(area.left, y(tick), area.right, y(tick), "grid");
        out += report::text_at(area.left - 8, y(tick) + 4, "tick end",
                               fmt::format("{:.{}f}", tick,
                                           room > 8 * 1024 ? 0
                                           : room > 1024   ? 1
                                                           : 2));
    }
    out += report::text_at(area.left - 8, area.top - 11, "unit end", "MiB") + time_axis(area, x, 5);
    std::vector<report::Point> line;
    line.reserve(samples.size());
    for (const SoakSample& p : samples) line.push_back({x(p.time_s), y(p.memory_kib / 1024)});
    out += report::polyline(line, "line");
    if (s.memory.known) {
        const auto trend_px = [&](double t) { return y((s.memory.at_s0 + s.memory.per_s * t) / 1024); };
        out += report::line_between(x(s.warm_up_s), trend_px(s.warm_up_s), x(s.ran_s), trend_px(s.ran_s), "budget");
        out += report::text_at(area.right, area.top + 2, "note end budget-text",
                               fmt::format("trend {:+.0f} KiB an hour", s.memory.per_s * 3600 + 0.0));
    }
    return out + report::close_chart();
}

std::string soak_count_chart(const SoakSummary& s) {
    const report::PlotArea area{64, 24, half_px - 10, 182};
    const std::vector<SoakSample> samples = thinned(s.samples);
    double max_count = 4;
    std::vector<report::Point> descriptors, threads;
    for (const SoakSample& p : samples) max_count = std::max({max_count, double{1.0 * p.descriptors}, double{1.0 * p.threads}});
    const report::Scale x{0, length_of(s), area.left, area.right, false};
    const report::Scale y{0, report::nice_ceiling(max_count * 1.15), area.bottom, area.top, false};
    for (const SoakSample& p : samples) {
        descriptors.push_back({x(p.time_s), y(p.descriptors)});
        threads.push_back({x(p.time_s), y(p.threads)});
    }
    std::string out = report::open_chart(half_px, 210, "Open descriptors and threads over the soak");
    out += report::y_axis(area, y, report::nice_ticks(0, y.to, 4), "") + time_axis(area, x, 5);
    out += report::polyline(descriptors, "line") + report::polyline(threads, "line second");
    if (!samples.empty()) {
        out += report::text_at(area.right, y(samples.back().descriptors) - 6, "note end", "descriptors");
        out += report::text_at(area.right, y(samples.back().threads) - 6, "note end", "threads");
    }
    return out + report::close_chart();
}

std::string soak_accuracy_chart(const SoakSummary& s) {
    const report::PlotArea area{64, 24, half_px - 10, 182};
    double min_accuracy = 1e300, max_accuracy = 0;
    for (const SoakColumn& c : s.columns) {
        if (c.accuracy_min <= 0) continue;
        min_accuracy = std::min<double>(min_accuracy, c.accuracy_min),
        max_accuracy = std::max<double>(max_accuracy, c.accuracy_min);
    }
    if (max_accuracy <= 0) min_accuracy = max_accuracy = 1;
    const report::Scale x{0, length_of(s), area.left, area.right, false};
    const double bottom = std::pow(10.0, std::floor(std::log10(min_accuracy))),
                 top = std::pow(10.0, std::ceil(std::log10(max_accuracy) + 1e-9));
    const report::Scale y{bottom, std::max(top, bottom * 10), area.bottom, area.top, true};
    std::string out = report::open_chart(half_px, 210, "Worst accuracy over the soak");
    out += report::y_axis(area, y, report::log_ticks(y.from, y.to), "rad⁻¹") + time_axis(area, x, 5);
    std::vector<report::Point> line;
    bool pen_up = true;
    for (const SoakColumn& c : s.columns) {
        if (c.accuracy_min > 0) line.push_back({x(c.from_s + s.column_s / 2), y(double{c.accuracy_min}), pen_up});
        pen_up = c.accuracy_min <= 0;
    }
    return out + report::polyline(line, "line") + report::close_chart();
}

std::string soak_load_chart(const SoakSummary& s) {
    struct Row {
        std::string name;
        std::uint64_t frames = 0, misses = 0, own = 0;
    };
    std::vector<Row> rows;
    for (const SoakLoad& load : s.loads) {
        Row row{load.name, 0, 0, 0};
        for (const SoakPhase& p : s.phases) {
            if (std::find(p.loads.begin(), p.loads.end(), load.name) == p.loads.end()) continue;
            row.frames += p.frames, row.misses += p.misses, row.own += p.own_misses;
        }
        if (load.ran && row.frames > 0) rows.push_back(row);
    }
    const auto rate = [](const Row& r) { return 1000.0 * static_cast<double>(r.misses) / static_cast<double>(r.frames); };
    double max_rate = 1;
    for (const Row& r : rows) max_rate = std::max(max_rate, rate(r));
    std::string out = report::open_chart(half_px, 14 + 26 * static_cast<double>(rows.size()), "Misses a thousand frames by load");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double at = 8 + 26 * static_cast<double>(i), length = std::max(2.0, 220 * rate(rows[i]) / max_rate);
        out += report::text_at(84, at + 13, "end", rows[i].name);
        out += fmt::format("<rect x=\"94\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"17\" rx=\"3\" class=\"bar{}\"/>", at, length,
                           rows[i].misses > 0 ? " late" : "");
        out += report::text_at(102 + length, at + 13, "note",
                               fmt::format("{} of {} missed, {} own", rows[i].misses,
                                           report::grouped(static_cast<double>(rows[i].frames)), rows[i].own));
    }
    return out + report::close_chart();
}

}  // namespace surefoot::soak
