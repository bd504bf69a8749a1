// The frame grid's arithmetic: whole nanoseconds only, so that a slot's time never depends on how it was reached.
#include "rt/clock/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rt/base/check.hpp"

namespace surefoot::rt {

Result<std::int64_t> period_of_rate_ns(double rate_hz) {
    if (!(rate_hz >= 0.1 && rate_hz <= 1000.0))
        return Error{"frame rate", fmt::format("The rate of {} Hz is not within 0.1 to 1000", rate_hz),
                     "Choose a rate such as 30, 59.94 or 60", ErrorKind::misuse};
    return static_cast<std::int64_t>(std::llround(1e9 / rate_hz));
}

NextSlot next_slot(const Grid& grid, LatePolicy late, std::uint64_t slot, std::int64_t finished_ns) {
    CHECK(grid.period_ns > 0, "The period of a grid is above zero");
    const std::int64_t deadline = grid.deadline_ns(slot);
    NextSlot next;
    if (finished_ns <= deadline) {
        next.slot = slot + 1;
        next.shown_ns = late == LatePolicy::lock ? deadline : finished_ns;
        next.start_ns = deadline;
        return next;
    }
    next.missed = true;
    const auto over = static_cast<std::uint64_t>(finished_ns - deadline);  // > 0
    const auto period = static_cast<std::uint64_t>(grid.period_ns);
    if (late == LatePolicy::lock) {
        next.slot = slot + 1 + (over + period - 1) / period;
        next.shown_ns = next.start_ns = grid.due_ns(next.slot);
    } else {
        next.slot = slot + 1 + over / period;
        next.shown_ns = next.start_ns = finished_ns;
    }
    next.skipped = static_cast<std::uint32_t>(std::min<std::uint64_t>(next.slot - slot - 1, UINT32_MAX));
    return next;
}

}  // namespace surefoot::rt
