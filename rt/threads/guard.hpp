// Two tiers of memory: the frame thread's own code must not allocate; driver calls may, and are counted apart.
// malloc, calloc, realloc, free and the aligned forms are interposed in every program that links this room. Outside the scopes
// this costs one thread-local comparison. Sanitizers interpose themselves: then nothing is counted, see guard_active().
#pragma once

#include <cstddef>
#include <cstdint>

namespace surefoot::rt {

/// Counters of the calling thread since it started. Every allocation and every free counts.
struct GuardCounters {
    std::uint64_t own_violations = 0;      ///< allocations and frees inside an OwnScope
    std::uint64_t driver_allocations = 0;  ///< inside a DriverScope
    std::uint64_t driver_frees = 0;
    const void* last_caller = nullptr;  ///< code address of the last violation (for addr2line or dladdr)
    std::size_t last_bytes = 0;         ///< its size; 0 for a free
};

/// Never allocates.
GuardCounters guard_counters() noexcept;
/// Whether allocations are counted in this build.
bool guard_active() noexcept;

namespace detail {
enum class Tier : std::uint8_t { none, own, driver };
Tier exchange_tier(Tier tier) noexcept;
}  // namespace detail

/// While it lives, an allocation or free of the calling thread is a violation. Scopes nest; the innermost counts.
class OwnScope {
public:
    OwnScope() noexcept : before_(detail::exchange_tier(detail::Tier::own)) {}
    ~OwnScope() { detail::exchange_tier(before_); }
    OwnScope(const OwnScope&) = delete;
    OwnScope& operator=(const OwnScope&) = delete;

private:
    detail::Tier before_;
};

/// While it lives, allocations are the driver's.
class DriverScope {
public:
    DriverScope() noexcept : before_(detail::exchange_tier(detail::Tier::driver)) {}
    ~DriverScope() { detail::exchange_tier(before_); }
    DriverScope(const DriverScope&) = delete;
    DriverScope& operator=(const DriverScope&) = delete;

private:
    detail::Tier before_;
};

/// Whether the calling thread is inside an OwnScope (and not in a DriverScope within it).
bool in_own_scope() noexcept;

}  // namespace surefoot::rt
