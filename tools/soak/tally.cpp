// Sums, histograms and columns.
#include "tools/soak/tally.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace surefoot::soak {

namespace {

constexpr std::size_t max_columns = 600, max_misses = 400;

Quantiles quantiles_of(const rt::Histogram& h, double factor) {
    const auto at = [&](double q) { return static_cast<double>(h.quantile(q)) * factor; };
    Quantiles q;
    q.p50 = at(0.5), q.p90 = at(0.9), q.p99 = at(0.99), q.p999 = at(0.999);
    q.max = static_cast<double>(h.max()) * factor;
    q.min = static_cast<double>(h.min()) * factor;
    q.mean = h.mean() * factor;
    return q;
}

}  // namespace

SoakTally::SoakTally(const LoadPlan& plan, std::int64_t period_ns, double seconds)
    : plan_(plan), period_ns_(period_ns), column_s_(std::max(1.0, std::ceil(seconds / static_cast<double>(max_columns)))) {
    phases_.resize(std::max<std::size_t>(plan.phases.size(), 1));
    columns_.resize(static_cast<std::size_t>(seconds / column_s_) + 2);
    misses_.reserve(max_misses);
}

double SoakTally::ran_s() const { return any_ ? time_s(last_end_ns_) : 0; }

void SoakTally::add(const rt::FrameRecord& record) {
    check_grid(record);
    blocks_.add(record);
    // What a late frame ran over is that frame's, whichever came next.
    if (last_was_walk_) {
        skipped_ += record.skipped_before;
        phases_[last_phase_].skipped += record.skipped_before;
        if (last_miss_listed_) misses_.back().skipped = record.skipped_before;
    }
    last_phase_ = std::min(plan_.phase_at(time_s(record.due_ns)), phases_.size() - 1);
    last_was_walk_ = !record.control;
    last_miss_listed_ = false;
    if (!record.control) add_walk_frame(record);
    last_end_ns_ = std::max(record.complete_ns, record.deadline_ns);
}

void SoakTally::check_grid(const rt::FrameRecord& r) {
    const std::int64_t due_ns = t0_ns_ + static_cast<std::int64_t>(r.slot) * period_ns_;
    drift_ns_ = std::max<std::int64_t>(drift_ns_, std::llabs(r.due_ns - due_ns));
    const std::uint64_t expected = any_ ? last_slot_ + 1 + r.skipped_before : r.skipped_before;
    // A record that did not fit into the ring leaves a hole: it ran, and nothing more is known of it.
    if (r.slot > expected) lost_ += r.slot - expected;
    if (r.slot < expected) drift_ns_ = std::max(drift_ns_, period_ns_ * static_cast<std::int64_t>(expected - r.slot));
    skipped_all_ += r.skipped_before;
    ++run_;
    last_slot_ = r.slot;
    any_ = true;
}

void SoakTally::add_walk_frame(const rt::FrameRecord& r) {
    const std::int64_t frame_ns = r.complete_ns - r.due_ns;
    const double frame_ms = static_cast<double>(frame_ns) * 1e-6;
    frame_ns_.add(frame_ns);
    wake_ns_.add(r.woken_ns - r.due_ns);
    select_ns_.add(r.selected_ns - r.woken_ns);
    submit_ns_.add(r.submitted_ns - r.selected_ns);
    raster_ns_.add(r.rastered_ns - r.submitted_ns);
    prepare_cpu_ns_.add(static_cast<std::int64_t>(double{r.prepare_cpu_us} * 1e3));
    prepared_age_.add(r.prepared_age);
    triangles_sum_ += static_cast<double>(r.triangles);
    triangles_max_ = std::max(triangles_max_, r.triangles);
    downgrades_ += r.downgraded_slices;
    floor_bound_ += r.floor_binds ? 1 : 0;
    switches_ += r.switches;
    page_faults_ += r.minor_faults + std::uint64_t{r.major_faults};
    driver_faults_ += r.driver_faults;
    driver_allocations_ += r.driver_allocations;
    guard_violations_ += r.guard_violations;

    Phase& phase = phases_[last_phase_];
    phase.frame_ns.add(frame_ns);
    const double at_s = time_s(r.due_ns);
    Column& column = columns_[std::min(columns_.size() - 1, static_cast<std::size_t>(std::max(0.0, at_s / column_s_)))];
    column.low_ms = column.frames == 0 ? frame_ms : std::min(column.low_ms, frame_ms);
    column.high_ms = std::max(column.high_ms, frame_ms);
    column.sum_ms += frame_ms;
    ++column.frames;
    report::count_guarantee(r, guarantee_);
    const double accuracy = double{r.accuracy};
    if (std::isfinite(accuracy) && accuracy > 0) {
        accuracy_sum_ += accuracy;
        accuracy_min_ = accuracy_frames_++ == 0 ? accuracy : std::min(accuracy_min_, accuracy);
        column.accuracy_min = column.accuracy_min > 0 ? std::min(column.accuracy_min, accuracy) : accuracy;
    }
    if (!r.missed) return;
    ++missed_;
    ++phase.misses;
    ++column.misses;
    if (r.own_miss) ++own_missed_, ++phase.own_misses;
    ++causes_[static_cast<std::size_t>(r.cause)];
    if (misses_.size() == misses_.capacity()) {
        ++misses_unlisted_;
        return;
    }
    misses_.push_back({at_s, frame_ms, rt::cause_of(r), r.own_miss, 0});
    last_miss_listed_ = true;
}

void SoakTally::fill(SoakSummary& s) const {
    report::WalkSummary& w = s.walk;
    w.frames = frame_ns_.count();
    w.skipped = skipped_;
    w.slots = w.frames + w.skipped;
    w.misses = missed_;
    w.own_misses = own_missed_;
    w.miss_causes.clear();
    for (std::size_t i = 1; i < causes_.size(); ++i)
        if (causes_[i] > 0) w.miss_causes[std::string(rt::cause_names[i])] = causes_[i];
    w.seconds = ran_s();
    w.frame_ms = quantiles_of(frame_ns_, 1e-6);
    w.wake_us = quantiles_of(wake_ns_, 1e-3);
    w.select_us = quantiles_of(select_ns_, 1e-3);
    w.submit_ms = quantiles_of(submit_ns_, 1e-6);
    w.raster_ms = quantiles_of(raster_ns_, 1e-6);
    w.prepare_cpu_us = quantiles_of(prepare_cpu_ns_, 1e-3);
    w.prepared_age = quantiles_of(prepared_age_, 1);
    const double frames = std::max(1.0, static_cast<double>(w.frames));
    w.accuracy_min = accuracy_min_;
    w.guarantee = guarantee_;
    w.accuracy_mean = accuracy_frames_ > 0 ? accuracy_sum_ / static_cast<double>(accuracy_frames_) : 0;
    w.triangles_mean = triangles_sum_ / frames;
    w.triangles_max = triangles_max_;
    w.downgrades = downgrades_;
    w.floor_bound_frames = floor_bound_;
    w.switches_per_frame = static_cast<double>(switches_) / frames;
    w.page_faults = page_faults_;
    w.driver_faults = driver_faults_;
    w.driver_allocations = driver_allocations_;
    w.driver_allocations_per_frame = static_cast<double>(driver_allocations_) / frames;
    w.guard_violations = guard_violations_;

    s.ran_s = ran_s();
    s.slots_run = run_ + lost_;
    s.slots_skipped = skipped_all_;
    s.slots_elapsed = any_ ? last_slot_ + 1 : 0;
    s.records_lost = lost_;
    s.grid_drift_ns = drift_ns_;
    s.misses = misses_;
    s.misses_unlisted = misses_unlisted_;
    s.column_s = column_s_;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Column& c = columns_[i];
        if (c.frames == 0) continue;
        s.columns.push_back({static_cast<double>(i) * column_s_, c.frames, c.misses, static_cast<float>(c.low_ms),
                             static_cast<float>(c.sum_ms / c.frames), static_cast<float>(c.high_ms),
                             static_cast<float>(c.accuracy_min)});
    }
    for (std::size_t i = 0; i < plan_.phases.size(); ++i) {
        const Phase& p = phases_[i];
        const LoadPhase& planned = plan_.phases[i];
        s.phases.push_back({planned.from_s, planned.to_s, names_of(planned.loads), p.frame_ns.count(), p.misses, p.own_misses,
                            p.skipped, static_cast<double>(p.frame_ns.quantile(0.99)) * 1e-6,
                            static_cast<double>(p.frame_ns.max()) * 1e-6});
    }
}

}  // namespace surefoot::soak
