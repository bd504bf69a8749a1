// The frame loop (loop.hpp).
#include "rt/frame/loop.hpp"

#include <sched.h>
#include <signal.h>

#include "rt/base/check.hpp"
#include "rt/frame/frame_account.hpp"
#include "rt/threads/guard.hpp"

namespace surefoot::rt {

namespace {

/// Where the loop stands.
struct LoopState {
    std::uint64_t slot = 0;
    std::uint32_t skipped_before = 0;
    std::int64_t ready_ns = 0;
    FrameLoopResult result;
};

bool goes_on(const FrameLoopOptions& o, const LoopState& s) {
    if (o.stop != nullptr && o.stop->load(std::memory_order_relaxed)) return false;
    if (o.failed != nullptr && o.failed->load(std::memory_order_relaxed)) return false;
    if (o.control != nullptr && s.slot >= o.control->slots()) return false;
    return o.frames == 0 || s.result.run < o.frames;
}

FrameRecord new_record(const FrameLoopOptions& o, const Grid& grid, const LoopState& s) {
    FrameRecord record;
    record.slot = s.slot;
    record.frame = s.result.run;
    record.due_ns = grid.due_ns(s.slot);
    record.ready_ns = s.ready_ns;
    record.deadline_ns = grid.deadline_ns(s.slot);
    record.skipped_before = s.skipped_before;
    if (o.control != nullptr) {
        record.block = o.control->block_of(s.slot);
        record.control = !ControlSchedule::is_walk(record.block);
    }
    return record;
}

void walk_frame(Clock& clock, FrameStages& stages, FrameAccount& account, FrameRecord& record) {
    account.begin(record);
    stages.sample(record);
    stages.select(record);
    account.own_done(record);
    {
        const DriverScope driver;
        stages.submit(record);
        if (record.submitted_ns == 0) record.submitted_ns = clock.now_ns();
        stages.finish(record);
    }
    account.driver_done(record);
    account.close(record);
    stages.account(record);
}

void bare_frame(Clock& clock, std::int64_t burn_ns, FrameAccount& account, FrameRecord& record) {
    account.begin(record);
    clock.burn_ns(burn_ns);
    account.own_done(record);
    account.driver_done(record);
    account.close(record);
}

void hand_over(const FrameLoopOptions& o, const FrameRecord& record, SpscRing<FrameRecord>& records) {
    while (o.wait_for_ring && records.full()) sched_yield();
    records.try_push(record);
}

std::atomic<std::uint32_t> continue_count{0};

}  // namespace

FrameLoopResult run_frame_loop(const FrameLoopOptions& options, Clock& clock, FrameStages& stages,
                               SpscRing<FrameRecord>& records) {
    const Grid grid{options.t0_ns != 0 ? options.t0_ns : clock.now_ns() + options.period_ns, options.period_ns};
    const OwnScope own;
    FrameAccount account(options, clock);
    BurnMeter burn;
    LoopState s;
    s.ready_ns = grid.t0_ns;
    while (goes_on(options, s)) {
        FrameRecord record = new_record(options, grid, s);
        clock.sleep_until_ns(s.ready_ns);
        if (record.control) {
            bare_frame(clock, burn.mean_ns(), account, record);
        } else {
            walk_frame(clock, stages, account, record);
            burn.add(account.core_cpu_ns());
        }
        account.before_push(record);
        hand_over(options, record, records);

        const NextSlot next = next_slot(grid, options.late, s.slot, record.presented_ns);
        CHECK(next.slot > s.slot, "The next slot comes after this one");
        s.slot = next.slot;
        s.skipped_before = next.skipped;
        s.ready_ns = next.start_ns;
        ++s.result.run;
        s.result.skipped += next.skipped;
        s.result.elapsed = next.slot;
    }
    s.result.burn_ns = burn.mean_ns();
    return s.result;
}

const std::atomic<std::uint32_t>* count_continues() {
    struct sigaction action {};
    action.sa_handler = [](int) { continue_count.fetch_add(1, std::memory_order_relaxed); };
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGCONT, &action, nullptr);
    return &continue_count;
}

}  // namespace surefoot::rt
