// Blame: computes the excess of every cause from the record. A cause that alone explains the miss goes first.
#include "rt/frame/blame.hpp"

#include <algorithm>
#include <array>

namespace surefoot::rt {

namespace {

struct Excess {
    Cause cause = Cause::none;
    std::int64_t over_ns = 0;
};

std::int64_t over_share(std::int64_t spent_ns, double share, std::int64_t period_ns) {
    return spent_ns - static_cast<std::int64_t>(share * static_cast<double>(period_ns));
}

std::int64_t wake_lateness_ns(const FrameRecord& r) {
    return std::max<std::int64_t>(r.woken_ns - std::max(r.ready_ns, r.due_ns), 0);
}

/// Causes from outside the frame's own code, most specific evidence first.
std::array<Excess, 4> outside_causes(const FrameRecord& r, const BlameLimits& l) {
    const std::int64_t gap = r.stolen_ns + r.preempted_ns;
    const std::int64_t wake = over_share(wake_lateness_ns(r), l.wake_share, l.period_ns);
    const std::int64_t faults = std::int64_t{r.minor_faults} + r.driver_faults;
    // A major fault waits for a disk: it shows as a gap, of which it is the reason.
    const std::int64_t fault_cost = faults * l.minor_fault_ns + (r.major_faults > 0 ? gap : 0);
    return {{{Cause::page_fault, fault_cost},
             {Cause::preempted, r.preempted_ns},
             {Cause::stolen, r.stolen_ns},
             {Cause::woken_late, wake}}};
}

/// The excess of each phase over its share. Time that was lost (stolen, preempted) lies in some phase, most likely the one with
/// the largest excess. It is taken off there, because that phase did not cause it.
std::array<Excess, 5> phase_causes(const FrameRecord& r, const BlameLimits& l) {
    const std::int64_t t = l.period_ns;
    std::array<Excess, 5> phases = {{{Cause::select, over_share(r.selected_ns - r.woken_ns, l.select_share, t)},
                                     {Cause::upload, over_share(r.upload_ns, l.upload_share, t)},
                                     {Cause::submit, over_share(r.submitted_ns - r.selected_ns - r.upload_ns, l.submit_share, t)},
                                     {Cause::raster, over_share(r.rastered_ns - r.submitted_ns, l.raster_share, t)},
                                     {Cause::present, over_share(r.complete_ns - r.rastered_ns, l.present_share, t)}}};
    std::ranges::max_element(phases, {}, &Excess::over_ns)->over_ns -= r.stolen_ns + r.preempted_ns;
    return phases;
}

bool was_drawing(Cause cause) { return cause == Cause::submit || cause == Cause::raster || cause == Cause::upload; }

}  // namespace

Cause blame(const FrameRecord& record, const BlameLimits& limits) {
    if (!record.missed) return Cause::none;
    // A stop may fall into a wait, where no gap shows it: that it happened says enough.
    if (record.continued > 0) return Cause::stopped;
    const std::int64_t late_ns = std::max<std::int64_t>(record.complete_ns - record.deadline_ns, 1);
    const auto outside = outside_causes(record, limits);
    for (const Excess& e : outside) {
        if (e.over_ns >= late_ns) return e.cause;
    }
    const auto phases = phase_causes(record, limits);
    Excess largest = *std::ranges::max_element(phases, {}, &Excess::over_ns);
    if (largest.over_ns < late_ns) {
        const Excess& other = *std::ranges::max_element(outside, {}, &Excess::over_ns);
        if (other.over_ns > largest.over_ns) largest = other;
    }
    // The coarse levels of the last complete set were drawn: nobody had chosen them for this frame's budget.
    if (record.prepared_age > oldest_prepared(limits.period_ns) && was_drawing(largest.cause)) return Cause::prepared_too_old;
    return largest.cause;
}

bool is_shown_late(const FrameRecord& record, const BlameLimits& limits) {
    const std::int64_t shown_ns = record.shown_by == ShownBy::display ? record.shown_ns : record.presented_ns;
    return record.show_ns > 0 && over_share(shown_ns - record.show_ns, limits.present_share, limits.period_ns) > 0;
}

Cause blame_showing(const FrameRecord& record, const ShowingDelays& delays) {
    if (record.continued > 0) return Cause::stopped;
    const std::array<Excess, 4> causes = {{{Cause::preempted, delays.preempted_ns},
                                           {Cause::stolen, delays.stolen_ns},
                                           {Cause::woken_late, delays.woken_late_ns},
                                           {Cause::present, delays.beyond_lead_ns}}};
    return std::ranges::max_element(causes, {}, &Excess::over_ns)->cause;
}

bool is_own_miss(const FrameRecord& record, const BlameLimits& limits) {
    if (!record.missed) return false;
    // A stop is a gap. If the thread was also switched out against its will, the whole gap counts as preempted.
    const bool stopped = record.continued > 0;
    const std::int64_t gap_ns = record.stolen_ns + (stopped ? record.preempted_ns : 0);
    const std::int64_t taken_ns = gap_ns + (limits.fifo || stopped ? wake_lateness_ns(record) : 0);
    return record.complete_ns - taken_ns > record.deadline_ns;
}

}  // namespace surefoot::rt
