// Online correction of predicted costs.
#include "rt/frame/controller.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

void CostController::update(double predicted_us, double actual_us) {
    const double ratio = actual_us / predicted_us;
    if (!(predicted_us > 0) || !(actual_us > 0) || !std::isfinite(ratio)) return;
    ratios_[next_] = ratio;
    next_ = (next_ + 1) % window;
    count_ = std::min(count_ + 1, window);
    std::array<double, window> sorted = ratios_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count_));
    const double target = std::clamp(*middle, lowest, highest);
    factor_ = std::clamp(std::clamp(target, factor_ / slew, factor_ * slew), lowest, highest);
}

}  // namespace surefoot::rt
