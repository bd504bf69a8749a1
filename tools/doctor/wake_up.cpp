// The wake-up run, and what it must not exceed.
#include "tools/doctor/wake_up.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

#include "rt/clock/grid.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "rt/threads/usage.hpp"
#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

constexpr double p99_limit_us = 1000;      // 3 % of a frame at 30 Hz
constexpr double longest_limit_us = 8333;  // half of a frame at 60 Hz

/// Since boot; -1: not known.
double steal_ms(int core) {
    const auto steal = rt::read_steal();
    const auto index = static_cast<std::size_t>(core);
    return steal && core >= 0 && index < steal->cpu_ms.size() ? steal->cpu_ms[index] : -1;
}

/// FIFO on the core, else only the core; the priority that was granted.
int place(const WakeOptions& o) {
    rt::Placement placement;
    placement.cpus = rt::CpuMask{o.core};
    placement.name = "sf-wake";
    if (o.priority > 0) {
        placement.policy = rt::Policy::fifo;
        placement.priority = o.priority;
        if (rt::place_thread(0, placement)) return o.priority;
    }
    placement.policy = rt::Policy::other;
    placement.priority = 0;
    (void)rt::place_thread(0, placement);
    return 0;
}

std::string in_words(const WakeFigures& f) {
    std::string text = fmt::format("p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, max {:.0f} us over {} slots of 1 ms", f.p50_us,
                                   f.p99_us, f.p999_us, f.max_us, f.slots);
    if (f.skipped > 0) text += fmt::format(", {} skipped", f.skipped);
    if (f.steal_ms >= 0) text += fmt::format("; {:.0f} ms stolen during the run", f.steal_ms);
    return text;
}

Finding not_run() { return unknown("not measured", "run surefoot doctor on the machine itself, without --quick"); }

Finding usual(const Machine& m) {
    const auto& f = m.probed().wake_up;
    if (!f || f->slots == 0) return not_run();
    if (f->priority == 0)
        return fail("measured without SCHED_FIFO, because it was refused: " + in_words(*f), "see the check limits.fifo_tried");
    if (f->p99_us <= p99_limit_us) return pass(in_words(*f));
    return fail(in_words(*f),
                "fix the failed checks of kernel, interrupts and power; then, as root, rtla timerlat top -a 500 names the cause");
}

Finding longest(const Machine& m) {
    const auto& f = m.probed().wake_up;
    if (!f || f->slots == 0) return not_run();
    std::string evidence = fmt::format("the latest of {} wake-ups was {:.1f} ms late; half a frame at 60 Hz is {:.1f} ms",
                                       f->slots, f->max_us / 1000, longest_limit_us / 1000);
    if (f->max_us <= longest_limit_us) return pass(std::move(evidence));
    return fail(std::move(evidence), f->steal_ms > 0
                                         ? "the host stole time during the run: see the checks time.hypervisor and time.steal"
                                         : "as root: hwlatdetect --duration=60 (firmware), rtla timerlat top -a 500 (kernel)");
}

constexpr std::array all_wake_up_checks = {
    Check{"wake_up.usual", "wake-ups: p99 within 1 ms", usual},
    Check{"wake_up.longest", "no wake-up is half a frame late", longest},
};

}  // namespace

std::span<const Check> wake_up_checks() { return all_wake_up_checks; }

void count_wakes(rt::Clock& clock, std::int64_t period_ns, std::uint64_t slots, const std::atomic<bool>* stop, WakeCount& count) {
    const rt::Grid grid{clock.now_ns() + period_ns, period_ns};
    std::uint64_t slot = 0;
    while (slot < slots && (stop == nullptr || !stop->load(std::memory_order_relaxed))) {
        clock.sleep_until_ns(grid.due_ns(slot));
        const std::int64_t now = clock.now_ns();
        const rt::NextSlot next = rt::next_slot(grid, rt::LatePolicy::lock, slot, now);
        for (std::uint64_t passed = slot; passed < next.slot; ++passed) count.late.add(now - grid.due_ns(passed));
        ++count.run;
        count.skipped += next.skipped;
        slot = count.elapsed = next.slot;
    }
}

WakeFigures figures_of(const rt::Histogram& late_ns, std::string source) {
    const auto us = [&](double q) { return static_cast<double>(late_ns.quantile(q)) / 1000; };
    WakeFigures f;
    f.source = std::move(source);
    f.slots = late_ns.count();
    f.p50_us = us(0.5);
    f.p99_us = us(0.99);
    f.p999_us = us(0.999);
    f.max_us = us(1);
    return f;
}

WakeFigures run_wake_up(const WakeOptions& o, const Progress& progress) {
    const rt::SavedLimits limits = rt::raise_limits(o.priority);
    // Locked as a walk is; under sanitizers it cannot be.
    if (rt::guard_active()) (void)rt::prepare_memory({.lock = true, .heap_bytes = 1U << 20U});
    const auto count = std::make_unique<WakeCount>();
    const auto slots = static_cast<std::uint64_t>(o.seconds * 1e9 / static_cast<double>(o.period_ns));
    std::atomic<bool> done{false};
    int granted = 0;
    const double stolen_before = steal_ms(o.core);
    const auto begun = std::chrono::steady_clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(); };
    std::thread loop([&] {
        granted = place(o);
        rt::prefault_stack();
        rt::RealClock clock;
        count_wakes(clock, o.period_ns, slots, progress.stop, *count);
        done.store(true);
    });
    while (!done.load()) {
        if (progress.report) progress.report("waking up", std::min(passed() / o.seconds, 1.0));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    loop.join();
    const double seconds = passed(), stolen = steal_ms(o.core);
    if (rt::guard_active()) rt::release_memory();
    rt::restore_limits(limits);
    WakeFigures f = figures_of(count->late, "surefoot");
    f.seconds = seconds;
    f.skipped = count->skipped;
    f.core = o.core;
    f.priority = granted;
    f.steal_ms = stolen_before >= 0 && stolen >= 0 ? stolen - stolen_before : -1;
    return f;
}

}  // namespace surefoot::doctor
