// Inside the report room: the accuracy chart without its frame, for the page; and what makes any inline chart a file of its own.
#pragma once

#include <string>

#include "tools/report/report.hpp"

namespace surefoot::report {

/// Inline: takes its colours from the page's style.
std::string accuracy_chart(const AccuracyRun& run);
/// An inline chart with its name space, palette and a background of its own.
std::string stand_alone(const std::string& inline_chart, bool dark);

}  // namespace surefoot::report
