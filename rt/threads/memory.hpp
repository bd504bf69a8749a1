// Prevents page faults: locks memory, keeps the allocator from returning pages, and touches stack and heap beforehand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rt/base/result.hpp"

namespace surefoot::rt {

/// What is locked and touched before the walk.
struct MemoryOptions {
    bool lock = true;                        ///< mlockall, present and future
    std::size_t heap_bytes = 32U << 20U;     ///< touched and kept in the calling thread's heap
    std::uint64_t growth_bytes = 1U << 30U;  ///< memory that the process may map later; locking is refused if a finite
                                             ///< RLIMIT_MEMLOCK leaves less, because later maps would fail
};

/// Keeps freed memory (no trim, no mmap), touches the heap, then locks. Without it a frame had 160 page faults.
/// Error: locking is refused, with the remedy. The other steps are done in any case.
Result<void> prepare_memory(const MemoryOptions& options);
/// Undoes prepare_memory(): unlocks, and lets the allocator trim again (touched pages stay until it does).
void release_memory();

/// Grows and touches the calling thread's heap, which keeps the memory after prepare_memory(). Call it on each thread with a heap
/// of its own: a driver's busiest frame may come late in a walk.
void prefault_heap(std::size_t bytes = 16U << 20U);

/// Touches the calling thread's stack below here. At most half of the stack is touched.
void prefault_stack(std::size_t bytes = 256U << 10U);

/// Cost of a minor page fault, ns: twice the mean of a thousand first touches, as the machine may be busier later. Clamped to 500
/// to 5000. Call it before memory is locked: locked pages do not fault.
std::int64_t minor_fault_cost_ns();

/// Whether this thread may lock memory without limit: no RLIMIT_MEMLOCK, or CAP_IPC_LOCK. Tests it without side effects.
bool lock_unlimited();

/// Bytes locked in this process (/proc/self/status VmLck); 0 when unknown.
std::uint64_t locked_bytes();

}  // namespace surefoot::rt
