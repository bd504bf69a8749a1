// The wake-up run: a bare FIFO loop on the frame core. Our own grid and histogram count it, so that no late slot is lost.
// The same run by cyclictest (Debian's rt-tests) is read into that histogram.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "rt/clock/clock.hpp"
#include "rt/monitor/histogram.hpp"
#include "tools/doctor/machine.hpp"

namespace surefoot::doctor {

/// Settings of the wake-up run.
struct WakeOptions {
    double seconds = 10;
    std::int64_t period_ns = 1'000'000;
    int core = 0;
    int priority = 80;  ///< SCHED_FIFO; 0: ordinary scheduling
};

/// How late each slot's start was. A stall of many periods counts every slot that it ran over, each with its own lateness.
/// So the histogram's count is always run + skipped = elapsed. cyclictest and jitterdebugger lose these slots.
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

/// Where a program is on $PATH.
std::optional<std::string> find_program(const std::string& name);

/// What `cyclictest -q -h N` of one thread prints: "latency count" lines in microseconds, then '#' lines. What lay beyond its
/// last bin is counted at its maximum, so that no cycle is lost here too.
Result<WakeFigures> read_cyclictest(std::string_view printed);

/// Runs it as `program`; the machine is left as it is (--default-system), as it is for our own run.
Result<WakeFigures> run_cyclictest(const std::string& program, const WakeOptions& options, const Progress& progress);

}  // namespace surefoot::doctor
