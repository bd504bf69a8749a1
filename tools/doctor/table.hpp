// The doctor's findings as a table for people, grouped by topic.
#pragma once

#include <span>
#include <string>

#include "tools/doctor/check.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::doctor {

/// Evidence is wrapped at the look's width; remedies are not, so that they can be copied.
std::string table(const Machine& machine, std::span<const Examined> examined, const report::Look& look);

}  // namespace surefoot::doctor
