// Learns how long a frame must wait for the driver's rasterisers, to tell this wait from stolen time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/threads/usage.hpp"

namespace surefoot::rt {

/// The wait for n rasterisers lies between the CPU time of the busiest and the sum of all. Its ratio to the sum is learned: the
/// 12th smallest of the last 15 ratios. So up to 3 disturbed frames in 15 have no effect, and a frame that waits a little longer
/// than usual does not count as stolen.
class WaitEstimate {
public:
    /// The part of the observed wait (wall minus CPU in the driver's phases, ns) that the rasterisers' work explains.
    /// If nothing is known about rasterisers (sum 0): all if the thread slept voluntarily, else none.
    std::int64_t known_ns(std::int64_t wait_ns, ThreadClocks::Spent rasterisers, bool slept) const;
    /// Learns from this frame.
    void update(std::int64_t wait_ns, ThreadClocks::Spent rasterisers);

private:
    static constexpr std::size_t window = 15, rank = 11;
    std::array<double, window> ratios_{};
    std::size_t count_ = 0, next_ = 0;
};

}  // namespace surefoot::rt
