// From frame records to the figures of a walk: pure sums and percentiles, nothing measured here.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "rt/base/hash.hpp"
#include "tools/report/report.hpp"
#include "tools/report/times.hpp"

#include <fmt/format.h>

namespace surefoot::report {

namespace {

using rt::FrameRecord;

template <class Value>
Quantiles quantiles_of(std::span<const FrameRecord* const> frames, Value value) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const FrameRecord* frame : frames) values.push_back(value(*frame));
    return quantiles(std::move(values));
}

void count_frames(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    std::uint64_t hash = fnv_start;
    std::int64_t stolen_ns = 0;
    for (const FrameRecord* f : frames) {
        s.skipped += f->skipped_before;
        s.misses += f->missed ? 1 : 0;
        s.own_misses += f->own_miss ? 1 : 0;
        s.core_steal_known = s.core_steal_known || f->core_steal_ns >= 0;
        s.core_steal_misses += f->by_core_steal ? 1 : 0;
        if (f->missed) ++s.miss_causes[std::string(rt::cause_of(*f))];
        s.downgrades += f->downgraded_slices;
        s.coarse_frames += f->downgraded_slices > 0 ? 1 : 0;
        s.floor_frames += f->floor_frame ? 1 : 0;
        s.floor_bound_frames += f->floor_binds ? 1 : 0;
        s.page_faults += f->minor_faults + f->major_faults;
        s.guard_violations += f->guard_violations;
        s.driver_faults += f->driver_faults;
        s.driver_allocations += f->driver_allocations;
        stolen_ns += f->stolen_ns;
        s.triangles_max = std::max(s.triangles_max, f->triangles);
        hash = fnv1a(hash, f->cut_hash);
    }
    s.steal_ms = std::max(s.steal_ms, static_cast<double>(stolen_ns) * 1e-6);
    s.frames = frames.size();
    s.slots = s.frames + s.skipped;
    s.driver_allocations_per_frame =
        s.frames == 0 ? 0 : static_cast<double>(s.driver_allocations) / static_cast<double>(s.frames);
    s.cut_hash = fmt::format("{:016x}", hash);
}

/// The mean is over frames that have an error; where none has, everything drawn was exact.
void accuracy_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    double sum = 0;
    std::size_t counted = 0;
    s.accuracy_min = std::numeric_limits<double>::infinity();
    for (const FrameRecord* f : frames) {
        const double accuracy = f->accuracy;
        if (std::isnan(accuracy)) continue;
        s.accuracy_min = std::min(s.accuracy_min, accuracy);
        if (!std::isfinite(accuracy)) continue;
        sum += accuracy;
        ++counted;
    }
    s.accuracy_mean = counted > 0 ? sum / static_cast<double>(counted) : std::numeric_limits<double>::infinity();
}

void guarantee_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    s.guarantee = {};
    for (const FrameRecord* f : frames) count_guarantee(*f, s.guarantee);
}

void budget_figures(std::span<const FrameRecord* const> frames, std::int64_t period_ns, WalkSummary& s) {
    s.budget_ms = quantiles_of(frames, [](const FrameRecord& f) { return f.budget_us * 1e-3; }).p50;
    const auto used =
        quantiles_of(frames, [&](const FrameRecord& f) { return busy_ns(f, s.rasterisers) / static_cast<double>(period_ns); });
    s.budget_used_mean = used.mean;
    s.budget_used_p99 = used.p99;
    s.budget_used_wall_mean = quantiles_of(frames, [](const FrameRecord& f) { return share_of_budget(f); }).mean;
    std::vector<double> errors;
    for (const FrameRecord* f : frames)  // a frame without a prediction has no error of it
        if (f->actual_us > 0 && f->predicted_us > 0)
            errors.push_back(std::abs(double{f->predicted_us} - double{f->actual_us}) / double{f->actual_us});
    s.cost_error = quantiles(std::move(errors));
}

/// Time that could have bought detail. A frame beyond its deadline left none.
void unused_time(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    constexpr float whole_value = 0.99F;
    std::vector<double> left_ms;
    for (const FrameRecord* f : frames)
        if (f->value < whole_value || f->resolution < 1)
            left_ms.push_back(static_cast<double>(std::max<std::int64_t>(0, f->deadline_ns - f->rastered_ns)) * 1e-6);
    s.unused_ms = quantiles(std::move(left_ms));
}

void resolution_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    s.resolution_mean = s.resolution_min = 1;
    if (frames.empty()) return;
    const Quantiles q = quantiles_of(frames, [](const FrameRecord& f) { return double{f.resolution}; });
    s.resolution_mean = q.mean;
    s.resolution_min = q.min;
}

/// Samples are the same in all frames of a walk.
void quality_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    const FrameRecord& last = frames.empty() ? FrameRecord{} : *frames.back();
    s.samples = last.samples;
    s.other_samples = last.other_samples;
    s.filter = last.filter;
    s.trilinear_frames = static_cast<std::uint64_t>(std::count_if(
        frames.begin(), frames.end(), [](const FrameRecord* f) { return f->filter == rt::TextureFilter::trilinear; }));
}

void shadow_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    const auto count = [&](bool FrameRecord::*what) {
        return static_cast<std::uint64_t>(
            std::count_if(frames.begin(), frames.end(), [&](const FrameRecord* f) { return f->*what; }));
    };
    s.shadow_refreshes = count(&FrameRecord::shadow_refreshed);
    s.shadow_frames = count(&FrameRecord::shadow_shown);
}

void picture_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    s.pictures = {};
    for (const FrameRecord* f : frames) {
        s.pictures.drawn_mean += f->pictures;
        s.pictures.made += f->pictures_made;
        s.pictures.reused_mean += f->pictures_reused;
        s.pictures.as_triangles_mean += f->boxes_as_triangles;
        s.pictures.max_bytes = std::max(s.pictures.max_bytes, f->picture_bytes);
        s.pictures.draw_us_mean += static_cast<double>(f->pictures_us);
        s.pictures.make_us_mean += static_cast<double>(f->captures_us);
        s.pictures.make_us_max = std::max(s.pictures.make_us_max, static_cast<double>(f->captures_us));
        s.pictures.uncovered += f->uncovered_items;
    }
    const double count = static_cast<double>(std::max<std::size_t>(frames.size(), 1));
    PicturesSummary& p = s.pictures;
    for (double* mean : {&p.drawn_mean, &p.reused_mean, &p.as_triangles_mean, &p.draw_us_mean, &p.make_us_mean}) *mean /= count;
}

void rest_figures(std::span<const FrameRecord* const> frames, WalkSummary& s) {
    s.rest_frames = s.rested_frames = s.rest_samples = 0;
    s.rest_ms = 0;
    const FrameRecord* first = nullptr;  // of this rest
    bool waits = false;                  // for full detail
    for (const FrameRecord* f : frames) {
        if (!f->at_rest) {
            first = nullptr;
            continue;
        }
        if (first == nullptr) {
            first = f;
            waits = true;
        }
        ++s.rest_frames;
        s.rested_frames += f->rest_samples > 0 ? 1 : 0;
        s.rest_samples = std::max(s.rest_samples, f->rest_samples);
        if (f->rest_samples == 0 || !waits) continue;
        waits = false;
        s.rest_ms = std::max(s.rest_ms, static_cast<double>(f->complete_ns - first->due_ns) * 1e-6);
    }
}

ShownSummary shown_figures(std::span<const FrameRecord* const> frames, const std::string& late_policy) {
    ShownSummary s;
    s.on_grid = late_policy == rt::name_of(rt::LatePolicy::lock);
    std::vector<double> intervals, errors, animation;
    const FrameRecord* before = nullptr;
    for (const FrameRecord* f : frames) {
        const bool follows = before != nullptr && before->slot + 1 + f->skipped_before == f->slot;
        if (f->shown_by == rt::ShownBy::nothing) {
            before = nullptr;
            continue;
        }
        s.by = std::max(s.by, f->shown_by);
        if (s.on_grid) errors.push_back(std::abs(us_between(f->show_ns, f->shown_ns)));
        if (follows) {
            intervals.push_back(us_between(before->shown_ns, f->shown_ns) * 1e-3);
            animation.push_back(std::abs(intervals.back() - us_between(before->due_ns, f->due_ns) * 1e-3));
        }
        before = f;
    }
    s.on_grid = s.on_grid && !errors.empty();
    s.error_us = quantiles(std::move(errors));
    s.interval_ms = quantiles(std::move(intervals));
    s.animation_error_ms = quantiles(std::move(animation));
    if (s.interval_ms.p99 > 0) s.one_percent_low_hz = 1e3 / s.interval_ms.p99;
    return s;
}

/// Of parts that fell in one frame, the one of the least value per us went first.
std::vector<DroppedSummary> dropped_parts(const std::vector<const FrameRecord*>& frames) {
    std::vector<DroppedSummary> parts;
    for (std::size_t i = 0; i < rt::switch_count; ++i) {
        DroppedSummary part{rt::light_switches[i].name};
        for (const FrameRecord* f : frames) {
            const rt::DroppedPart& of = f->dropped_parts[i];
            if (of.fell) ++part.falls;
            if (!of.dropped) continue;
            if (part.frames++ > 0) continue;
            part.falls = std::max<std::uint64_t>(part.falls, 1);  // it may have fallen before the first frame
            part.first_frame = f->frame;
            part.first_value_per_us = static_cast<double>(of.fell_at);
        }
        if (part.frames > 0) parts.push_back(part);
    }
    std::stable_sort(parts.begin(), parts.end(), [](const DroppedSummary& a, const DroppedSummary& b) {
        return a.first_frame != b.first_frame ? a.first_frame < b.first_frame : a.first_value_per_us < b.first_value_per_us;
    });
    return parts;
}

/// Everything that is counted up starts from zero, so that a summary can be made anew from longer records.
void clear_counts(WalkSummary& s) {
    s.core_steal_known = false;
    s.frames = s.slots = s.skipped = s.misses = s.own_misses = s.core_steal_misses = 0;
    s.miss_causes.clear();
    s.downgrades = s.coarse_frames = s.floor_frames = s.floor_bound_frames = s.page_faults = s.guard_violations =
        s.driver_faults = s.driver_allocations = 0;
    s.triangles_max = 0;
}

}  // namespace

void count_guarantee(const rt::FrameRecord& frame, GuaranteeSummary& guarantee) {
    if (frame.guarantee == rt::Guarantee::none) return;
    if (!(guarantee.accuracy > 0)) guarantee.reached_min = std::numeric_limits<double>::infinity();
    guarantee.accuracy = frame.guaranteed_accuracy;  // the same in all frames
    if (frame.guarantee == rt::Guarantee::kept)
        ++guarantee.kept;
    else
        ++guarantee.broken[std::string(rt::name_of(frame.guarantee))];
    if (!(double{frame.reached_accuracy} < guarantee.reached_min)) return;
    guarantee.reached_min = frame.reached_accuracy;
    guarantee.worst_frame = frame.frame;
    guarantee.binding_node = frame.binding_node;
}

void summarize(std::span<const FrameRecord> records, std::int64_t period_ns, WalkSummary& summary) {
    std::vector<const FrameRecord*> frames;
    frames.reserve(records.size());
    for (const FrameRecord& record : records)
        if (!record.control) frames.push_back(&record);

    period_ns = std::max<std::int64_t>(period_ns, 1);
    clear_counts(summary);
    count_frames(frames, summary);
    accuracy_figures(frames, summary);
    guarantee_figures(frames, summary);
    budget_figures(frames, period_ns, summary);
    unused_time(frames, summary);
    resolution_figures(frames, summary);
    quality_figures(frames, summary);
    picture_figures(frames, summary);
    shadow_figures(frames, summary);
    rest_figures(frames, summary);
    summary.dropped_parts = dropped_parts(frames);
    summary.shown = shown_figures(frames, summary.late_policy);
    summary.rate_hz = 1e9 / static_cast<double>(period_ns);
    summary.seconds = static_cast<double>(summary.slots) * static_cast<double>(period_ns) * 1e-9;
    summary.frame_ms = quantiles_of(frames, frame_ms);
    summary.wake_us = quantiles_of(frames, wake_us);
    summary.select_us = quantiles_of(frames, select_us);
    summary.submit_ms = quantiles_of(frames, [](const FrameRecord& f) { return submit_us(f) * 1e-3; });
    summary.raster_ms = quantiles_of(frames, [](const FrameRecord& f) { return raster_us(f) * 1e-3; });
    summary.prepare_cpu_us = quantiles_of(frames, [](const FrameRecord& f) { return double{f.prepare_cpu_us}; });
    summary.prepared_age = quantiles_of(frames, [](const FrameRecord& f) { return double(f.prepared_age); });
    summary.visits = quantiles_of(frames, [](const FrameRecord& f) { return double(f.visits); });
    summary.hidden = quantiles_of(frames, [](const FrameRecord& f) { return double(f.hidden); });
    summary.triangles_mean = quantiles_of(frames, [](const FrameRecord& f) { return static_cast<double>(f.triangles); }).mean;
    summary.dropped_per_frame = quantiles_of(frames, [](const FrameRecord& f) { return double(f.dropped_objects); }).mean;
    summary.switches_per_frame = quantiles_of(frames, [](const FrameRecord& f) { return double(f.switches); }).mean;
}

double psnr_db(double mse) {
    constexpr double white = 255;
    return mse > 0 ? std::min(max_psnr_db, 10 * std::log10(white * white / mse)) : max_psnr_db;
}

PictureFigures figures_of(const ReportSnapshot& s) {
    return {s.frame, s.triangles, s.full_triangles, s.accuracy, s.snr_db, s.mse, s.ssim, s.flip};
}

PictureSummary compare_pictures(std::span<const ReportSnapshot> snapshots) {
    PictureSummary p;
    double mse = 0, worst_mse = -1, pop_mse = 0;
    for (const ReportSnapshot& snapshot : snapshots) {
        if (snapshot.walk.empty()) continue;
        ++p.frames;
        mse += snapshot.mse;
        p.ssim += snapshot.ssim;
        p.flip += snapshot.flip;
        if (snapshot.pops_compared) {
            ++p.pop_frames;
            p.popped_share += snapshot.popped_share;
            p.worst_popped_share = std::max(p.worst_popped_share, snapshot.popped_share);
            pop_mse += snapshot.pop_mse;
        }
        if (snapshot.mse <= worst_mse) continue;
        worst_mse = snapshot.mse;
        p.worst_frame = snapshot.frame;
    }
    if (p.frames == 0) return p;
    p.psnr_db = psnr_db(mse / p.frames);
    p.worst_psnr_db = psnr_db(worst_mse);
    p.ssim /= p.frames;
    p.flip /= p.frames;
    if (p.pop_frames == 0) return p;
    p.popped_share /= p.pop_frames;
    p.pop_psnr_db = psnr_db(pop_mse / p.pop_frames);
    return p;
}

}  // namespace surefoot::report
