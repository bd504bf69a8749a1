// Growth of steal between readings, and the misses that it explains.
#include "rt/frame/steal_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

namespace {

constexpr std::size_t max_intervals = 64;

std::int64_t end_of(const FrameRecord& r) { return std::max(r.complete_ns, r.presented_ns); }

/// What of the steal may be behind a cause whose evidence is time that seems spent in a phase. The other causes have evidence of
/// their own.
enum class Behind : std::uint8_t { nothing, frame_core, any_core };

Behind behind(Cause cause) {
    switch (cause) {
        case Cause::submit:
        case Cause::raster:
            return Behind::any_core;  // the frame waits for rasterisers on all of theirs
        case Cause::stolen:
        case Cause::select:
        case Cause::upload:
        case Cause::present:
        case Cause::prepared_too_old:
            return Behind::frame_core;
        default:
            return Behind::nothing;
    }
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
        const std::span<const double> before = last_ms_;
        const auto grown = [&](int core) {
            const double ms = std::max(0.0, of_core(core_steal_ms, core) - of_core(before, core));
            return static_cast<std::int64_t>(std::llround(ms * 1e6));
        };
        const std::int64_t frame_ns = grown(frame_core_);
        std::int64_t grown_ns = frame_ns;
        for (const int core : rasterisers_) grown_ns = std::max(grown_ns, grown(core));
        if (intervals_.size() == max_intervals) intervals_.erase(intervals_.begin());
        intervals_.push_back({last_ns_, now_ns, grown_ns, grown_ns, frame_ns});
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
    // What explains a miss explains no other, on whichever core it was.
    const auto take = [](std::span<Interval> from, std::int64_t ns) {
        for (Interval& interval : from) {
            const std::int64_t taken = std::clamp<std::int64_t>(ns, 0, interval.left_ns);
            interval.left_ns -= taken;
            interval.frame_left_ns = std::max<std::int64_t>(0, interval.frame_left_ns - taken);
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
        const Behind what = behind(record.cause);
        if (!record.own_miss || what == Behind::nothing) continue;
        const std::span<Interval> readings = around(record);
        std::int64_t left_ns = 0;
        for (const Interval& interval : readings) left_ns += what == Behind::any_core ? interval.left_ns : interval.frame_left_ns;
        const std::int64_t missing_ns = std::max<std::int64_t>(late_ns(record) - record.stolen_ns, 1);
        if (left_ns < missing_ns) continue;
        take(readings, missing_ns);
        record.cause = Cause::stolen;
        record.own_miss = false;
        record.by_core_steal = true;
    }
}

}  // namespace surefoot::rt
