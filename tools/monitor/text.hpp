// For this room only: numbers from JSON, their words, and the chart of frames.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tools/report/terminal.hpp"

namespace surefoot::monitor {

using report::cut_to;
using report::Ink;
using report::inked;
using report::places;
using report::share_bar;
using report::TerminalStyle;

/// A number at a JSON pointer ("/recent/frame_ms/p50"); NaN where there is none.
double number_at(const nlohmann::json& j, const char* pointer);
std::string text_at(const nlohmann::json& j, const char* pointer);
bool flag_at(const nlohmann::json& j, const char* pointer);

/// "22 620"; "-" for NaN.
std::string grouped(double whole);
/// About three digits: "24.1", "0.52", "1 204"; "-" for NaN.
std::string short_number(double value);
/// "0:12:34", "3 d 4:05:06"
std::string duration(double seconds);
std::string mebibytes(double bytes);

/// "98.2 % of full detail, one more millisecond would add 0.4 %"; empty where no prepared set was used.
std::string value_text(const nlohmann::json& status);
/// "raster 2, stolen 1"; empty where there are none.
std::string causes_text(const nlohmann::json& causes);

/// Frames as columns of `rows` lines, newest at the right; the last row but one ends at the period. A skipped slot is a column
/// too. frames: [[ms, skipped before, missed], …]
std::vector<std::string> frame_chart(const nlohmann::json& frames, double period_ms, const TerminalStyle& style,
                                     std::size_t columns, std::size_t rows);

}  // namespace surefoot::monitor
