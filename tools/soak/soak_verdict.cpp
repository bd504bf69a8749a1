// The verdict's points.
#include "tools/soak/soak_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "rt/base/modes.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::soak {

namespace {

constexpr double own_misses_per_frame = 2.0 / 1800.0;
constexpr double memory_limit_kib_h = 64;
constexpr double min_memory_window_s = 600;

Judged judged(bool holds) { return holds ? Judged::holds : Judged::broken; }

SoakCheck judge_deadlines(const SoakSummary& s) {
    const report::ControlSummary& c = s.walk.control;
    const double allowed = own_misses_per_frame * static_cast<double>(s.walk.frames);
    SoakCheck check{"deadlines", Judged::holds, ""};
    check.words = fmt::format("{} of {} frames missed, {} by the walk's own doing ({:.0f} allowed)", s.walk.misses, s.walk.frames,
                              s.walk.own_misses, std::floor(allowed));
    if (s.walk.frames == 0 || static_cast<double>(s.walk.own_misses) > allowed) {
        check.judged = Judged::broken;
        return check;
    }
    if (!c.ran) return check;
    const rt::DeadlineVerdict& v = c.verdict;
    check.words += fmt::format("; a bare loop of the same cost missed {} of {} (p = {:.2g} over {} pairs)", v.control_misses,
                               v.control_frames, v.p_value, v.pairs);
    if (!v.control_holds) {
        check.judged = Judged::broken;
    } else if (!v.enough_pairs) {
        check.judged = Judged::not_judged;
        check.words += "; the rule needs 90 pairs: six minutes";
    } else if (!v.load_counts) {
        check.judged = Judged::not_judged;
        check.words += fmt::format("; the load was too light to judge: under SCHED_OTHER the bare loop missed {}, not a fifth",
                                   report::percent(c.other_miss_share));
    }
    return check;
}

SoakCheck judge_load(const SoakSummary& s) {
    SoakCheck check{"load", Judged::holds, ""};
    std::string unreal, refused;
    std::size_t real = 0;
    for (const SoakLoad& load : s.loads) {
        real += load.real ? 1 : 0;
        if (!load.ran) refused += (refused.empty() ? "" : ", ") + load.name;
        if (load.ran && !load.real) unreal += (unreal.empty() ? "" : ", ") + load.name;
    }
    check.words = fmt::format("{} of {} kinds of load were real", real, s.loads.size());
    if (!refused.empty()) check.words += "; not run: " + refused;
    if (!unreal.empty()) {
        check.words += "; too light: " + unreal;
        check.judged = Judged::not_judged;
    }
    if (real == 0) check.judged = Judged::not_judged;
    return check;
}

SoakCheck judge_grid(const SoakSummary& s) {
    const bool exact = s.slots_run + s.slots_skipped == s.slots_elapsed && s.grid_drift_ns == 0;
    SoakCheck check{"grid", judged(exact && s.slots_run > 0), ""};
    check.words = fmt::format("{} run + {} skipped = {} elapsed slots; largest deviation of a due time: {} ns", s.slots_run,
                              s.slots_skipped, s.slots_elapsed, s.grid_drift_ns);
    if (s.records_lost > 0) {
        check.words += fmt::format("; {} records were lost", s.records_lost);
        if (exact) check.judged = Judged::not_judged;
    }
    return check;
}

std::vector<SoakSample> after_warm_up(const SoakSummary& s) {
    std::vector<SoakSample> kept;
    for (const SoakSample& sample : s.samples)
        if (sample.time_s >= s.warm_up_s) kept.push_back(sample);
    return kept;
}

SoakCheck judge_memory(SoakSummary& s, const std::vector<SoakSample>& samples) {
    std::vector<TrendPoint> points;
    points.reserve(samples.size());
    for (const SoakSample& sample : samples) points.push_back({sample.time_s, sample.memory_kib});
    s.memory = robust_trend(points);
    SoakCheck check{"memory", Judged::not_judged, ""};
    const double window_s = points.empty() ? 0 : points.back().time_s - points.front().time_s;
    if (!s.memory.known) {
        check.words = "no two samples after the warm-up";
        return check;
    }
    const double kib_h = s.memory.per_s * 3600;
    check.words = fmt::format("{:+.0f} KiB an hour over {:.0f} s after the warm-up ({:.0f} allowed), at {:.1f} MiB",
                              kib_h == 0 ? 0.0 : kib_h, window_s, memory_limit_kib_h, points.back().value / 1024);
    if (window_s >= min_memory_window_s) {
        check.judged = judged(kib_h <= memory_limit_kib_h);
    } else {
        check.words += "; under ten minutes a single page changes the result too much";
    }
    return check;
}

using Count = std::uint32_t SoakSample::*;

/// What comes and goes (a file that is read) is no growth: the lowest counts are compared.
SoakCheck judge_flat(const std::string& name, const std::vector<SoakSample>& samples, Count count) {
    SoakCheck check{name, Judged::not_judged, "too few samples after the warm-up"};
    const std::size_t quarter = samples.size() / 4;
    if (quarter == 0) return check;
    const auto lowest = [&](std::size_t from) {
        std::uint32_t min_count = std::numeric_limits<std::uint32_t>::max();
        for (std::size_t i = from; i < from + quarter; ++i) min_count = std::min(min_count, samples[i].*count);
        return min_count;
    };
    std::uint32_t max_count = 0;
    for (const SoakSample& sample : samples) max_count = std::max(max_count, sample.*count);
    const std::uint32_t first = lowest(0), last = lowest(samples.size() - quarter);
    check.judged = judged(last <= first);
    check.words = fmt::format("first {}, last {}, max {}", first, last, max_count);
    return check;
}

SoakCheck judge_real_time(const SoakSummary& s) {
    const report::WalkSummary& w = s.walk;
    const bool clean = w.page_faults == 0 && w.guard_violations == 0 && w.census_problems.empty();
    SoakCheck check{"real time", judged(clean), ""};
    check.words = fmt::format("{}, memory {}; {} page faults and {} guard violations in the frame's own code",
                              w.fifo ? "SCHED_FIFO" : "no SCHED_FIFO", w.locked ? "locked" : "not locked", w.page_faults,
                              w.guard_violations);
    if (!w.census_problems.empty()) check.words += "; " + w.census_problems.front();
    if (!w.fifo || !w.locked) check.judged = Judged::not_judged;
    return check;
}

std::string refusal(int error) { return fmt::format("not permitted here: {}", std::strerror(error)); }

}  // namespace

double warm_up_of(double seconds) { return std::min(seconds / 5, 300.0); }

SoakLoad describe_load(const LoadFigures& f, double other_miss_share) {
    SoakLoad load{
        std::string(load_names[static_cast<std::size_t>(f.kind)]), f.seconds, false, false, "", f.amount, f.evidence, f.failures};
    if (f.refused != 0) {
        load.words = refusal(f.refused);
        return load;
    }
    load.ran = true;
    const double per_s = f.seconds > 0 ? f.amount / f.seconds : 0;
    switch (f.kind) {
        case LoadKind::cpu:
            load.words = fmt::format("{:.0f} s of CPU time burned on {} cores in {:.0f} s", f.amount / 1000, f.cores, f.seconds);
            if (other_miss_share >= 0) {
                load.words +=
                    fmt::format("; beside it, the bare loop under SCHED_OTHER missed {}", report::percent(other_miss_share));
                load.real = other_miss_share >= 0.2;
            } else {
                // Without the control's proof: it took most of what the walk leaves of the cores.
                load.real = f.amount / 1000 >= 0.3 * f.seconds * f.cores;
            }
            break;
        case LoadKind::memory:
            load.words = fmt::format("{:.0f} MiB/s written, {:.0f} page faults", per_s, f.evidence);
            load.real = per_s >= 20 && f.evidence > 0;
            break;
        case LoadKind::io:
            load.words = fmt::format("{:.1f} MiB/s written and synced, {:.0f} MiB of it to the device by the kernel's counters",
                                     per_s / 1024, f.evidence / 1024);
            load.real = per_s / 1024 >= 0.5 && f.amount > 0;
            break;
        case LoadKind::forks:
            load.words = fmt::format("{:.0f} processes a second; the kernel counted {:.0f} in that time", per_s, f.evidence);
            load.real = per_s >= 10 && f.evidence > 0;
            break;
        case LoadKind::devices:
            load.words = fmt::format("{:.0f} HID reports a second, {} of the planned ones", per_s,
                                     report::percent(f.evidence > 0 ? f.amount / f.evidence : 0));
            load.real = f.amount > 0 && f.amount >= 0.9 * f.evidence;
            break;
        case LoadKind::reloads:
            load.words = fmt::format("the settings were read and checked {:.0f} times, {} failed", f.amount, f.failures);
            load.real = f.amount > 0 && f.failures == 0;
            break;
        case LoadKind::caches:
            load.words = fmt::format("the page cache was dropped {:.0f} times, {:.0f} MiB in all", f.amount, f.evidence / 1024);
            load.real = f.amount > 0 && f.evidence > 0;
            break;
        case LoadKind::clock:
            load.words =
                fmt::format("{:.0f} steps of the time of day, {} failed; off by at most {:.0f} us after a step was undone",
                            f.amount, f.failures, f.evidence);
            load.real = f.amount > 0 && f.failures == 0;
            break;
    }
    return load;
}

void judge_soak(SoakSummary& s) {
    const bool on_virtual_clock = s.walk.clock == rt::name_of(rt::ClockKind::virtual_time);
    s.warm_up_s = warm_up_of(s.ran_s);
    const std::vector<SoakSample> samples = after_warm_up(s);
    s.checks.clear();
    s.checks.push_back(judge_deadlines(s));
    if (!on_virtual_clock) s.checks.push_back(judge_load(s));
    s.checks.push_back(judge_grid(s));
    s.checks.push_back(judge_memory(s, samples));
    s.checks.push_back(judge_flat("descriptors", samples, &SoakSample::descriptors));
    s.checks.push_back(judge_flat("threads", samples, &SoakSample::threads));
    if (!on_virtual_clock) s.checks.push_back(judge_real_time(s));
}

}  // namespace surefoot::soak
