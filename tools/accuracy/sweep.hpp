// Measures what accuracy costs in time: draws poses of a path at several budgets, and compares with full detail.
#pragma once

#include <string>
#include <vector>

#include "render/gl/backends.hpp"
#include "render/model/view.hpp"
#include "render/select/select.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/page.hpp"

namespace surefoot::accuracy {

/// The selectors that are compared by default.
std::vector<std::string> compared_selectors();

/// The swept selector by which single settings are changed. The usual one, else the first that goes by a budget. Published ones
/// are left out. Empty: there is none.
std::string changed_selector(const std::vector<std::string>& swept);

/// Settings of a sweep.
struct AccuracyRequest {
    std::string model_file, path_file, state_dir;
    std::string backend{gl::usual_backend};
    std::uint32_t width = 1280, height = 720, poses = 16;
    int repeats = 3;  ///< submissions a pose and budget; the median counts
    int workers = 0, rasterisers = 0;
    double lift_m = 0;
    double rate_hz = 30;              ///< what one more millisecond buys is measured at the budget that it allows
    double shift_x = 0, shift_y = 0;  ///< off axis, as model::Viewport has it
    std::vector<std::string> selectors = compared_selectors();
    select::BenefitModel benefit = select::BenefitModel::surefoot;  ///< of the 1994 selectors
    std::vector<double> budgets_ms;  ///< empty: eight, from an eighth of the full frame's time to all of it

    [[nodiscard]] model::Viewport viewport() const { return {width, height, shift_x, shift_y}; }
};

/// Every budget is spent on every pose by every selector; pictures are compared with full detail at the same pose.
/// A selector that goes by a threshold has no budget: its threshold is swept instead. One that goes by nothing is the full frame.
Result<AccuracyRun> run_accuracy(const AccuracyRequest& request, const Progress& progress);

}  // namespace surefoot::accuracy
