// The frame grid: the slot of a frame, its due time, and the next slot. Pure functions of injected time.
#pragma once

#include <cstdint>

#include "rt/base/modes.hpp"
#include "rt/base/result.hpp"

namespace surefoot::rt {

/// Slot k is due (may start) at t0 + (k - slot0) * period, and its deadline is due + period. Integer nanoseconds: no drift.
struct Grid {
    std::int64_t t0_ns = 0;
    std::int64_t period_ns = 1;  ///< > 0
    std::uint64_t slot0 = 0;     ///< due at t0: 0, unless a display moves the grid

    [[nodiscard]] constexpr std::int64_t due_ns(std::uint64_t slot) const {
        return t0_ns + static_cast<std::int64_t>(slot - slot0) * period_ns;
    }
    [[nodiscard]] constexpr std::int64_t deadline_ns(std::uint64_t slot) const { return due_ns(slot) + period_ns; }
};

/// The period of a rate, in whole nanoseconds. The rate may be fractional (59.94). Error: not within 0.1 to 1000 Hz.
Result<std::int64_t> period_of_rate_ns(double rate_hz);

/// The slot after a frame.
struct NextSlot {
    std::uint64_t slot = 0;     ///< the next frame's
    std::uint32_t skipped = 0;  ///< slots between the two
    bool missed = false;        ///< finished after its deadline (exactly on it is in time)
    std::int64_t shown_ns = 0;  ///< when the frame appears
    std::int64_t start_ns = 0;  ///< earliest start of the next frame: its due time, or (floating, late) the finish
};

/// The slot after the frame of `slot`, finished at finished_ns. A stall of any length (a stopped process, a stolen core)
/// is one call. The late frame counts as run, and every slot that it ran over as skipped.
/// After any sequence of frames from slot s: run + skipped = next.slot - s, exactly.
NextSlot next_slot(const Grid& grid, LatePolicy late, std::uint64_t slot, std::int64_t finished_ns);

}  // namespace surefoot::rt
