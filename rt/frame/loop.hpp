// The frame loop: wakes on the grid, runs the stages, accounts, shows the picture at its time, goes to the next slot. Short
// enough to audit at one look.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "rt/clock/clock.hpp"
#include "rt/clock/display_clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/exchange/spsc_ring.hpp"
#include "rt/frame/blame.hpp"
#include "rt/frame/control.hpp"
#include "rt/frame/record.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::rt {

/// The stages of a frame, called in this order on the frame thread. The record has slot, frame, due_ns, deadline_ns, woken_ns and
/// skipped_before. Own code in them must not allocate, lock or fault.
class FrameStages {
public:
    virtual ~FrameStages() = default;
    /// Takes the newest input: the pose of this frame.
    virtual void sample(FrameRecord& record) = 0;
    /// Chooses the cut. selected_ns is taken when it returns.
    virtual void select(FrameRecord& record) = 0;
    /// Hands the slices to the driver (driver tier of memory). submitted_ns is taken when it returns, unless it set it.
    virtual void submit(FrameRecord& record) = 0;
    /// Waits for what submit() left (driver tier); stages may wait in submit(). When it returns, complete_ns is taken;
    /// rastered_ns too, unless submit() or finish() set it.
    virtual void finish(FrameRecord& record) = 0;
    /// After the frame's work, with usage, missed, own_miss and cause filled in: corrects costs, fills the rest of the record. A
    /// picture that is then shown too late still becomes a miss.
    virtual void account(FrameRecord& record) = 0;
    /// Hands the whole picture to the display (driver tier), where FrameLoopOptions::shows. `lock` waits for its time before.
    virtual Shown present(FrameRecord& record) {
        static_cast<void>(record);
        return {};
    }
    /// The picture became a miss as it was shown, after account(). Keeps what such a frame is examined by.
    virtual void shown_late(const FrameRecord& record) { static_cast<void>(record); }
};

/// Settings of the loop. Pointers must outlive the run.
struct FrameLoopOptions {
    std::int64_t period_ns = 16'666'667;
    std::int64_t t0_ns = 0;    ///< 0: the first slot is due one period after the call
    std::uint64_t frames = 0;  ///< frames to run; 0: until stopped (or the control schedule ends)
    /// Once set, prolonged_frames counts in place of `frames`; may be null.
    const std::atomic<bool>* prolonged = nullptr;
    std::uint64_t prolonged_frames = 0;
    LatePolicy late = LatePolicy::lock;
    /// Pictures are presented, and judged by when that is done. False (the virtual clock): a frame ends when it is whole.
    bool shows = false;
    /// Moves the grid after each picture that the display told of; null: the grid stands. Its first grid is this one's.
    DisplayClock* display = nullptr;
    const ControlSchedule* control = nullptr;   ///< not null: ends after its last block
    const std::atomic<bool>* stop = nullptr;    ///< read once a frame
    const std::atomic<bool>* failed = nullptr;  ///< the same; set when the stages cannot continue
    const std::atomic<bool>* left = nullptr;    ///< the same; set when the visitor has gone
    /// How often the process was continued after a stop; counted by a SIGCONT handler, see count_continues(). May be null.
    const std::atomic<std::uint32_t>* continued = nullptr;
    std::span<const pid_t> rasterisers;          ///< the driver's threads, for raster_cpu_ns and known waits
    std::span<const pid_t> rasterisers_on_core;  ///< rasterisers on the frame core; the control burns their time too
    BlameLimits limits;                          ///< period_ns is taken from above
    bool wait_for_ring = false;                  ///< virtual clock only: yields to the recorder instead of dropping records
};

/// Counts of a finished loop.
struct FrameLoopResult {
    std::uint64_t run = 0;      ///< frames, bare ones of the control included
    std::uint64_t skipped = 0;  ///< slots
    std::uint64_t elapsed = 0;  ///< slots; always run + skipped
    std::int64_t burn_ns = 0;   ///< CPU time of the last bare frames: the mean of the walk's frames on this core
};

/// Runs on the calling thread, which the caller has placed. Pushes records to `records`, in order; the ring drops and counts
/// those that do not fit. Allocates nothing.
FrameLoopResult run_frame_loop(const FrameLoopOptions& options, Clock& clock, FrameStages& stages,
                               SpscRing<FrameRecord>& records);

/// Installs the SIGCONT handler that `continued` wants, process-wide, and returns its counter.
const std::atomic<std::uint32_t>* count_continues();

}  // namespace surefoot::rt
