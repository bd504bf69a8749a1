// Bookkeeping of one frame: resource usage before and after each tier, and the record fields derived from it. Learns how long a
// frame must wait for the driver's rasterisers, to tell this wait from stolen time.
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

/// The wait for n rasterisers lies between the CPU time of the busiest and the sum of all. Its ratio to the sum is learned: the
/// 12th smallest of the last 15 ratios. So up to 3 disturbed frames in 15 have no effect. A frame that waits a little longer than
/// usual does not count as stolen.
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

/// Called by the loop in the order: begin, own_done, driver_done, close, before_showing, present_begins, present_ended,
/// before_push. Those of presenting only where pictures are presented.
class FrameAccount {
public:
    FrameAccount(const FrameLoopOptions& options, Clock& clock);

    /// Awake: the frame begins.
    void begin(FrameRecord& record);
    /// Sampled and selected: the driver's tier begins.
    void own_done(FrameRecord& record);
    /// The picture is whole.
    void driver_done(FrameRecord& record);
    /// Fills in usage, gap, waits; missed, own_miss and cause.
    void close(FrameRecord& record);
    /// All that was to be done before the picture's time is done: what was lost since it was whole delays it too.
    void before_showing(const FrameRecord& record);
    /// The time of showing has come. begins_ns: when the thread could have woken for it.
    void present_begins(FrameRecord& record, std::int64_t begins_ns);
    /// Presented. A picture that was whole in time but is shown late is a miss.
    void present_ended(FrameRecord& record, Shown shown, std::int64_t lead_ns);
    /// Last: allocations since the last frame, those of the accounting stage included.
    void before_push(FrameRecord& record);
    /// CPU time of the frame on the frame core; the control burns as much.
    [[nodiscard]] std::int64_t core_cpu_ns() const { return core_cpu_ns_; }
    [[nodiscard]] const BlameLimits& limits() const { return limits_; }

private:
    /// Of a piece of wall time.
    struct Lost {
        std::int64_t stolen_ns = 0, preempted_ns = 0;
    };
    static Lost lost(std::int64_t wall_ns, const ThreadUsage& used);
    [[nodiscard]] std::int64_t kept_waiting_ns(const FrameRecord& record, std::int64_t lead_ns) const;
    std::uint32_t continues() const;
    void read_end(std::int64_t& now_ns, FrameRecord& record);
    std::int64_t display_wait_ns(const FrameRecord& record, std::int64_t unexplained_ns) const;

    const FrameLoopOptions& options_;
    Clock& clock_;
    BlameLimits limits_;
    ThreadClocks rasterisers_, on_core_;
    WaitEstimate estimate_;
    std::int64_t begun_ns_ = 0;
    std::int64_t woken_late_ns_ = 0;  ///< for presenting
    Lost lost_before_showing_;
    ThreadUsage begun_, selected_, ended_, handed_;
    ThreadUsage before_;  ///< end of the last frame; what presenting used since is added
    GuardCounters guard_before_;
    std::uint32_t continued_before_ = 0;
    std::int64_t core_cpu_ns_ = 0;
};

}  // namespace surefoot::rt
