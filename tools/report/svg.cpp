// Scales, ticks and axes. Coordinates are written with one decimal: finer than a pixel, and a third of the bytes.
#include "tools/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace surefoot::report {

std::string escaped(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
        }
    }
    return out;
}

std::string short_number(double value) {
    if (!std::isfinite(value)) return "–";
    constexpr std::array<std::pair<double, std::string_view>, 3> units = {{{1e9, " G"}, {1e6, " M"}, {1e3, " k"}}};
    const double magnitude = std::abs(value);
    for (const auto& [unit, name] : units)
        if (magnitude >= unit * 0.9995 && (unit > 1e3 || magnitude >= 9999.5)) return fmt::format("{:.3g}{}", value / unit, name);
    if (magnitude >= 1000) return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}", magnitude < 1e-9 ? 0.0 : value);
}

std::string grouped(double value) {
    if (!std::isfinite(value)) return "–";
    const std::string digits = fmt::format("{:.0f}", std::abs(value));
    std::string out = value <= -0.5 ? "−" : "";
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && digits.size() > 4 && (digits.size() - i) % 3 == 0) out += "\u202f";
        out += digits[i];
    }
    return out;
}

double Scale::operator()(double value) const {
    if (log) {
        const double span = std::log(to / from);
        const double at = span > 0 ? std::log(std::max(value, from) / from) / span : 0;
        return low_px + at * (high_px - low_px);
    }
    const double at = to > from ? (value - from) / (to - from) : 0;
    return low_px + at * (high_px - low_px);
}

namespace {

/// 1, 2 or 5 times a power of ten, at or above.
double nice_step(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double factor : {1.0, 2.0, 5.0, 10.0})
        if (factor * power >= value * (1 - 1e-9)) return factor * power;
    return 10 * power;
}

}  // namespace

double nice_ceiling(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double step = nice_step(value / 5);
    return step * std::ceil(value / step - 1e-9);
}

std::vector<double> nice_ticks(double from, double to, int about) {
    std::vector<double> ticks;
    if (!(to > from) || !std::isfinite(to - from)) return {from};
    const double step = nice_step((to - from) / std::max(1, about));
    const double first = std::ceil(from / step - 1e-9);
    const double last = std::floor(to / step + 1e-9);
    const auto count = static_cast<std::size_t>(std::max(0.0, last - first + 1));
    ticks.reserve(count);
    for (std::size_t k = 0; k < count; ++k) ticks.push_back((first + static_cast<double>(k)) * step);
    return ticks;
}

std::vector<double> log_ticks(double from, double to) {
    std::vector<double> ticks;
    if (!(from > 0) || !(to > from) || !std::isfinite(to)) return {from};
    const double decades = std::log10(to / from);
    const int stride = decades > 9 ? 3 : decades > 5.5 ? 2 : 1;
    for (int power = static_cast<int>(std::floor(std::log10(from))); std::pow(10.0, power) <= to * 1.0001; ++power) {
        if (stride > 1 && power % stride != 0) continue;
        for (const double factor : {1.0, 2.0, 5.0}) {
            if (factor > 1 && decades > 2.2) break;
            const double tick = factor * std::pow(10.0, power);
            if (tick >= from * 0.9999 && tick <= to * 1.0001) ticks.push_back(tick);
        }
    }
    return ticks;
}

std::string open_chart(double width, double height, std::string_view label) {
    return fmt::format("<svg class=\"chart\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", width, height,
                       escaped(label));
}

std::string close_chart() { return "</svg>\n"; }

std::string text_at(double x, double y, std::string_view css, std::string_view text) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>", x, y, css, escaped(text));
}

std::string line_between(double x0, double y0, double x1, double y1, std::string_view css) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>", x0, y0, x1, y1, css);
}

std::string y_axis(const PlotArea& area, const Scale& y, const std::vector<double>& ticks, std::string_view unit) {
    std::string out;
    for (const double tick : ticks) {
        out += line_between(area.left, y(tick), area.right, y(tick), tick == 0 ? "axis" : "grid");
        out += text_at(area.left - 8, y(tick) + 4, "tick end", short_number(tick));
    }
    if (!unit.empty()) out += text_at(area.left - 8, area.top - 11, "unit end", unit);
    return out;
}

std::string x_axis(const PlotArea& area, const Scale& x, const std::vector<double>& ticks, std::string_view unit) {
    std::string out = line_between(area.left, area.bottom, area.right, area.bottom, "axis");
    for (const double& tick : ticks) {
        const bool last = &tick == &ticks.back();
        out += line_between(x(tick), area.bottom, x(tick), area.bottom + 4, "axis");
        out += text_at(x(tick), area.bottom + 18, "tick mid",
                       short_number(tick) + (last && !unit.empty() ? " " + std::string(unit) : ""));
    }
    return out;
}

std::string polyline(const std::vector<Point>& points, std::string_view css) {
    if (points.empty()) return {};
    std::string path;
    bool first = true;
    for (const Point& p : points) {
        fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", first || p.pen_up ? "M" : "L", p.x, p.y);
        first = false;
    }
    return fmt::format("<path d=\"{}\" class=\"{}\"/>", path, css);
}

}  // namespace surefoot::report
