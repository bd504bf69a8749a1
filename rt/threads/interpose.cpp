// The allocator, interposed: counts for the guard, then hands on to glibc's own (glibc manual, "Replacing malloc": a program
// may define these; glibc exports its own under __libc_ names, so no lookup is needed that could itself allocate).
#include <cerrno>
#include <cstddef>

#include "rt/threads/guard_state.hpp"

#if defined(SUREFOOT_SANITIZED)

// Sanitizers interpose the allocator themselves, and two cannot.
bool surefoot::rt::detail::interposer_linked() noexcept { return false; }

#else

extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT(bugprone-reserved-identifier): glibc's names
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void*, std::size_t);         // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT(bugprone-reserved-identifier)
void __libc_free(void*);                          // NOLINT(bugprone-reserved-identifier)
}

namespace surefoot::rt::detail {

bool interposer_linked() noexcept { return true; }

namespace {

inline void record_violation(GuardState& state, std::size_t bytes, const void* caller) noexcept {
    ++state.counters.own_violations;
    state.counters.last_bytes = bytes;
    state.counters.last_caller = caller;
}

inline void record_allocation(std::size_t bytes, const void* caller) noexcept {
    GuardState& state = guard_state;
    if (state.tier == Tier::none) [[likely]]
        return;
    if (state.tier == Tier::own) {
        record_violation(state, bytes, caller);
    } else {
        ++state.counters.driver_allocations;
    }
}

inline void record_free(const void* caller) noexcept {
    GuardState& state = guard_state;
    if (state.tier == Tier::none) [[likely]]
        return;
    if (state.tier == Tier::own) {
        record_violation(state, 0, caller);
    } else {
        ++state.counters.driver_frees;
    }
}

}  // namespace

}  // namespace surefoot::rt::detail

using surefoot::rt::detail::record_allocation;
using surefoot::rt::detail::record_free;

extern "C" {

__attribute__((visibility("default"))) void* malloc(std::size_t bytes) noexcept {
    record_allocation(bytes, __builtin_return_address(0));
    return __libc_malloc(bytes);
}

__attribute__((visibility("default"))) void* calloc(std::size_t count, std::size_t bytes) noexcept {
    record_allocation(count * bytes, __builtin_return_address(0));
    return __libc_calloc(count, bytes);
}

__attribute__((visibility("default"))) void* realloc(void* memory, std::size_t bytes) noexcept {
    record_allocation(bytes, __builtin_return_address(0));
    return __libc_realloc(memory, bytes);
}

__attribute__((visibility("default"))) void free(void* memory) noexcept {
    if (memory != nullptr) record_free(__builtin_return_address(0));
    __libc_free(memory);
}

__attribute__((visibility("default"))) void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
    record_allocation(bytes, __builtin_return_address(0));
    return __libc_memalign(alignment, bytes);
}

__attribute__((visibility("default"))) void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
    record_allocation(bytes, __builtin_return_address(0));
    return __libc_memalign(alignment, bytes);
}

__attribute__((visibility("default"))) int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) noexcept {
    record_allocation(bytes, __builtin_return_address(0));
    if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0) return EINVAL;
    const int before = errno;  // posix_memalign leaves errno alone
    void* const got = __libc_memalign(alignment, bytes);
    errno = before;
    if (got == nullptr) return ENOMEM;
    *memory = got;
    return 0;
}

}  // extern "C"

#endif
