// What accuracy costs in time, a line a selector: accuracy, SNR and SSIM against frame time, the chart in the README; and the
// worst place against the slowest frames, PSNR and FLIP.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tools/accuracy/page.hpp"
#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::accuracy {

namespace {

constexpr double chart_width = 900;
constexpr double chart_height = 420;

struct Panel {
    std::string_view title, unit;
    double (*value)(const AccuracyPoint&);
    bool log;
    double (*time_ms)(const AccuracyPoint&) = [](const AccuracyPoint& p) { return p.frame_ms_p50; };
    bool (*on_front)(const AccuracyPoint&) = [](const AccuracyPoint&) { return false; };
};
constexpr std::array<Panel, 3> panels = {{
    {"Accuracy, rad⁻¹", "", [](const AccuracyPoint& p) { return p.accuracy_mean; }, true},
    {"SNR, dB", "", [](const AccuracyPoint& p) { return p.snr_db; }, false},
    {"SSIM", "", [](const AccuracyPoint& p) { return p.ssim; }, false},
}};
constexpr std::array<Panel, 3> worst_case_panels = {{
    {"Worst accuracy, rad⁻¹ (p99)", "", [](const AccuracyPoint& p) { return p.accuracy_worst; }, true,
     [](const AccuracyPoint& p) { return p.frame_ms_p99; }, [](const AccuracyPoint& p) { return p.accuracy_front; }},
    {"PSNR, dB (median)", "",
     [](const AccuracyPoint& p) { return p.psnr_db < report::max_psnr_db ? p.psnr_db : std::numeric_limits<double>::infinity(); },
     false, [](const AccuracyPoint& p) { return p.frame_ms_p50; }, [](const AccuracyPoint& p) { return p.psnr_front; }},
    {"FLIP, less is better", "", [](const AccuracyPoint& p) { return p.flip; }, false},
}};

/// One selector's points, in order of budget.
struct Series {
    std::string name;
    std::size_t colour = 0;
    bool published = false;  ///< accounting as in 1994: the colour of the corrected one, dashed
    std::vector<const AccuracyPoint*> points;
};

std::vector<Series> series_of(const AccuracyRun& run) {
    std::vector<Series> all;
    std::vector<std::string> families;
    for (const AccuracyPoint& point : run.points) {
        auto found = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.name == point.selector; });
        if (found == all.end()) {
            Series s;
            s.name = point.selector;
            s.published = s.name.ends_with(published_ending);
            const std::string family = s.published ? s.name.substr(0, s.name.size() - published_ending.size()) : s.name;
            auto kin = std::find(families.begin(), families.end(), family);
            if (kin == families.end()) kin = families.insert(families.end(), family);
            s.colour = static_cast<std::size_t>(kin - families.begin()) % report::series_colours;
            all.push_back(std::move(s));
            found = all.end() - 1;
        }
        found->points.push_back(&point);
    }
    for (Series& s : all)
        std::stable_sort(s.points.begin(), s.points.end(),
                         [](const auto* a, const auto* b) { return a->budget_ms < b->budget_ms; });
    return all;
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void grow(double v) {
        if (!std::isfinite(v)) return;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    [[nodiscard]] bool empty() const { return low > high; }
};

report::Scale time_scale(const AccuracyRun& run, const Panel& panel, const report::PlotArea& area) {
    Range range;
    for (const AccuracyPoint& p : run.points)
        if (panel.time_ms(p) > 0) range.grow(panel.time_ms(p));
    for (const ChangeMark& mark : run.changes)
        if (panel.time_ms(mark.point) > 0) range.grow(panel.time_ms(mark.point));
    if (run.full_frame_ms > 0) range.grow(run.full_frame_ms);
    if (range.empty()) return {1, 10, area.left, area.right, true};
    return {range.low * 0.9, std::max(range.high * 1.12, range.low * 1.5), area.left, area.right, true};
}

report::Scale value_scale(const AccuracyRun& run, const Panel& panel, const report::PlotArea& area) {
    Range range;
    const auto grow = [&](const AccuracyPoint& p) {
        const double v = panel.value(p);
        if (!panel.log || v > 0) range.grow(v);
    };
    for (const AccuracyPoint& p : run.points) grow(p);
    for (const ChangeMark& mark : run.changes) grow(mark.point);
    if (range.empty()) return {panel.log ? 1.0 : 0.0, 10, area.bottom, area.top, panel.log};
    if (panel.log) return {range.low / 1.25, std::max(range.high * 1.25, range.low * 2), area.bottom, area.top, true};
    const double margin = std::max((range.high - range.low) * 0.08, std::max(1e-3, std::abs(range.high) * 0.01));
    return {range.low - margin, range.high + margin, area.bottom, area.top, false};
}

bool drawable(const AccuracyPoint& p, double value, const Panel& panel) {
    return panel.time_ms(p) > 0 && std::isfinite(value) && (!panel.log || value > 0);
}

std::string tip_of(const AccuracyPoint& p, std::string_view change = {}) {
    return fmt::format(
        "{}{}, budget {} ms. Frame {:.1f} ms (p90 {:.1f}, p99 {:.1f}). Accuracy {} rad⁻¹ (worst {}). SNR {}, PSNR {}, SSIM "
        "{:.3f}, "
        "FLIP {:.4f}. {} triangles.",
        report::escaped(p.selector), change.empty() ? "" : fmt::format(", {}", change),
        std::isfinite(p.budget_ms) ? fmt::format("{:.1f}", p.budget_ms) : "unlimited", p.frame_ms_p50, p.frame_ms_p90,
        p.frame_ms_p99, report::short_number(p.accuracy_mean), report::short_number(p.accuracy_worst), report::decibels(p.snr_db),
        report::decibels(p.psnr_db), p.ssim, p.flip, report::short_number(p.triangles));
}

/// A square a change; the first, as swept, is full.
std::string change_marks(const AccuracyRun& run, const Panel& panel, const report::Scale& x, const report::Scale& y) {
    std::string out;
    for (const ChangeMark& mark : run.changes) {
        const double v = panel.value(mark.point);
        if (!drawable(mark.point, v, panel)) continue;
        out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" height=\"8\" class=\"{}\"><title>{}</title></rect>",
                           x(panel.time_ms(mark.point)) - 4, y(v) - 4, &mark == &run.changes.front() ? "as-swept" : "change",
                           tip_of(mark.point, mark.change));
    }
    return out;
}

std::string panel_chart(const AccuracyRun& run, const std::vector<Series>& all, const Panel& panel,
                        const report::PlotArea& area) {
    const report::Scale x = time_scale(run, panel, area);
    const report::Scale y = value_scale(run, panel, area);
    std::string out = report::text_at(area.left, area.top - 14, "title", panel.title);
    out += report::y_axis(area, y, panel.log ? report::log_ticks(y.from, y.to) : report::nice_ticks(y.from, y.to, 5), panel.unit);
    out += report::x_axis(area, x, report::log_ticks(x.from, x.to), "");
    if (run.full_frame_ms > 0) {
        out += report::line_between(x(run.full_frame_ms), area.top, x(run.full_frame_ms), area.bottom, "budget");
        out += report::text_at(x(run.full_frame_ms) - 5, area.bottom - 8, "note end budget-text", "full detail");
    }
    for (const Series& s : all) {
        std::vector<report::Point> line;
        std::string dots;
        for (const AccuracyPoint* p : s.points) {
            const double v = panel.value(*p);
            if (!drawable(*p, v, panel)) continue;
            line.push_back({x(panel.time_ms(*p)), y(v), false});
            if (panel.on_front(*p))
                dots +=
                    fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"7\" class=\"front\"/>", line.back().x, line.back().y);
            dots += fmt::format(
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" class=\"dot\" fill=\"var(--s{})\"><title>{}</title></circle>",
                line.back().x, line.back().y, s.published ? 2.8 : 3.8, s.colour, tip_of(*p));
        }
        std::string path;
        for (std::size_t i = 0; i < line.size(); ++i)
            path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", line[i].x, line[i].y);
        if (line.size() > 1)
            out += fmt::format(
                "<path d=\"{}\" fill=\"none\" stroke=\"var(--s{})\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>", path,
                s.colour, s.published ? 1.6 : 2.2, s.published ? " stroke-dasharray=\"5 4\"" : "");
        out += dots;
    }
    return out + change_marks(run, panel, x, y);
}

std::string legend_of(const AccuracyRun& run, const std::vector<Series>& all, double top) {
    std::string out;
    double at = 52;
    double y = top;
    for (const Series& s : all) {
        const double length = 46 + 7.3 * static_cast<double>(s.name.size());
        if (at + length > chart_width - 8 && at > 52) {
            at = 52;
            y += 20;
        }
        out += fmt::format("<path d=\"M{:.1f} {:.1f}h22\" stroke=\"var(--s{})\" stroke-width=\"{}\"{}/>", at, y - 4, s.colour,
                           s.published ? 1.6 : 2.4, s.published ? " stroke-dasharray=\"5 4\"" : "");
        if (!s.published)
            out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.8\" fill=\"var(--s{})\"/>", at + 11, y - 4, s.colour);
        out += report::text_at(at + 28, y, "", s.name);
        at += length;
    }
    if (!run.changes.empty()) {
        if (at + 300 > chart_width - 8) {
            at = 52;
            y += 20;
        }
        out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" height=\"8\" class=\"change\"/>", at + 7, y - 8);
        out += report::text_at(at + 28, y, "", "one setting changed; full: as swept");
    }
    return out;
}

std::string chart_of(const AccuracyRun& run, const std::array<Panel, 3>& three, std::string_view title,
                     std::string_view x_title) {
    const auto all = series_of(run);
    std::string out = report::open_chart(chart_width, chart_height, title);
    out += legend_of(run, all, 24);
    constexpr double panel_width = chart_width / 3;
    for (std::size_t i = 0; i < three.size(); ++i) {
        const double left = panel_width * static_cast<double>(i);
        out += panel_chart(run, all, three[i], {left + 52, 96, left + panel_width - 14, chart_height - 46});
    }
    out += report::text_at(chart_width / 2, chart_height - 8, "note mid", x_title);
    return out + report::close_chart();
}

}  // namespace

std::string accuracy_chart(const AccuracyRun& run) {
    return chart_of(run, panels, "What accuracy costs in time", "median frame time, ms (logarithmic)");
}

std::string worst_case_chart(const AccuracyRun& run) {
    return chart_of(run, worst_case_panels, "The worst place and the slowest frames", "frame time, ms (logarithmic)");
}

std::string accuracy_svg(const AccuracyRun& run, bool dark) { return report::stand_alone(accuracy_chart(run), dark); }
std::string worst_case_svg(const AccuracyRun& run, bool dark) { return report::stand_alone(worst_case_chart(run), dark); }

}  // namespace surefoot::accuracy
