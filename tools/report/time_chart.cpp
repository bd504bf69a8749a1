// Values over time. A walk has more frames than a screen has pixels, and the slow ones are what matters: so each column
// keeps its lowest, median and highest value, and no spike is ever averaged away.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tools/report/charts.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::report {

namespace {

constexpr double column_px = 2;

struct Column {
    double time_s = 0, low = 0, middle = 0, high = 0;
    bool gap_before = false;
};

std::vector<Column> columns_of(const TimeChart& c, double from_s, double to_s, std::size_t count) {
    std::vector<std::vector<double>> cells(count);
    for (std::size_t i = 0; i < c.time_s.size(); ++i) {
        if (!std::isfinite(c.value[i])) continue;
        const double at = (c.time_s[i] - from_s) / (to_s - from_s) * static_cast<double>(count);
        cells[std::min(count - 1, static_cast<std::size_t>(std::max(0.0, at)))].push_back(c.value[i]);
    }
    std::vector<Column> columns;
    const double cell_s = (to_s - from_s) / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
        auto& cell = cells[i];
        if (cell.empty()) continue;
        std::sort(cell.begin(), cell.end());
        Column column{from_s + (static_cast<double>(i) + 0.5) * cell_s, cell.front(), cell[cell.size() / 2], cell.back(), false};
        // A second without a frame is a gap (a control block), not a line across it.
        column.gap_before = !columns.empty() && column.time_s - columns.back().time_s > 1.0 + cell_s;
        columns.push_back(column);
    }
    return columns;
}

std::string band_of(const std::vector<Column>& columns, const Scale& x, const Scale& y) {
    std::string path;
    for (std::size_t first = 0; first < columns.size();) {
        std::size_t last = first + 1;
        while (last < columns.size() && !columns[last].gap_before) ++last;
        for (std::size_t i = first; i < last; ++i)
            path += fmt::format("{}{:.1f} {:.1f}", i == first ? "M" : "L", x(columns[i].time_s), y(columns[i].high));
        for (std::size_t i = last; i-- > first;) path += fmt::format("L{:.1f} {:.1f}", x(columns[i].time_s), y(columns[i].low));
        path += "Z";
        first = last;
    }
    return fmt::format("<path d=\"{}\" class=\"band\"/>", path);
}

/// Invisible stripes that answer the pointer.
std::string tips_of(const TimeChart& c, const PlotArea& area, const Scale& x, double from_s, double to_s) {
    constexpr std::size_t stripes = 96;
    std::string out;
    TimeChart plain;
    plain.time_s = c.time_s;
    plain.value = c.value;
    const double stripe_s = (to_s - from_s) / stripes;
    for (const Column& column : columns_of(plain, from_s, to_s, stripes)) {
        const double begin_s = column.time_s - stripe_s / 2;
        out += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"hit\"><title>{:.1f}–{:.1f} s: {} {} "
            "(lowest {}, highest {})</title></rect>",
            x(begin_s), area.top, x(begin_s + stripe_s) - x(begin_s), area.bottom - area.top, begin_s, begin_s + stripe_s,
            short_number(column.middle), escaped(c.unit), short_number(column.low), short_number(column.high));
    }
    return out;
}

/// Labels stand above their line, at the right; one that would run into the label before moves left of it, on its row.
std::string lines_of(const TimeChart& c, const PlotArea& area, const Scale& y) {
    constexpr double letter_px = 6.6;
    std::string out;
    double row = -1e9;
    double right = area.right;
    for (const auto& line : c.lines) {
        if (!(line.value > 0) || line.value > y.to) continue;
        const double at = y(line.value);
        if (std::abs(at - 5 - row) >= 14) {
            row = at - 5;
            right = area.right;
        }
        out += line_between(area.left, at, area.right, at, line.css);
        out += text_at(right, row, "note end " + line.css + "-text", line.text);
        right -= 16 + letter_px * static_cast<double>(line.text.size());
    }
    return out;
}

std::string markers_of(const TimeChart& c, const PlotArea& area, const Scale& x, const Scale& y) {
    std::string out;
    for (std::size_t i = 0; i < c.snapshots_s.size(); ++i) {
        const double at = x(c.snapshots_s[i]);
        out += line_between(at, area.top, at, area.bottom, "snapshot-line");
        out += text_at(at, area.top - 3, "note mid", std::to_string(i + 1));
    }
    for (const auto& m : c.markers) {
        const bool above = m.value > y.to;
        const double cx = x(m.time_s);
        const double cy = above ? area.top + 6 : y(m.value);
        const std::string shape = above ? fmt::format("<path d=\"M{:.1f} {:.1f}l5 9h-10z\" class=\"miss\">", cx, cy - 6)
                                        : fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" class=\"miss\">", cx, cy);
        out += fmt::format("{}<title>{}</title>{}", shape, escaped(m.tip), above ? "</path>" : "</circle>");
    }
    return out;
}

Scale value_scale(const TimeChart& c, const PlotArea& area) {
    double low = std::numeric_limits<double>::infinity();
    double high = 0;
    for (const double v : c.value) {
        if (!std::isfinite(v)) continue;
        high = std::max(high, v);
        if (v > 0) low = std::min(low, v);
    }
    for (const auto& line : c.lines) high = std::max(high, std::isfinite(line.value) ? line.value * 1.04 : 0);
    if (!c.log) return {0, c.top > 0 ? c.top : nice_ceiling(high * 1.02), area.bottom, area.top, false};
    if (!(high > 0)) low = high = 1;
    // Whole decades, at least one of them.
    const double bottom = std::pow(10.0, std::floor(std::log10(low)));
    const double top = std::pow(10.0, std::ceil(std::log10(high) + 1e-9));
    return {bottom, std::max(top, bottom * 10), area.bottom, area.top, true};
}

}  // namespace

std::string time_chart(const TimeChart& c) {
    const PlotArea area{52, 24, c.width - 10, c.height - 28};
    const bool empty = c.time_s.empty();
    const double from_s = empty ? 0 : c.time_s.front();
    const double to_s = empty ? 1 : std::max(c.time_s.back(), from_s + 1e-3);
    const Scale x{from_s, to_s, area.left, area.right, false};
    const Scale y = value_scale(c, area);
    const auto ticks = c.log ? log_ticks(y.from, y.to) : nice_ticks(y.from, y.to, c.height > 200 ? 5 : 4);

    std::string out = open_chart(c.width, c.height, c.label);
    out += y_axis(area, y, ticks, c.unit);
    out += x_axis(area, x, nice_ticks(from_s, to_s, c.width > 700 ? 10 : 5), "s");
    const auto columns = columns_of(c, from_s, to_s, static_cast<std::size_t>((area.right - area.left) / column_px));
    auto within = columns;
    for (Column& column : within) {
        column.high = std::min(column.high, y.to);
        column.middle = std::min(column.middle, y.to);
        column.low = std::min(column.low, y.to);
    }
    out += band_of(within, x, y);
    std::vector<Point> middle;
    std::vector<Point> highest;
    for (const Column& column : within) {
        middle.push_back({x(column.time_s), y(column.middle), column.gap_before});
        highest.push_back({x(column.time_s), y(column.high), column.gap_before});
    }
    out += polyline(highest, "peaks") + polyline(middle, "line");
    out += lines_of(c, area, y);
    if (!empty) out += tips_of(c, area, x, from_s, to_s);
    out += markers_of(c, area, x, y);
    return out + close_chart();
}

}  // namespace surefoot::report
