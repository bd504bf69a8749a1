// Growth of steal between readings, and the misses that it explains.
#include "rt/frame/steal_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

namespace {

constexpr std::size_t max_intervals = 64;

std::int64_t end_of(const FrameRecord& r) { return std::max(r.complete_ns, r.presented_ns); }

/// Causes whose evidence is time that seems spent in a phase, or theft of which the clocks saw a part. The others have evidence
/// of their own.
bool may_be_theft(Cause cause) {
    return cause == Cause::stolen || cause == Cause::select || cause == Cause::submit || cause == Cause::raster ||
           cause == Cause::upload || cause == Cause::present || cause == Cause::prepared_too_old;
}

}  // namespace

void StealEvidence::read(std::int64_t now_ns, std::span<const double> core_steal_ms) {
    const MutexLock lock(mutex_);
    if (core_steal_ms.empty()) {
        last_ms_.clear();
        intervals_.clear();
        return;
    }
    const auto of_core = [](std::span<const double> ms, int core) {
        return static_cast<std::size_t>(core) < ms.size() ? ms[static_cast<std::size_t>(core)] : 0.0;
    };
    if (!last_ms_.empty() && now_ns <= last_ns_) return;  // another thread was quicker
    if (!last_ms_.empty()) {
        double grown_ms = 0;
        for (const int core : cores_) grown_ms = std::max(grown_ms, of_core(core_steal_ms, core) - of_core(last_ms_, core));
        const auto grown_ns = static_cast<std::int64_t>(std::llround(grown_ms * 1e6));
        if (intervals_.size() == max_intervals) intervals_.erase(intervals_.begin());
        intervals_.push_back({last_ns_, now_ns, grown_ns, grown_ns});
    }
    last_ms_.assign(core_steal_ms.begin(), core_steal_ms.end());
    last_ns_ = now_ns;
}

/// Empty where the readings do not reach round the frame.
std::span<StealEvidence::Interval> StealEvidence::around(const FrameRecord& record) {
    const std::int64_t end_ns = end_of(record);
    if (intervals_.empty() || record.due_ns < intervals_.front().from_ns || end_ns > intervals_.back().to_ns) return {};
    auto first = intervals_.begin();
    while (first->to_ns <= record.due_ns && first + 1 != intervals_.end()) ++first;
    auto last = first;
    while (last->to_ns < end_ns) ++last;
    return {first, last + 1};
}

void StealEvidence::judge(std::span<FrameRecord> records) {
    const MutexLock lock(mutex_);
    const auto take = [](std::span<Interval> from, std::int64_t ns) {
        for (Interval& interval : from) {
            const std::int64_t taken = std::clamp<std::int64_t>(ns, 0, interval.left_ns);
            interval.left_ns -= taken;
            ns -= taken;
        }
    };
    for (FrameRecord& record : records) {
        const std::span<Interval> readings = around(record);
        if (readings.empty()) continue;
        record.core_steal_ns = 0;
        for (const Interval& interval : readings) record.core_steal_ns += interval.grown_ns;
        take(readings, record.stolen_ns);
    }
    for (FrameRecord& record : records) {
        if (!record.own_miss || !may_be_theft(record.cause)) continue;
        const std::span<Interval> readings = around(record);
        std::int64_t left_ns = 0;
        for (const Interval& interval : readings) left_ns += interval.left_ns;
        const std::int64_t missing_ns = std::max<std::int64_t>(late_ns(record) - record.stolen_ns, 1);
        if (left_ns < missing_ns) continue;
        take(readings, missing_ns);
        record.cause = Cause::stolen;
        record.own_miss = false;
        record.by_core_steal = true;
    }
}

}  // namespace surefoot::rt
