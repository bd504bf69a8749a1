// Adding up a record, and publishing.
#include "rt/monitor/telemetry.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rt/base/check.hpp"
#include "rt/frame/record.hpp"

namespace surefoot::rt {

namespace {

constexpr std::int64_t us = 1000, ms = 1'000'000;
constexpr std::array<std::int64_t, 19> round_edges_ns = {
    10 * us, 20 * us, 50 * us,  100 * us, 200 * us, 500 * us,  1 * ms,    2 * ms,    5 * ms,     10 * ms,
    20 * ms, 50 * ms, 100 * ms, 200 * ms, 500 * ms, 1000 * ms, 2000 * ms, 5000 * ms, 10'000 * ms};
static_assert(round_edges_ns.size() + 8 == Edges::max_edges);

}  // namespace

Edges::Edges(std::int64_t period_ns) {
    std::copy(round_edges_ns.begin(), round_edges_ns.end(), edges_ns_.begin());
    const std::array<std::int64_t, 8> of_period = {period_ns / 4,       period_ns / 2, period_ns / 4 * 3, period_ns / 8 * 7,
                                                   period_ns / 16 * 15, period_ns,     period_ns / 4 * 5, period_ns * 2};
    std::copy(of_period.begin(), of_period.end(), edges_ns_.begin() + round_edges_ns.size());
    std::sort(edges_ns_.begin(), edges_ns_.end());
    count_ = static_cast<std::size_t>(std::unique(edges_ns_.begin(), edges_ns_.end()) - edges_ns_.begin());
}

void Distribution::add(const Edges& edges, std::int64_t value_ns) {
    fine.add(value_ns);
    const auto all = edges.ns();
    const auto edge = std::lower_bound(all.begin(), all.end(), value_ns);
    ++up_to[edge == all.end() ? Edges::max_edges : static_cast<std::size_t>(edge - all.begin())];
}

void Distribution::add_progression(const Edges& edges, std::int64_t first_ns, std::int64_t step_ns, std::uint64_t times) {
    fine.add_progression(first_ns, step_ns, times);
    std::uint64_t placed = 0;
    const auto all = edges.ns();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i] < first_ns) continue;
        const std::uint64_t below = std::min(times, static_cast<std::uint64_t>((all[i] - first_ns) / step_ns) + 1);
        up_to[i] += below - placed;
        placed = below;
    }
    up_to[Edges::max_edges] += times - placed;
}

std::uint64_t Figures::all_misses() const { return std::accumulate(misses.begin(), misses.end(), std::uint64_t{0}); }

ShownBy Figures::shown_by_whom() const {
    for (const ShownBy by : {ShownBy::display, ShownBy::hand_over})
        if (shown_by[static_cast<std::size_t>(by)] > 0) return by;
    return ShownBy::nothing;
}

double Figures::one_percent_low_hz() const {
    const Histogram& shown = of(Series::shown_interval).fine;
    return shown.count() > 0 ? 1e9 / static_cast<double>(std::max<std::int64_t>(shown.quantile(0.99), 1)) : 0;
}

void Telemetry::begin(const TelemetrySetup& setup) {
    if (setup.period_ns != figures_.setup.period_ns) {
        figures_ = Figures();
        figures_.edges = Edges(setup.period_ns);
    }
    figures_.setup = setup;
    follows_ = any_ = false;
    reports_seen_ = 0;
    publish();
}

void Telemetry::add(const FrameRecord& record) {
    // The first slot of a walk may be any; after it, what is neither run nor skipped was lost on the way here.
    const std::uint64_t expected = next_slot_ + record.skipped_before;
    const std::uint64_t lost = any_ && record.slot > expected ? record.slot - expected : 0;
    (void)CHECK_RARE(!any_ || record.slot >= expected, "Records come in the order of their slots");
    any_ = true;
    next_slot_ = record.slot + 1;
    figures_.lost_slots += lost;
    if (lost > 0) follows_ = false;
    if (record.control) {
        ++figures_.bare_frames;
        follows_ = false;
    } else {
        count(record);
        add_times(record);
        add_shown(record);
        add_recent(record);
        figures_.last = record;
        follows_ = true;
    }
    if (record.complete_ns - published_ns_ >= publish_ns || record.complete_ns < published_ns_) {
        published_ns_ = record.complete_ns;
        publish();
    }
}

void Telemetry::publish() {
    published_.back() = figures_;
    published_.publish();
}

const Figures& Telemetry::newest() {
    published_.refresh();
    return published_.front();
}

void Telemetry::count(const FrameRecord& f) {
    Figures& s = figures_;
    ++s.frames;
    s.skipped_slots += f.skipped_before;
    if (f.missed) {
        CHECK(static_cast<std::size_t>(f.cause) < s.misses.size(), "Every miss has one of the known causes");
        ++s.misses[static_cast<std::size_t>(f.cause)];
    }
    s.own_misses += f.own_miss ? 1 : 0;
    s.core_steal_known = s.core_steal_known || f.core_steal_ns >= 0;
    s.core_steal_misses += f.by_core_steal ? 1 : 0;
    s.downgraded_slices += f.downgraded_slices;
    s.slices += f.slices;
    s.switches += f.switches;
    s.triangles += f.triangles;
    s.minor_faults += f.minor_faults;
    s.major_faults += f.major_faults;
    s.driver_faults += f.driver_faults;
    s.driver_allocations += f.driver_allocations;
    s.guard_violations += f.guard_violations;
    s.stopped_frames += f.stopped ? 1 : 0;
    s.floor_frames += f.floor_binds ? 1 : 0;
    s.rest_frames += f.at_rest ? 1 : 0;
    s.broken_guarantees += f.guarantee > Guarantee::kept ? 1 : 0;
    s.trilinear_frames += f.filter == rt::TextureFilter::trilinear ? 1 : 0;
    s.pictures_shown += f.pictures;
    s.pictures_made += f.pictures_made;
    s.uncovered_items += f.uncovered_items;
    s.captures_us += double{f.captures_us};
    s.continues += f.continued;
    s.stolen_ns += f.stolen_ns;
    s.preempted_ns += f.preempted_ns;
    s.frame_cpu_ns += f.cpu_ns;
    s.raster_cpu_ns += f.raster_cpu_ns;
    s.prepare_cpu_us += double{f.prepare_cpu_us};
}

void Telemetry::add_times(const FrameRecord& f) {
    const Edges& edges = figures_.edges;
    of(Series::wake).add(edges, f.woken_ns - f.due_ns);
    of(Series::prepare).add(edges, std::llround(double{f.prepare_cpu_us} * 1e3));
    of(Series::select).add(edges, f.selected_ns - f.woken_ns);
    of(Series::submit).add(edges, f.submitted_ns - f.selected_ns);
    of(Series::raster).add(edges, f.rastered_ns - f.submitted_ns);
    of(Series::present).add(edges, f.handed_ns > 0 ? f.presented_ns - f.handed_ns : f.complete_ns - f.rastered_ns);
    of(Series::frame).add(edges, f.complete_ns - f.due_ns);
    const std::int64_t left_ns = slack_ns(f);
    of(left_ns >= 0 ? Series::slack : Series::lateness).add(edges, std::abs(left_ns));
    // A skipped slot has no picture until this one: that is how late it is. Nothing of a stall is left out.
    const std::int64_t period_ns = figures_.setup.period_ns;
    if (f.skipped_before > 0) of(Series::lateness).add_progression(edges, f.complete_ns - f.due_ns, period_ns, f.skipped_before);
    if (f.input_reports > reports_seen_) {
        figures_.input_reports += f.input_reports - reports_seen_;
        reports_seen_ = f.input_reports;
        if (f.input_stamp_ns > 0) of(Series::input_age).add(edges, f.submitted_ns - f.input_stamp_ns);
        if (f.input_stamp_ns > 0 && f.shown_by != ShownBy::nothing)
            of(Series::input_to_shown).add(edges, f.shown_ns - f.input_stamp_ns);
    }
}

void Telemetry::add_shown(const FrameRecord& f) {
    ++figures_.shown_by[static_cast<std::size_t>(f.shown_by)];
    const bool follows = follows_ && shown_;
    shown_ = f.shown_by != ShownBy::nothing;
    if (!shown_) return;
    if (figures_.setup.late == LatePolicy::lock) of(Series::shown_error).add(figures_.edges, std::abs(f.shown_ns - f.show_ns));
    if (follows) {
        const std::int64_t interval_ns = f.shown_ns - previous_shown_ns_;
        of(Series::shown_interval).add(figures_.edges, interval_ns);
        // A frame's pose is that of its due time, so that is the time its picture is of.
        of(Series::animation_error).add(figures_.edges, std::abs(interval_ns - (f.due_ns - previous_due_ns_)));
    }
    previous_shown_ns_ = f.shown_ns;
    previous_due_ns_ = f.due_ns;
}

void Telemetry::add_recent(const FrameRecord& f) {
    const auto us_of = [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns) * 1e-3); };
    RecentFrame& r = figures_.recent[figures_.recent_count++ % Figures::max_recent];
    r.frame_us = us_of(f.complete_ns - f.due_ns);
    r.wake_us = us_of(f.woken_ns - f.due_ns);
    r.slack_us = us_of(slack_ns(f));
    r.used = static_cast<float>(busy_ns(f, figures_.setup.rasterisers) / static_cast<double>(figures_.setup.period_ns));
    r.resolution = f.resolution;
    r.accuracy = f.accuracy;
    r.skipped_before = f.skipped_before;
    r.missed = f.missed;
    r.cause = f.cause;
}

}  // namespace surefoot::rt
