// The measured margin of the in-frame check.
#include "rt/frame/overshoot.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

void Overshoot::update(double late_us) {
    if (!std::isfinite(late_us)) return;
    late_us_[next_] = std::max(late_us, 0.0);
    next_ = (next_ + 1) % window;
    std::array<double, window> sorted = late_us_;
    constexpr std::size_t rank = window * 95 / 100;
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    margin_us_ = sorted[rank];
}

}  // namespace surefoot::rt
