// Claims real time, and lists what it lacks.
#include "tools/walk/real_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <thread>

#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"

namespace surefoot::walk {

namespace {

/// The frame thread's own placing, tried on a thread that ends at once.
std::optional<Error> placing_refused(const PlacingPlan& plan) {
    std::optional<Error> refused;
    std::thread([&] {
        if (auto placed = rt::place_thread(0, frame_placement(plan)); !placed) refused = placed.error();
    }).join();
    return refused;
}

}  // namespace

Result<PlacingPlan> claim_real_time(const WalkRequest& request, bool real_clock, WalkFacts& facts) {
    if (!real_clock) {
        auto plan = plan_placing(request, false);
        if (plan) plan->fifo = false;
        return plan;
    }
    rt::raise_limits(request.frame_priority);
    const rt::Capabilities c = rt::probe_capabilities(request.frame_priority);
    auto plan = plan_placing(request, c.fifo_priority >= request.frame_priority);
    if (!plan) return plan;
    using enum rt::LackKind;
    const auto lack = [&](rt::LackKind kind, const std::string& what, const std::string& remedy) {
        facts.degraded.push_back({kind, what, remedy});
    };
    rt::Capabilities wanted = c;  // a walk without FIFO does not lack it
    if (!request.fifo) wanted.fifo_priority = request.frame_priority;
    facts.degraded = rt::find_lacking(wanted, request.frame_priority);
    if (!request.fifo) lack(switched_off, "Real-time scheduling is switched off", "Remove --no-fifo");
    if (plan->absent_core >= 0) {
        lack(placing,
             fmt::format("Frame core {} does not exist, or this process may not use it: core {} is used", plan->absent_core,
                         plan->frame_core),
             "Choose one of " + plan->all.text() + " with --frame-core");
    }
    facts.isolated = c.isolated.has(plan->frame_core);
    if (!facts.isolated && !c.isolated.empty()) {
        lack(isolated_core, fmt::format("The frame core {} is not isolated", plan->frame_core),
             fmt::format("Use --frame-core {}", c.isolated.cpus().back()));
    }
    if (auto refused = placing_refused(*plan)) lack(placing, refused->place + ": " + refused->what, refused->remedy);
    if (!rt::guard_active()) {
        lack(sanitizer, "This is a sanitizer build: allocations are not guarded, memory is not locked", "Use the release build");
        return plan;
    }
    facts.minor_fault_ns = rt::minor_fault_cost_ns();  // before locking: then nothing faults
    auto locked = rt::prepare_memory({});
    facts.locked = locked.ok();
    // If locking is forbidden, the list names that limit already.
    if (!locked && c.can_lock) lack(memory_lock, locked.error().place + ": " + locked.error().what, locked.error().remedy);
    return plan;
}

Result<void> require_real_time(std::span<const rt::Lack> lacks) {
    if (lacks.empty()) return {};
    std::string all;
    for (const rt::Lack& lack : lacks) {
        all += (all.empty() ? "" : " ") + lack.text();
        all += full_stop_after(all);
    }
    return Error{"--strict", "The walk does not start: " + all,
                 "Grant these. Without --strict the walk starts and its figures are marked", ErrorKind::no_real_time};
}

}  // namespace surefoot::walk
