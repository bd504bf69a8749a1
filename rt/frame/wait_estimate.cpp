// The learned wait for rasterisers.
#include "rt/frame/wait_estimate.hpp"

#include <algorithm>

namespace surefoot::rt {

std::int64_t WaitEstimate::known_ns(std::int64_t wait_ns, ThreadClocks::Spent rasterisers, bool slept) const {
    if (wait_ns <= 0) return 0;
    if (rasterisers.sum_ns <= 0) return slept ? wait_ns : 0;
    if (count_ < window) return std::min(wait_ns, rasterisers.sum_ns);
    std::array<double, window> sorted = ratios_;
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    const auto expected = static_cast<std::int64_t>(sorted[rank] * static_cast<double>(rasterisers.sum_ns));
    return std::min(wait_ns, std::clamp(expected, std::min(rasterisers.longest_ns, rasterisers.sum_ns), rasterisers.sum_ns));
}

void WaitEstimate::update(std::int64_t wait_ns, ThreadClocks::Spent rasterisers) {
    if (wait_ns <= 0 || rasterisers.sum_ns <= 0) return;
    ratios_[next_] = static_cast<double>(wait_ns) / static_cast<double>(rasterisers.sum_ns);
    next_ = (next_ + 1) % window;
    count_ = std::min(count_ + 1, window);
}

}  // namespace surefoot::rt
