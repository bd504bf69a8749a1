// The one cause of a missed frame, from the evidence in its record: a pure function (DESIGN 7).
#pragma once

#include <cstdint>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

constexpr std::uint32_t oldest_prepared = 3;  ///< frames: an older prepared set is not used

/// What each phase may take, as shares of the period, and what counts as evidence.
struct BlameLimits {
    std::int64_t period_ns = 33'333'333;
    double wake_share = 0.03;
    double select_share = 0.06;
    double upload_share = 0.10;
    double submit_share = 0.40;  ///< without uploads
    double raster_share = 0.40;
    double present_share = 0.05;
    std::uint32_t oldest_prepared = rt::oldest_prepared;
    std::int64_t minor_fault_ns = 1000;  ///< of one, at most (0.25 us native to 2 us in a guest); see minor_fault_cost_ns()
    bool fifo = true;  ///< the frame thread has SCHED_FIFO: a late wake-up is the platform's doing, not that of our scheduling
};

/// none if the frame was in time. Otherwise: the cause without which the frame would have been in time; several would do:
/// the most specific evidence first (stopped, page_fault, preempted or stolen, woken_late), then the phase furthest over its
/// share; none would do alone: what took the most over its share.
Cause blame(const FrameRecord& record, const BlameLimits& limits);

/// Late even with the time taken out that the host stole: in the frame (stolen_ns), and before it (late wake-up under FIFO).
bool is_own_miss(const FrameRecord& record, const BlameLimits& limits);

}  // namespace surefoot::rt
