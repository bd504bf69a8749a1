// One frame's bookkeeping around the loop: usage before and after each tier, and what follows from it; how long a
// frame had to wait for the rasterisers is learned.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "rt/clock/clock.hpp"
#include "rt/frame/loop.hpp"
#include "rt/threads/guard.hpp"
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

/// Called by the loop in the order: begin, own_done, driver_done, close, before_push.
class FrameAccount {
public:
    FrameAccount(const FrameLoopOptions& options, Clock& clock);

    /// Awake: the frame begins.
    void begin(FrameRecord& record);
    /// Sampled and selected: the driver's tier begins.
    void own_done(FrameRecord& record);
    /// Presented: the frame is over.
    void driver_done(FrameRecord& record);
    /// Fills in usage, gap, waits; missed, own_miss and cause.
    void close(FrameRecord& record);
    /// Last: allocations since the last frame, those of the accounting stage included.
    void before_push(FrameRecord& record);
    /// What the frame took of the frame core: the control burns as much.
    [[nodiscard]] std::int64_t core_cpu_ns() const { return core_cpu_ns_; }

private:
    std::uint32_t continues() const;
    std::int64_t display_wait_ns(const FrameRecord& record, std::int64_t unexplained_ns) const;

    const FrameLoopOptions& options_;
    Clock& clock_;
    BlameLimits limits_;
    ThreadClocks rasterisers_, on_core_;
    WaitEstimate estimate_;
    std::int64_t begun_ns_ = 0;
    ThreadUsage begun_, selected_, ended_;
    ThreadUsage before_;  ///< end of the last frame
    GuardCounters guard_before_;
    std::uint32_t continued_before_ = 0;
    std::int64_t core_cpu_ns_ = 0;
};

}  // namespace surefoot::rt
