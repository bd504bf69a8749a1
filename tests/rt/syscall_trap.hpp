// Proof of the frame thread's system calls: a per-thread seccomp filter that counts and names what own code should not call.
// For tests: a trapped call costs a signal and is then carried out.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::rt {

/// What a frame thread may call in its own code: sleeping, clocks, usage. Clock readings through the vDSO are no calls.
std::span<const long> frame_thread_system_calls();

/// Of the calling thread.
struct TrapCounters {
    std::uint64_t own = 0;    ///< trapped inside an OwnScope
    std::uint64_t other = 0;  ///< trapped elsewhere: driver calls, set-up
    long first_own = -1;      ///< number of the first own one
    long last_own = -1;
};

/// From now on, and for ever, system calls of the calling thread (and of threads that it makes) that are not in `allowed`
/// are trapped and counted. Error: seccomp refused, or not this processor. Process-wide: takes SIGSYS.
Result<void> trap_system_calls(std::span<const long> allowed);
TrapCounters trap_counters() noexcept;
/// "mmap", or "system call 999".
std::string system_call_name(long number);

}  // namespace surefoot::rt
