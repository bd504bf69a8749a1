// Drawing charts as SVG text: scales, ticks, axes and the escaping that keeps names out of the markup.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace surefoot::report {

/// Names, paths and messages as text in HTML or SVG.
std::string escaped(std::string_view text);

/// A number for people: at most three significant digits and a k, M or G; "–" where it is not finite.
std::string short_number(double value);
/// Thousands apart by narrow spaces: 1 048 576.
std::string grouped(double value);

/// From values to pixels. Log scales need from, to > 0; values below are clamped to `from`.
struct Scale {
    double from = 0, to = 1;
    double low_px = 0, high_px = 1;
    bool log = false;
    [[nodiscard]] double operator()(double value) const;
};

/// Round values within [from, to]; about `about` of them; for log scales 1, 2, 5 or powers of ten.
std::vector<double> nice_ticks(double from, double to, int about);
std::vector<double> log_ticks(double from, double to);
/// A round value at or above, for the top of an axis.
double nice_ceiling(double value);

/// The inside of a chart and what frames it.
struct PlotArea {
    double left = 52, top = 14, right = 946, bottom = 200;
};

/// Opens and closes an inline chart; `label` is read aloud in place of it.
std::string open_chart(double width, double height, std::string_view label);
std::string close_chart();

/// Horizontal grid lines with figures at the left, and figures below, the last one with its unit.
std::string y_axis(const PlotArea& area, const Scale& y, const std::vector<double>& ticks, std::string_view unit);
std::string x_axis(const PlotArea& area, const Scale& x, const std::vector<double>& ticks, std::string_view unit);

std::string text_at(double x, double y, std::string_view css, std::string_view text);
std::string line_between(double x0, double y0, double x1, double y1, std::string_view css);
/// A polyline; breaks where `pen_up` says so.
struct Point {
    double x = 0, y = 0;
    bool pen_up = false;  ///< starts a new stroke
};
std::string polyline(const std::vector<Point>& points, std::string_view css);

}  // namespace surefoot::report
