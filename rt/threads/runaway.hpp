// A real-time thread that never sleeps starves everything below it: the kernel counts its time (RLIMIT_RTTIME), SIGXCPU reaches
// it there, and it loses its real-time priority before anything else is decided.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::rt {

/// How long a real-time thread may run without sleeping where the frames have this period: above what a frame may take, below a
/// second.
std::int64_t runaway_limit_us(std::int64_t period_ns);

/// Process-wide: from now on a real-time thread that runs `limit_us` without sleeping is put under SCHED_OTHER, and
/// runaway_seen() names it. The kernel counts in ticks (1 to 10 ms). Error: the limit cannot be set.
Result<void> guard_runaways(std::int64_t limit_us);

struct Runaway {
    pid_t tid = 0;  ///< 0: it could not be told which; nothing was demoted
    std::string name;
    bool demoted = false;
};
/// The first one, once it has happened.
std::optional<Runaway> runaway_seen();

}  // namespace surefoot::rt
