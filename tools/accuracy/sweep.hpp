// Measures what accuracy costs in time: draws poses of a path at several budgets, and compares with full detail.
#pragma once

#include <string>
#include <vector>

#include "render/select/select.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/page.hpp"
#include "tools/accuracy/places.hpp"

namespace surefoot::accuracy {

/// The selectors that are compared by default.
std::vector<std::string> compared_selectors();

/// The swept selector by which single settings are changed. The usual one, else the first that goes by a budget. Published ones
/// are left out. Empty: there is none.
std::string changed_selector(const std::vector<std::string>& swept);

/// Settings of a sweep.
struct AccuracyRequest : PlacesRequest {
    double rate_hz = 30;  ///< what one more millisecond buys is measured at the budget that it allows
    std::vector<std::string> selectors = compared_selectors();
    select::BenefitModel benefit = select::BenefitModel::surefoot;  ///< of the 1994 selectors
    std::vector<double> budgets_ms;  ///< empty: eight, from an eighth of the full frame's time to all of it
};

/// Every budget is spent on every pose by every selector; pictures are compared with full detail at the same pose.
/// A selector that goes by a threshold has no budget: its threshold is swept instead. One that goes by nothing is the full frame.
Result<AccuracyRun> run_accuracy(const AccuracyRequest& request, const Progress& progress);

}  // namespace surefoot::accuracy
