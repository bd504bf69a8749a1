// The correction of predicted costs.
#include "rt/frame/controller.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

void CostController::update(double predicted_us, double actual_us) {
    const double ratio = actual_us / predicted_us;
    if (!(predicted_us > 0) || !(actual_us > 0) || !std::isfinite(ratio) || !(ratio > 0)) return;
    update_headroom(ratio / factor_);
    ratios_[next_] = std::clamp(ratio, lowest, highest);
    next_ = (next_ + 1) % window;
    count_ = std::min(count_ + 1, window);
    // Before the window is full, missing ratios count as 1, so that a first outlier has no effect.
    std::array<double, window> sorted = ratios_;
    std::fill(sorted.begin() + static_cast<std::ptrdiff_t>(count_), sorted.end(), 1.0);
    std::nth_element(sorted.begin(), sorted.begin() + window / 2, sorted.end());
    factor_ = std::clamp(std::clamp(sorted[window / 2], factor_ / slew, factor_ * slew), lowest, highest);
}

void CostController::scale(double by) {
    for (double& ratio : ratios_) ratio = std::clamp(ratio * by, lowest, highest);
    factor_ = std::clamp(factor_ * by, lowest, highest);
}

void CostController::update_headroom(double error) {
    errors_[errors_next_] = std::min(error, highest);
    errors_next_ = (errors_next_ + 1) % headroom_window;
    errors_count_ = std::min(errors_count_ + 1, headroom_window);
    // Before the window is full, missing values count as the worst, so that the headroom is the table's.
    std::array<double, headroom_window> sorted = errors_;
    std::fill(sorted.begin() + static_cast<std::ptrdiff_t>(errors_count_), sorted.end(), highest);
    constexpr std::size_t rank = headroom_window * 9 / 10;
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    headroom_ = sorted[rank];
}

double CostController::headroom(double of_table) const {
    return std::min(std::max(headroom_, min_headroom), std::max(of_table, 1.0));
}

}  // namespace surefoot::rt
