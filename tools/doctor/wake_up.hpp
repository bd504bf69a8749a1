// The wake-up run: a bare FIFO loop on the frame core, counted by our own grid and histogram so that no late slot is lost.
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/base/progress.hpp"
#include "rt/clock/clock.hpp"
#include "rt/monitor/histogram.hpp"
#include "tools/doctor/machine.hpp"

namespace surefoot::doctor {

struct WakeOptions {
    double seconds = 10;
    std::int64_t period_ns = 1'000'000;
    int core = 0;
    int priority = 80;  ///< SCHED_FIFO; 0: ordinary scheduling
};

/// How late each slot's start was. A stall of many periods counts every slot that it ran over, each with its own lateness, so
/// the histogram's count is always run + skipped = elapsed (cyclictest and jitterdebugger lose them).
struct WakeCount {
    rt::Histogram late;  ///< nanoseconds
    std::uint64_t run = 0, skipped = 0, elapsed = 0;
};

/// Runs until `slots` have passed, or `stop` (may be null) is set. Allocates nothing; writes `count` only.
void count_wakes(rt::Clock& clock, std::int64_t period_ns, std::uint64_t slots, const std::atomic<bool>* stop, WakeCount& count);

/// The quantiles, in microseconds.
WakeFigures figures_of(const rt::Histogram& late_ns, std::string source);

/// On a thread made for it; progress and stop by `progress`. What is refused (FIFO, the core) shows in the figures.
WakeFigures run_wake_up(const WakeOptions& options, const Progress& progress);

}  // namespace surefoot::doctor
