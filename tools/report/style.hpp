// Colours and type of the pages and of charts that stand alone: one palette, light and dark.
#pragma once

#include <string>
#include <string_view>

namespace surefoot::report {

/// The page's style sheet; follows the reader's light or dark setting.
std::string page_style();
/// Chart rules with the palette written out, for an SVG file of its own.
std::string chart_style(bool dark);

/// An inline chart with its name space, palette and a background of its own.
std::string stand_alone(const std::string& inline_chart, bool dark);

/// A whole page around `body`. Nothing in it points outside the file.
std::string page(std::string_view title, std::string_view body);

/// Classes s0…s7 of the palette, for series.
constexpr int series_colours = 8;

}  // namespace surefoot::report
