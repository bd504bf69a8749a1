// Memory that never faults again: locked, the allocator kept from giving pages back, stack and heap touched beforehand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rt/base/result.hpp"

namespace surefoot::rt {

struct MemoryOptions {
    bool lock = true;                        ///< mlockall, present and future
    std::size_t heap_bytes = 32U << 20U;     ///< grown, touched and kept in the calling thread's heap
    std::uint64_t growth_bytes = 1U << 30U;  ///< what the process may still map: with a finite RLIMIT_MEMLOCK, locking is refused
                                             ///< unless it leaves this much (future maps would fail instead of merely faulting)
};

/// Keeps freed memory (no trim, no mmap: 160 faults a frame become 0, research M5), touches the heap, then locks.
/// Error: locking refused, with the remedy; the rest is done all the same.
Result<void> prepare_memory(const MemoryOptions& options);
/// Undoes prepare_memory(): unlocks, and lets the allocator trim again (touched pages stay until it does).
void release_memory();

/// Grows and touches the calling thread's heap, which keeps it once prepare_memory() has been called: each thread may have one of
/// its own, and a driver's busiest frame comes late in a walk.
void prefault_heap(std::size_t bytes = 16U << 20U);

/// Touches the calling thread's stack below here. At most half of the stack is touched.
void prefault_stack(std::size_t bytes = 256U << 10U);

/// What a page fault costs here and now, so that time lost to faults can be told from work: twice the mean of a thousand first
/// touches, for machines that are busier later; 500 to 5000. Call it before memory is locked: locked pages do not fault.
std::int64_t minor_fault_cost_ns();

/// Whether this thread may lock more than RLIMIT_MEMLOCK says (no limit, or CAP_IPC_LOCK); tried out, touching nothing.
bool lock_unlimited();

/// Bytes locked in this process (/proc/self/status VmLck); 0 when unknown.
std::uint64_t locked_bytes();

}  // namespace surefoot::rt
