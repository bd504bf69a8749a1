// The one cause of a missed frame, from the evidence in its record. A pure function.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// For how many frames a prepared set is used: three, and as many as are about 50 ms where those are more. A large model's
/// preparation takes several periods of a high rate.
constexpr std::uint32_t oldest_prepared(std::int64_t period_ns) {
    constexpr std::int64_t span_ns = 50'000'000;
    return static_cast<std::uint32_t>(
        std::clamp<std::int64_t>((span_ns + period_ns / 2) / std::max<std::int64_t>(period_ns, 1), 3, 64));
}

/// Limits of the phases, as shares of the period, and thresholds of the evidence.
struct BlameLimits {
    std::int64_t period_ns = 33'333'333;
    double wake_share = 0.03;
    double select_share = 0.06;
    double upload_share = 0.10;
    double submit_share = 0.40;  ///< without uploads
    double raster_share = 0.40;
    double present_share = 0.05;         ///< so much later than planned a picture may be shown, too
    std::int64_t minor_fault_ns = 1000;  ///< maximum cost of one: 0.25 us native to 2 us in a guest; see minor_fault_cost_ns()
    bool fifo = true;                    ///< the frame thread has SCHED_FIFO, so the platform causes late wake-ups
};

/// none if the frame was in time. Otherwise the cause without which the frame would have been in time.
/// If several causes qualify: the most specific evidence (stopped, page_fault, preempted or stolen, woken_late), then the phase
/// furthest over its share. If no single cause qualifies: the largest excess over a share.
Cause blame(const FrameRecord& record, const BlameLimits& limits);

/// So much later than planned a picture may be shown.
inline std::int64_t shown_tolerance_ns(const BlameLimits& limits) {
    return static_cast<std::int64_t>(limits.present_share * static_cast<double>(limits.period_ns));
}

/// Whether the picture was shown later than planned, by over present_share: as the display says, else by the end of presenting.
/// Where pictures are not presented, false.
bool is_shown_late(const FrameRecord& record, const BlameLimits& limits);

/// What delayed a picture that was whole in time, ns.
struct ShowingDelays {
    std::int64_t woken_late_ns = 0;   ///< for presenting
    std::int64_t stolen_ns = 0;       ///< since it was whole, without the waits for the display
    std::int64_t preempted_ns = 0;    ///< the same, with involuntary switches
    std::int64_t beyond_lead_ns = 0;  ///< of presenting, more than was planned; and of this program's own work before it
};

/// The cause of a picture that was whole in time and is_shown_late(): a stop of the process, else the largest of the delays.
Cause blame_showing(const FrameRecord& record, const ShowingDelays& delays);

/// Whether the frame is late even without stolen time: stolen_ns, and a late wake-up under FIFO. After a stop of the process:
/// every gap, and a late wake-up under any policy.
bool is_own_miss(const FrameRecord& record, const BlameLimits& limits);

}  // namespace surefoot::rt
