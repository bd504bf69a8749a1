// The frame loop (loop.hpp).
#include "rt/frame/loop.hpp"

#include <sched.h>
#include <signal.h>

#include <algorithm>

#include "rt/base/check.hpp"
#include "rt/frame/frame_account.hpp"
#include "rt/frame/present_lead.hpp"
#include "rt/threads/guard.hpp"

namespace surefoot::rt {

namespace {

/// Where the loop stands.
struct LoopState {
    std::uint64_t slot = 0;
    std::uint32_t skipped_before = 0;
    std::int64_t ready_ns = 0;
    std::int64_t lead_ns = 0;  ///< what presenting usually takes
    FrameLoopResult result;
};

bool is_set(const std::atomic<bool>* flag) { return flag != nullptr && flag->load(std::memory_order_relaxed); }

bool goes_on(const FrameLoopOptions& o, const LoopState& s) {
    if (is_set(o.stop) || is_set(o.failed) || is_set(o.left)) return false;
    if (o.control != nullptr && s.slot >= o.control->slots()) return false;
    return o.frames == 0 || s.result.run < (is_set(o.prolonged) ? o.prolonged_frames : o.frames);
}

FrameRecord new_record(const FrameLoopOptions& o, const Grid& grid, const LoopState& s) {
    FrameRecord record;
    record.slot = s.slot;
    record.frame = s.result.run;
    record.due_ns = grid.due_ns(s.slot);
    record.ready_ns = s.ready_ns;
    record.deadline_ns = grid.deadline_ns(s.slot) - s.lead_ns;
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

/// The picture waits for its time, and is shown. Bare frames wait as long, and are judged alike.
Shown show(const FrameLoopOptions& o, const Grid& grid, Clock& clock, FrameStages& stages, FrameAccount& account,
           std::int64_t lead_ns, FrameRecord& record) {
    const std::int64_t shown_ns = record.complete_ns + lead_ns;  // if handed over now
    account.before_showing(record);
    std::int64_t begins_ns = clock.now_ns();
    if (o.late == LatePolicy::lock) {
        record.show_ns = next_slot(grid, o.late, record.slot, shown_ns).shown_ns;
        const std::int64_t planned_ns = record.show_ns - (record.control ? 0 : lead_ns);
        if (planned_ns > begins_ns) {
            clock.sleep_until_ns(planned_ns);
            begins_ns = planned_ns;
        }
    } else {
        record.show_ns = std::max(grid.deadline_ns(record.slot), shown_ns);
    }
    account.present_begins(record, begins_ns);
    Shown shown;
    if (!record.control) {
        const DriverScope driver;
        shown = stages.present(record);
    }
    const bool missed = record.missed;
    account.present_ended(record, shown, lead_ns);
    if (record.missed && !missed && !record.control) stages.shown_late(record);
    return shown;
}

/// The end of the frame that the next slot is reckoned from.
std::int64_t ended_ns(const FrameLoopOptions& o, const BlameLimits& limits, const FrameRecord& r) {
    if (!o.shows) return r.complete_ns;
    if (o.late == LatePolicy::floating) return r.presented_ns;
    if (!is_shown_late(r, limits)) return r.show_ns;
    // A display that tells has shown it on a point of the grid, give or take its own clock; what is left is presenting's.
    return r.shown_by == ShownBy::display ? std::max(r.show_ns, r.shown_ns - shown_tolerance_ns(limits)) : r.presented_ns;
}

/// What presenting took of the slot that begins at start_ns. A late wake-up for it is no part.
std::int64_t taken_by_presenting_ns(const FrameRecord& r, std::int64_t start_ns) {
    return std::max<std::int64_t>(0, r.presented_ns - std::max({r.handed_ns, r.show_ns, start_ns}));
}

/// A picture that was handed over at its time, and missed its refresh, needed more.
void learn_lead(const FrameRecord& r, const Shown& shown, const BlameLimits& limits, std::int64_t lead_ns, PresentLead& lead) {
    if (r.control) return;
    if (r.shown_by != ShownBy::display) return lead.add(r.presented_ns - r.handed_ns);
    if (shown.queued_ns != 0) lead.add(shown.queued_ns - r.handed_ns);
    constexpr std::int64_t disturbed_ns = 200'000;
    const bool in_time = r.handed_ns <= r.show_ns - lead_ns + disturbed_ns;
    if (in_time && r.stolen_ns + r.preempted_ns < disturbed_ns) lead.add_flip(is_shown_late(r, limits));
}

void hand_over(const FrameLoopOptions& o, const FrameRecord& record, SpscRing<FrameRecord>& records) {
    while (o.wait_for_ring && records.full()) sched_yield();
    records.try_push(record);
}

std::atomic<std::uint32_t> continue_count{0};

}  // namespace

FrameLoopResult run_frame_loop(const FrameLoopOptions& options, Clock& clock, FrameStages& stages,
                               SpscRing<FrameRecord>& records) {
    Grid grid{options.t0_ns != 0 ? options.t0_ns : clock.now_ns() + options.period_ns, options.period_ns};
    const OwnScope own;
    FrameAccount account(options, clock);
    BurnMeter burn;
    PresentLead lead(options.period_ns, options.display != nullptr);
    LoopState s;
    s.lead_ns = lead.ns();
    s.ready_ns = grid.t0_ns;
    while (goes_on(options, s)) {
        FrameRecord record = new_record(options, grid, s);
        clock.sleep_until_ns(s.ready_ns);
        if (record.control) {
            bare_frame(clock, burn.mean_ns(), account, record);
        } else {
            walk_frame(clock, stages, account, record);
            // The clocks of its threads together may count more than the frame lasted. No core is busy for longer.
            burn.add(std::min(account.core_cpu_ns(), record.complete_ns - record.woken_ns));
        }
        if (options.shows) {
            const Shown shown = show(options, grid, clock, stages, account, s.lead_ns, record);
            learn_lead(record, shown, account.limits(), s.lead_ns, lead);
        }
        account.before_push(record);
        hand_over(options, record, records);

        NextSlot next = next_slot(grid, options.late, s.slot, ended_ns(options, account.limits(), record));
        CHECK(next.slot > s.slot, "The next slot comes after this one");
        if (options.display != nullptr && record.shown_by == ShownBy::display) {
            grid = options.display->follow(grid, record.shown_ns, next.slot);
            const std::int64_t due_ns = grid.due_ns(next.slot);
            next.start_ns = options.late == LatePolicy::lock ? due_ns : std::max(next.start_ns, due_ns);
        }
        s.slot = next.slot;
        s.skipped_before = next.skipped;
        s.ready_ns = next.start_ns + taken_by_presenting_ns(record, next.start_ns);
        s.lead_ns = lead.ns();
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
