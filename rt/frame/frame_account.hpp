// Bookkeeping of one frame: resource usage before and after each tier, and the record fields derived from it.
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/clock/clock.hpp"
#include "rt/frame/loop.hpp"
#include "rt/frame/wait_estimate.hpp"
#include "rt/threads/guard.hpp"

namespace surefoot::rt {

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
    /// CPU time of the frame on the frame core; the control burns as much.
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
