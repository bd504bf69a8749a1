// Inside of the guard: one thread's tier and counters, shared by the scopes and the interposed allocator.
#pragma once

#include "rt/threads/guard.hpp"

namespace surefoot::rt::detail {

/// State of one thread.
struct GuardState {
    Tier tier;
    GuardCounters counters;
};

// initial-exec: reading it never calls into the loader, which might allocate the very block that is being counted.
extern constinit thread_local GuardState guard_state __attribute__((tls_model("initial-exec")));

/// Defined beside the interposed functions, so that whoever links the guard links them too.
bool interposer_linked() noexcept;

}  // namespace surefoot::rt::detail
