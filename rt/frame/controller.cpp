// The correction of predicted costs.
#include "rt/frame/controller.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

void CostController::update(double predicted_us, double actual_us) {
    const double ratio = actual_us / predicted_us;
    if (!(predicted_us > 0) || !(actual_us > 0) || !std::isfinite(ratio) || !(ratio > 0)) return;
    ratios_[next_] = std::clamp(ratio, lowest, highest);
    next_ = (next_ + 1) % window;
    count_ = std::min(count_ + 1, window);
    // Before the window is full, the ratios that are missing count as 1: a first outlier moves nothing.
    std::array<double, window> sorted = ratios_;
    std::fill(sorted.begin() + static_cast<std::ptrdiff_t>(count_), sorted.end(), 1.0);
    std::nth_element(sorted.begin(), sorted.begin() + window / 2, sorted.end());
    factor_ = std::clamp(std::clamp(sorted[window / 2], factor_ / slew, factor_ * slew), lowest, highest);
}

}  // namespace surefoot::rt
