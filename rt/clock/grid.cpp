// The frame grid and the late policies.
#include "rt/clock/grid.hpp"

namespace surefoot::rt {

std::optional<LatePolicy> parse_late_policy(std::string_view name) {
    if (name == "lock") return LatePolicy::lock;
    if (name == "float") return LatePolicy::floating;
    return std::nullopt;
}

NextSlot next_slot(const Grid& grid, LatePolicy policy, std::uint64_t slot, std::int64_t done_ns) {
    const std::int64_t deadline_ns = grid.due_ns(slot + 1);
    if (done_ns <= deadline_ns) return {slot + 1, 0, deadline_ns, deadline_ns};
    const std::uint64_t reached = grid.slot_at(done_ns);  // > slot
    if (policy == LatePolicy::floating) return {reached, reached - slot - 1, done_ns, done_ns};
    // Exactly on a grid point counts as that point; otherwise the one after.
    const std::uint64_t next = grid.due_ns(reached) == done_ns ? reached : reached + 1;
    return {next, next - slot - 1, grid.due_ns(next), grid.due_ns(next)};
}

}  // namespace surefoot::rt
