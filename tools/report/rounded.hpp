// Figures as the JSON outputs write them.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace surefoot::report {

/// Three decimals; infinity and not-a-number become null (an accuracy without any error, a test not run).
inline nlohmann::ordered_json rounded(double value) {
    if (!std::isfinite(value)) return nullptr;
    const double scaled = std::round(value * 1000.0) / 1000.0;
    return std::isfinite(scaled) ? nlohmann::ordered_json(scaled) : nlohmann::ordered_json(value);
}

}  // namespace surefoot::report
