// The doctor's findings as a table for people, grouped by topic.
#pragma once

#include <span>
#include <string>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

struct TableOptions {
    bool colour = false;
    bool utf8 = false;        ///< marks beyond ASCII
    std::size_t width = 120;  ///< evidence is wrapped here; remedies are not, so that they can be copied
};

std::string table(const Machine& machine, std::span<const Examined> examined, const TableOptions& options);

}  // namespace surefoot::doctor
