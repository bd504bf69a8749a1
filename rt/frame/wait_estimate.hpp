// How long a frame had to wait for the driver's rasterisers: learned, so that what was stolen from them can be told apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/threads/usage.hpp"

namespace surefoot::rt {

/// The wait for n rasterisers lies between the busiest one's CPU time and the sum of all. Where in between is learned: the
/// 12th of the last 15 ratios of wait to sum, so that up to 3 disturbed frames in 15 teach nothing, and so that an ordinary
/// frame that waits a little longer is not taken for a theft.
class WaitEstimate {
public:
    /// Of the wait seen (wall minus CPU in the driver's phases, ns), how much is accounted for by the rasterisers' work.
    /// Nothing known about rasterisers (sum 0): all of it if the thread slept of its own will at all, else none.
    std::int64_t known_ns(std::int64_t wait_ns, ThreadClocks::Spent rasterisers, bool slept) const;
    /// Learns from this frame.
    void update(std::int64_t wait_ns, ThreadClocks::Spent rasterisers);

private:
    static constexpr std::size_t window = 15, rank = 11;
    std::array<double, window> ratios_{};
    std::size_t count_ = 0, next_ = 0;
};

}  // namespace surefoot::rt
