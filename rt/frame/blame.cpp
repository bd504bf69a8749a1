// The one cause of a missed frame.
#include "rt/frame/blame.hpp"

#include <algorithm>
#include <array>

namespace surefoot::rt {

namespace {

/// What would be gained if this cause had not been.
struct Suspect {
    Cause cause;
    std::int64_t ns;
};

std::int64_t over(std::int64_t spent_ns, double share, std::int64_t period_ns) {
    return spent_ns - static_cast<std::int64_t>(share * static_cast<double>(period_ns));
}

}  // namespace

Cause blame(const FrameRecord& r, const BlameLimits& limits) {
    const std::int64_t late_ns = r.presented_ns - r.deadline_ns;
    if (!r.missed && late_ns <= 0) return Cause::none;
    const std::int64_t period = limits.period_ns;
    if (r.continued > 0) return Cause::stopped;
    const std::int64_t faults_ns = static_cast<std::int64_t>(r.minor_faults) * limits.minor_fault_ns + (r.major_faults > 0 ? period : 0);
    // Most specific evidence first; within the phases the one furthest over its share.
    const std::array<Suspect, 4> evidence = {{
        {Cause::page_fault, faults_ns},
        {Cause::preempted, r.preempted_ns},
        {Cause::stolen, r.stolen_ns},
        {Cause::woken_late, over(r.woken_ns - std::max(r.due_ns, r.ready_ns), limits.wake_share, period)},
    }};
    for (const Suspect& s : evidence) {
        if (s.ns > 0 && s.ns >= late_ns) return s.cause;
    }
    std::array<Suspect, 5> phases = {{
        {Cause::select, over(r.selected_ns - r.woken_ns, limits.select_share, period)},
        {Cause::upload, over(r.upload_ns, limits.upload_share, period)},
        {Cause::submit, over(r.submitted_ns - r.selected_ns - r.upload_ns, limits.submit_share, period)},
        {Cause::raster, over(r.rastered_ns - r.submitted_ns, limits.raster_share, period)},
        {Cause::present, over(r.presented_ns - r.rastered_ns, limits.present_share, period)},
    }};
    std::stable_sort(phases.begin(), phases.end(), [](const Suspect& a, const Suspect& b) { return a.ns > b.ns; });
    if (phases[0].ns >= late_ns && phases[0].ns > 0) return phases[0].cause;
    if (r.prepared_age > limits.oldest_prepared) return Cause::prepared_too_old;
    // None would do alone: what took the most over its share.
    Suspect most = phases[0];
    for (const Suspect& s : evidence) {
        if (s.ns > most.ns) most = s;
    }
    return most.cause;
}

bool is_own_miss(const FrameRecord& r, const BlameLimits& limits) {
    const std::int64_t late_ns = r.presented_ns - r.deadline_ns;
    if (late_ns <= 0) return false;
    const std::int64_t wake_ns = limits.fifo ? std::max<std::int64_t>(0, r.woken_ns - std::max(r.due_ns, r.ready_ns)) : 0;
    return late_ns > std::max<std::int64_t>(0, r.stolen_ns) + wake_ns;
}

}  // namespace surefoot::rt
