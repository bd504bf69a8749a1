// The guard's scopes and counters.
#include "rt/threads/guard.hpp"

#include <utility>

#include "rt/threads/guard_state.hpp"

namespace surefoot::rt {

namespace detail {

constinit thread_local GuardState guard_state = {Tier::none, {}};

Tier exchange_tier(Tier tier) noexcept { return std::exchange(guard_state.tier, tier); }

}  // namespace detail

GuardCounters guard_counters() noexcept { return detail::guard_state.counters; }

bool guard_active() noexcept { return detail::interposer_linked(); }

bool in_own_scope() noexcept { return detail::guard_state.tier == detail::Tier::own; }

}  // namespace surefoot::rt
