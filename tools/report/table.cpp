// The walk's figures for a terminal: at most 100 columns, the verdict first.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "rt/base/modes.hpp"
#include "tools/report/report.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/terminal.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {

namespace {

void timing_rows(LabelledText& table, const WalkSummary& s) {
    const Columns columns(
        {{"", label_columns}, {"p50", -10, 0}, {"p90", -10, 0}, {"p99", -10, 0}, {"p99.9", -10, 0}, {"max", -10, 0}});
    const auto row = [&](std::string_view label, const Quantiles& q, int decimals, std::string_view note) {
        const auto text = [&](double value) { return fmt::format("{:.{}f}", value, decimals); };
        const std::string line =
            columns.row({std::string(label), text(q.p50), text(q.p90), text(q.p99), text(q.p999), text(q.max)});
        table.raw(note.empty() ? line : fmt::format("{}   {}", line, note));
    };
    table.raw(inked(table.style(), Ink::dim, columns.heading()));
    row("frame, ms", s.frame_ms, 2, s.rate_hz > 0 ? fmt::format("deadline {:.2f}", 1000 / s.rate_hz) : "");
    row("wake, us", s.wake_us, 0, "");
    row("select, us", s.select_us, 0, "");
    row("submit, ms", s.submit_ms, 2, "");
    row("raster, ms", s.raster_ms, 2, "");
    row("prepare, us", s.prepare_cpu_us, 0, "CPU, workers");
    if (s.shown.one_percent_low_hz > 0) {
        row("interval, ms", s.shown.interval_ms, 2, fmt::format("picture to picture, by {}", rt::name_of(s.shown.by)));
        if (s.shown.on_grid) row("off grid, us", s.shown.error_us, 0, "shown against planned");
    }
    if (s.display.pictures > 0) row("display, ms", s.display.after_ms, 2, "from hand-over until the display showed it");
    row("array age", s.prepared_age, 0, "frames");
    row("cost error, %",
        {s.cost_error.p50 * 100, s.cost_error.p90 * 100, s.cost_error.p99 * 100, s.cost_error.p999 * 100, s.cost_error.max * 100,
         0, 0},
        1, "");
}

void quality_rows(LabelledText& table, const WalkSummary& s) {
    if (const std::string words = seat_words(s); !words.empty()) table.row("seat", words);
    table.row("budget", fmt::format("{:.2f} ms a frame; used {} of the grid (p99 {}), {} of the budget in wall time", s.budget_ms,
                                    percent(s.budget_used_mean), percent(s.budget_used_p99), percent(s.budget_used_wall_mean)));
    if (s.cost_scale != 1)
        table.row("cost scale", s.clock == name_of(rt::ClockKind::real)
                                    ? fmt::format("predicted costs are multiplied by {:g}", s.cost_scale)
                                    : fmt::format("charged costs are {:g} of the predicted", s.cost_scale));
    table.row("accuracy",
              fmt::format("mean {} /rad ({}), worst {} /rad ({})", short_number(s.accuracy_mean), accuracy_words(s.accuracy_mean),
                          short_number(s.accuracy_min), accuracy_words(s.accuracy_min)));
    if (s.guarantee.accuracy > 0) table.row("guarantee", guarantee_words(s.guarantee));
    if (s.resolution_min < 1)
        table.row("resolution",
                  fmt::format("mean {}, least {} of the sides", percent(s.resolution_mean), percent(s.resolution_min)));
    if (s.samples > 1 || s.other_samples)
        table.row("samples",
                  fmt::format("{} a pixel{}", s.samples, s.other_samples ? ": the driver lacks the requested number" : ""));
    if (s.trilinear_frames > 0)
        table.row("filter",
                  fmt::format("{} in {} frames of {}", rt::name_of(rt::TextureFilter::trilinear), s.trilinear_frames, s.frames));
    if (s.rest_frames > 0)
        table.row("at rest", fmt::format("{} frames, {} of them in full detail after at most {:.0f} ms, {} samples",
                                         s.rest_frames, s.rested_frames, s.rest_ms, s.rest_samples));
    if (s.picture.frames > 0) table.row("picture", picture_words(s.picture));
    if (s.pictures.any())
        table.row(
            "image cache",
            fmt::format("{:.1f} pictures a frame, {:.1f} of them reused; {} made; {:.1f} boxes a frame as triangles; {:.1f} MiB",
                        s.pictures.drawn_mean, s.pictures.reused_mean, s.pictures.made, s.pictures.as_triangles_mean,
                        static_cast<double>(s.pictures.max_bytes) / 1048576.0));
    if (s.unused_ms.max > 0)
        table.row("unused", fmt::format("{:.1f} ms of the period (mean), {:.1f} (p99), where value is missing", s.unused_ms.mean,
                                        s.unused_ms.p99));
    for (const DroppedSummary& part : s.dropped_parts)
        table.row("dropped", fmt::format("{} in {} frames, first in frame {} at {:.3g} px/us", part.part, part.frames,
                                         part.first_frame, part.first_value_per_us));
    std::string triangles =
        fmt::format("mean {}, most {}", short_number(s.triangles_mean), short_number(static_cast<double>(s.triangles_max)));
    if (s.model_triangles > 0)
        triangles += fmt::format(" of the model's {}", short_number(static_cast<double>(s.model_triangles)));
    if (s.hidden.max > 0) triangles += fmt::format("; {:.0f} occluded nodes a frame left out", s.hidden.mean);
    table.row("triangles", triangles);
    table.row(
        "stability",
        fmt::format(
            "{:.2f} switches a frame, {} slices drawn coarser in {} frames, floor reached in {} frames, shown without need in {}",
            s.switches_per_frame, s.downgrades, s.coarse_frames, s.floor_bound_frames, s.floor_frames));
}

void real_time_rows(LabelledText& table, const WalkSummary& s) {
    std::string causes;
    for (const auto& [cause, count] : s.miss_causes) causes += fmt::format("{}{} {}", causes.empty() ? "" : ", ", cause, count);
    if (!causes.empty()) table.row("misses", causes, Ink::warn);
    const auto mark = [](bool yes, std::string_view what) { return fmt::format("{}{}", yes ? "" : "not ", what); };
    table.row("real time", fmt::format("{}, {}, {}, {}; page faults {}, guard violations {}, stolen {:.1f} ms",
                                       mark(s.fifo, "FIFO"), mark(s.pinned, "pinned"), mark(s.isolated, "isolated"),
                                       mark(s.locked, "locked"), s.page_faults, s.guard_violations, s.steal_ms));
    table.row("driver", fmt::format("{:.1f} allocations and {:.2f} page faults a frame", s.driver_allocations_per_frame,
                                    s.frames == 0 ? 0.0 : static_cast<double>(s.driver_faults) / static_cast<double>(s.frames)));
    if (!s.threads.empty()) table.row("threads", threads_words(s.threads));
    for (const std::string& problem : s.census_problems) table.row("census", problem, Ink::bad);
    if (!s.uncalibrated.empty()) table.row("uncalibrated", s.uncalibrated, Ink::warn);
    for (const rt::Lack& d : s.degraded) table.row("degraded", d.text(), Ink::warn);
    if (s.control.ran) table.row("control", control_words(s.control), rule_broken(s.control) ? Ink::bad : Ink::plain);
}

}  // namespace

std::string guarantee_words(const GuaranteeSummary& g) {
    std::string words = fmt::format("{} /rad in {} frames", short_number(g.accuracy), g.kept);
    for (const auto& [reason, frames] : g.broken) words += fmt::format("; not in {} ({})", frames, reason);
    if (g.binding_node == rt::no_node) return words + "; all was exact";
    return words + fmt::format("; worst {} /rad in frame {}: node {}{}", short_number(g.reached_min), g.worst_frame,
                               g.binding_node, g.binding_name.empty() ? "" : fmt::format(" ({})", g.binding_name));
}

std::string to_table(const WalkSummary& s, bool colour) {
    LabelledText table(colour);
    const Verdict verdict = verdict_of(s);
    table.row("walk", headline(s),
              verdict == Verdict::good   ? Ink::strong_good
              : verdict == Verdict::warn ? Ink::strong_warn
                                         : Ink::strong_bad);
    table.row("model", s.path.empty()  ? s.model
                       : s.input.given ? fmt::format("{} steered by {}, from the start of {}", s.model, s.input.source, s.path)
                                       : fmt::format("{} along {}", s.model, s.path));
    if (s.input.given) table.row("input", input_words(s.input), s.input.stopped_frames > 0 ? Ink::warn : Ink::plain);
    table.row("drawn", fmt::format("{}x{}{} at {:.4g} Hz by {} on {} ({}), late: {}, clock: {}", s.width, s.height,
                                   off_axis_words(s), s.rate_hz, s.selector, s.backend, s.renderer, s.late_policy, s.clock));
    table.raw("");
    timing_rows(table, s);
    table.raw("");
    quality_rows(table, s);
    real_time_rows(table, s);
    table.row("cut hash", s.cut_hash);
    return table.text();
}

}  // namespace surefoot::report
