// The frame loop: wake on the grid, run the stages, account, next slot.
#include "rt/frame/loop.hpp"

#include <algorithm>
#include <csignal>
#include <thread>

#include "rt/threads/guard.hpp"

namespace surefoot::rt {

namespace {

std::atomic<std::uint32_t> continues{0};

void on_continue(int /*number*/) { continues.fetch_add(1, std::memory_order_relaxed); }

/// What the loop carries from frame to frame.
struct LoopState {
    const FrameLoopOptions& options;
    Clock& clock;
    FrameStages& stages;
    ThreadClocks all_rasterisers, core_rasterisers;
    BurnMeter burn;
    std::uint32_t seen_continues = 0;
};

/// Gap between wall and CPU time that no known wait explains: stolen, or, with an involuntary switch, preempted.
void explain_gap(FrameRecord& r, const ThreadUsage& used, std::int64_t waited_ns) {
    r.cpu_ns = used.cpu_ns;
    r.voluntary = static_cast<std::uint32_t>(used.voluntary);
    r.involuntary = static_cast<std::uint32_t>(used.involuntary);
    r.waited_ns = waited_ns;
    const std::int64_t gap_ns = std::max<std::int64_t>(0, r.presented_ns - r.woken_ns - used.cpu_ns - waited_ns);
    (r.involuntary > 0 ? r.preempted_ns : r.stolen_ns) = gap_ns;
}

void run_walk_frame(LoopState& s, FrameRecord& r) {
    const GuardCounters guard_before = guard_counters();
    const ThreadUsage begun = s.clock.usage();
    s.all_rasterisers.start();
    s.core_rasterisers.start();
    {
        const OwnScope own;
        s.stages.sample(r);
        s.stages.select(r);
    }
    r.selected_ns = s.clock.now_ns();
    const ThreadUsage own_part = s.clock.usage();
    {
        const DriverScope driver;
        s.stages.submit(r);
        if (r.submitted_ns == 0) r.submitted_ns = s.clock.now_ns();
        s.stages.finish(r);
    }
    r.presented_ns = s.clock.now_ns();
    if (r.rastered_ns == 0) r.rastered_ns = r.presented_ns;
    const ThreadUsage ended = s.clock.usage();
    const ThreadUsage own = own_part - begun, driver = ended - own_part;
    const ThreadClocks::Spent raster = s.all_rasterisers.spent();
    r.raster_cpu_ns = raster.sum_ns;
    // The frame thread sleeps while rasterisers work: at most as long as the busiest of them ran.
    explain_gap(r, own + driver, raster.longest_ns);
    r.minor_faults = static_cast<std::uint32_t>(own.minor_faults);
    r.major_faults = static_cast<std::uint32_t>(own.major_faults);
    r.driver_faults = static_cast<std::uint32_t>(driver.minor_faults + driver.major_faults);
    const GuardCounters guard = guard_counters();
    r.driver_allocations = static_cast<std::uint32_t>(guard.driver_allocations - guard_before.driver_allocations);
    r.guard_violations = static_cast<std::uint32_t>(guard.own_violations - guard_before.own_violations);
    // The control burns what this core gave the walk: the frame thread, and the rasterisers that share its core.
    s.burn.add(r.cpu_ns + s.core_rasterisers.spent().sum_ns);
}

void run_bare_frame(LoopState& s, FrameRecord& r) {
    const ThreadUsage begun = s.clock.usage();
    r.control = true;
    r.selected_ns = r.woken_ns;
    s.clock.burn_ns(s.burn.mean_ns());
    r.submitted_ns = r.rastered_ns = r.presented_ns = s.clock.now_ns();
    explain_gap(r, s.clock.usage() - begun, 0);
}

void judge_frame(LoopState& s, FrameRecord& r, bool missed) {
    BlameLimits limits = s.options.limits;
    limits.period_ns = s.options.period_ns;
    r.missed = missed;
    if (s.options.continued != nullptr) {
        const std::uint32_t now = s.options.continued->load(std::memory_order_relaxed);
        r.continued = now - s.seen_continues;
        s.seen_continues = now;
    }
    if (!missed) return;
    r.cause = blame(r, limits);
    r.own_miss = is_own_miss(r, limits);
}

}  // namespace

FrameLoopResult run_frame_loop(const FrameLoopOptions& options, Clock& clock, FrameStages& stages, SpscRing<FrameRecord>& records) {
    const Grid grid{options.t0_ns != 0 ? options.t0_ns : clock.now_ns() + options.period_ns, options.period_ns};
    LoopState s{options, clock, stages, ThreadClocks(options.rasterisers), ThreadClocks(options.rasterisers_on_core), {}, 0};
    if (options.continued != nullptr) s.seen_continues = options.continued->load(std::memory_order_relaxed);
    FrameLoopResult result;
    NextSlot next{0, 0, false, 0, grid.due_ns(0)};
    while (options.frames == 0 || result.run < options.frames) {
        if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) break;
        if (options.control != nullptr && next.slot >= options.control->slots()) break;
        FrameRecord r;
        r.slot = next.slot;
        r.frame = result.run;
        r.skipped_before = next.skipped;
        r.due_ns = grid.due_ns(next.slot);
        r.deadline_ns = grid.deadline_ns(next.slot);
        r.ready_ns = next.start_ns;
        clock.sleep_until_ns(next.start_ns);
        r.woken_ns = clock.now_ns();
        if (options.control != nullptr) r.block = options.control->block_of(next.slot);
        const bool bare = options.control != nullptr && !ControlSchedule::is_walk(r.block);
        bare ? run_bare_frame(s, r) : run_walk_frame(s, r);
        next = next_slot(grid, options.late, r.slot, r.presented_ns);
        judge_frame(s, r, next.missed);
        if (!bare) {
            const OwnScope own;
            stages.account(r);
        }
        while (options.wait_for_ring && records.full()) std::this_thread::yield();
        records.try_push(r);
        ++result.run;
        result.skipped += next.skipped;
        result.elapsed = next.slot;
    }
    // The slots that the last frame ran over are elapsed too: run + skipped = elapsed, exactly.
    return result;
}

const std::atomic<std::uint32_t>* count_continues() {
    struct sigaction action {};
    action.sa_handler = on_continue;
    action.sa_flags = SA_RESTART;
    sigaction(SIGCONT, &action, nullptr);
    return &continues;
}

}  // namespace surefoot::rt
