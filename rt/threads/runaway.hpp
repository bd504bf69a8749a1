// Guard against real-time threads that never sleep and starve all others. The kernel counts their time (RLIMIT_RTTIME) and sends
// SIGXCPU; the handler takes the thread's real-time priority at once.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::rt {

/// Maximum time of a real-time thread without sleep, for this frame period: longer than a frame, shorter than a second.
std::int64_t runaway_limit_us(std::int64_t period_ns);

/// Process-wide: from now on, a real-time thread that runs `limit_us` without sleep gets SCHED_OTHER, and runaway_seen() names
/// it. The kernel counts in ticks of 1 to 10 ms. Error: the limit cannot be set.
Result<void> guard_runaways(std::int64_t limit_us);

/// A real-time thread that was demoted.
struct Runaway {
    pid_t tid = 0;  ///< 0: unknown, and no thread was demoted
    std::string name;
    bool demoted = false;
};
/// The first such thread, if any.
std::optional<Runaway> runaway_seen();

}  // namespace surefoot::rt
