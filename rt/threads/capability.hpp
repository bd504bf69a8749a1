// What this machine grants to real-time work, what it lacks, and how to grant it. Every lack is reported.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/result.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::rt {

/// Kinds of lacks.
enum class LackKind : std::uint8_t {
    fifo,
    memory_lock,
    isolated_core,
    throttled,
    placing,     ///< a thread is not where it should be
    cost_table,  ///< missing, or another machine's
    switched_off,
    census,
    sanitizer,
    other
};

/// A missing real-time resource: a sentence for people, and how to grant it.
struct Lack {
    LackKind kind = LackKind::other;
    std::string what;
    std::string remedy;  ///< may be empty

    /// "What is missing. How to grant it.", as Error::text().
    [[nodiscard]] std::string text() const { return Error{{}, what, remedy}.text(); }
};

/// Read from the system; unknown numbers are -1.
struct Capabilities {
    int fifo_priority = 0;            ///< highest SCHED_FIFO priority granted, tried out; 0: refused
    bool can_lock = false;            ///< mlock granted without a limit that matters (1 GiB)
    std::int64_t memlock_bytes = -1;  ///< RLIMIT_MEMLOCK, soft; -1: unlimited, or privileged
    CpuMask allowed, isolated;        ///< isolated: as isolated_cpus(), so it may lie outside of `allowed`
    std::int64_t rt_runtime_us = -1;  ///< -1: no throttling
    std::int64_t rt_period_us = 1000000;
    std::int64_t rttime_us = -1;  ///< RLIMIT_RTTIME, soft; -1 unlimited
    bool preempt_rt = false;
    bool virtual_machine = false;
    std::vector<Lack> lacking;  ///< from the above; empty: nothing is missing
};

/// Isolated cores, by the kernel's list, that this process may use: those in `allowed`, and those that a helper thread gets when
/// it asks.
CpuMask isolated_cpus(const CpuMask& allowed, const std::string& root = "");
/// Pure: the default core of the frame thread: the last of isolated_cpus(), else the last allowed one; -1 if there is none.
int default_frame_core(const CpuMask& allowed, const CpuMask& isolated);

/// Tries FIFO on a helper thread, and reads limits, /proc and /sys. wanted_priority: that of the frame thread.
/// root: where /proc and /sys lie, for tests.
Capabilities probe_capabilities(int wanted_priority, const std::string& root = "");
/// Pure: the lacks, from the other members.
std::vector<Lack> find_lacking(const Capabilities& c, int wanted_priority);

/// Former limits, for restore_limits().
struct SavedLimits {
    std::uint64_t rtprio_soft = 0, rtprio_hard = 0, rttime_soft = 0, rttime_hard = 0, memlock_soft = 0, memlock_hard = 0;
};
/// Raises RLIMIT_RTPRIO, RTTIME and MEMLOCK as far as allowed (the hard limit too, where privileged). Never fails: what
/// stays low shows up in probe_capabilities().
SavedLimits raise_limits(int wanted_priority);
void restore_limits(const SavedLimits& limits);

}  // namespace surefoot::rt
