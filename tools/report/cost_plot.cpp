// Cost against pixels, a line a triangle count, a panel a state class: figure 3.4 of Maciel 1994 for this machine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::report {

namespace {

constexpr double panel_width = 460;
constexpr double panel_height = 330;

using Line = std::vector<const CostPoint*>;
using Lines = std::map<double, Line>;  ///< by triangles

struct Limits {
    double pixels_low = std::numeric_limits<double>::infinity(), pixels_high = 1, cost_low = pixels_low, cost_high = 1e-9;
};

bool usable(const CostPoint& p) {
    return p.pixels > 0 && p.cost_us > 0 && std::isfinite(p.pixels) && std::isfinite(p.cost_us) && std::isfinite(p.triangles);
}

/// More triangles, stronger colour: the order of the lines is read without a legend.
double strength(std::size_t line, std::size_t count) {
    return count < 2 ? 1 : 0.35 + 0.65 * static_cast<double>(line) / static_cast<double>(count - 1);
}

std::string panel(const std::string& state, const Lines& lines, const Limits& limits, double left, double top) {
    const PlotArea area{left + 56, top + 34, left + panel_width - 70, top + panel_height - 48};
    const Scale x{limits.pixels_low, std::max(limits.pixels_high, limits.pixels_low * 2), area.left, area.right, true};
    const Scale y{limits.cost_low / 1.3, std::max(limits.cost_high * 1.3, limits.cost_low * 2), area.bottom, area.top, true};
    std::string out = text_at(area.left, top + 14, "title", state);
    out += y_axis(area, y, log_ticks(y.from, y.to), "µs") + x_axis(area, x, log_ticks(x.from, x.to), "pixels");
    std::size_t number = 0;
    double label_above = std::numeric_limits<double>::infinity();
    for (const auto& [triangles, measured] : lines) {
        Line points = measured;
        std::stable_sort(points.begin(), points.end(), [](const auto* a, const auto* b) { return a->pixels < b->pixels; });
        const double opacity = strength(number++, lines.size());
        std::string path;
        std::string dots;
        for (const CostPoint* p : points) {
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x(p->pixels), y(p->cost_us));
            dots += fmt::format(
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\" fill=\"var(--accent)\" opacity=\"{:.2f}\"><title>{} triangles, {} "
                "pixels: {} µs</title></circle>",
                x(p->pixels), y(p->cost_us), opacity, short_number(triangles), short_number(p->pixels), short_number(p->cost_us));
        }
        out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"var(--accent)\" stroke-width=\"1.8\" opacity=\"{:.2f}\"/>{}",
                           path, opacity, dots);
        // Lines are drawn from few triangles to many, so labels go upwards: one that would cover the last is left out.
        const double at = y(points.back()->cost_us) + 4;
        if (at > label_above - 12) continue;
        out += text_at(x(points.back()->pixels) + 7, at, "note", short_number(triangles) + " tri");
        label_above = at;
    }
    return out;
}

}  // namespace

std::string cost_plot_svg(const std::string& title, std::span<const CostPoint> points) {
    std::map<std::string, Lines> states;
    Limits limits;
    for (const CostPoint& p : points) {
        if (!usable(p)) continue;
        states[p.state][p.triangles].push_back(&p);
        limits.pixels_low = std::min(limits.pixels_low, p.pixels);
        limits.pixels_high = std::max(limits.pixels_high, p.pixels);
        limits.cost_low = std::min(limits.cost_low, p.cost_us);
        limits.cost_high = std::max(limits.cost_high, p.cost_us);
    }
    const std::size_t across = std::min<std::size_t>(2, std::max<std::size_t>(1, states.size()));
    const std::size_t down = std::max<std::size_t>(1, (states.size() + across - 1) / across);
    const double width = panel_width * static_cast<double>(across);
    const double height = 44 + panel_height * static_cast<double>(down);
    std::string out = open_chart(width, height, title) + text_at(16, 27, "title", title);
    if (states.empty()) out += text_at(16, 60, "note", "no points were measured");
    std::size_t number = 0;
    for (const auto& [state, lines] : states) {
        const std::size_t column = number % across, row = number / across;
        out +=
            panel(state, lines, limits, panel_width * static_cast<double>(column), 44 + panel_height * static_cast<double>(row));
        ++number;
    }
    return stand_alone(out + close_chart(), false);
}

}  // namespace surefoot::report
