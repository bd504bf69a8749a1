// The results of a walk: its summary, and the requested files.
#include "tools/walk/walk_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <numbers>

#include "config/seat.hpp"
#include "render/capture/capture.hpp"
#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "tools/walk/worst_forms.hpp"

namespace surefoot::walk {

namespace {

constexpr double degrees_per_rad = 180 / std::numbers::pi;

}  // namespace

void fill_summary(const WalkRequest& request, const WalkFacts& facts, const PlacingPlan& plan, std::int64_t period_ns,
                  const std::string& path_source, const Engine& engine, WalkOutcome& outcome) {
    report::WalkSummary& s = outcome.summary;
    s.model = request.model_file;
    s.path = path_source;
    s.selector = request.selector;
    s.backend = request.backend;
    s.renderer = facts.renderer;
    s.machine = facts.machine;
    s.late_policy = rt::name_of(request.late);
    s.clock = rt::name_of(request.clock);
    s.width = request.width;
    s.height = request.height;
    s.shift_x = request.shift_x;
    s.shift_y = request.shift_y;
    if (const auto seat = config::seat_of(request))
        s.seat = {true, request.screen_width_cm, request.eye_distance_cm, seat->fov_x_rad * degrees_per_rad,
                  seat->fov_y_rad * degrees_per_rad};
    s.acuity_arcmin = config::acuity_rad(request) * 60 * degrees_per_rad;
    s.rate_hz = request.rate_hz;
    s.cost_scale = request.cost_scale;
    s.model_triangles = engine.model().triangles();
    s.rasterisers = static_cast<std::uint32_t>(std::max(1, plan.rasterisers));
    s.fifo = plan.fifo;
    s.pinned = facts.pinned;
    s.isolated = facts.isolated;
    s.locked = facts.locked;
    s.steal_ms = facts.steal_ms;
    s.census_problems = facts.census_problems;
    s.threads = facts.threads;
    s.degraded = facts.degraded;
    s.uncalibrated = facts.uncalibrated;
    if (facts.dropped_records > 0) {
        s.degraded.push_back({rt::LackKind::other, fmt::format("{} frame records were dropped", facts.dropped_records),
                              "Give the monitor thread more CPU time"});
    }
    report::summarize(outcome.records, period_ns, s);
    const model::Model& model = engine.model();
    if (s.guarantee.binding_node < model.nodes.size())
        s.guarantee.binding_name = printable(model.name_of(model.nodes[s.guarantee.binding_node]));
}

namespace {

Result<void> write_capture(const WalkRequest& request, const KeptFrame& kept, const Engine& engine) {
    if (!kept.kept) {
        return Error{request.capture_file, fmt::format("Frame {} was not selected in this walk", request.capture_frame),
                     "Choose a frame of the walk with --capture-frame", ErrorKind::misuse};
    }
    return capture::write_capture(request.capture_file, capture_of(kept, request, engine));
}

constexpr std::size_t worst_forms_listed = 8;

/// How many pictures are compared with full detail.
std::uint64_t pictures_wanted(const WalkRequest& request) {
    constexpr std::uint64_t on_a_page = 7;
    return request.pictures > 0 ? request.pictures : request.report_dir.empty() ? 0 : on_a_page;
}

/// Draws the wanted snapshots and full detail, and compares. Stopped: fewer are better than none.
Result<std::vector<report::ReportSnapshot>> render_snapshots(const WalkRequest& request, Engine& engine,
                                                             const SnapshotStore& snapshots, const Progress& progress) {
    std::vector<report::ReportSnapshot> rendered;
    const std::uint64_t wanted = pictures_wanted(request);
    if (wanted == 0) return rendered;
    // Snapshots may be many: those that are used are evenly spread.
    const std::size_t step = std::max<std::size_t>(1, (snapshots.used() + wanted - 1) / wanted);
    for (std::size_t i = 0; i < snapshots.used() && !progress.stopped(); i += step) {
        progress.update("pictures", static_cast<double>(i) / static_cast<double>(snapshots.used()));
        auto snapshot = render_snapshot(engine, snapshots.snapshots()[i]);
        if (!snapshot) return snapshot.error();
        rendered.push_back(std::move(*snapshot));
    }
    return rendered;
}

/// Which forms cost the rendered pictures most.
Result<void> find_worst_forms(Engine& engine, const SnapshotStore& snapshots, std::span<const report::ReportSnapshot> rendered,
                              report::PictureSummary& picture, const Progress& progress) {
    WorstForms worst(engine);
    std::size_t number = 0;
    for (std::size_t i = 0; i < snapshots.used() && number < rendered.size() && !progress.stopped(); ++i) {
        const FrameSnapshot& snapshot = snapshots.snapshots()[i];
        if (snapshot.frame != rendered[number].frame) continue;
        progress.update("worst forms", static_cast<double>(number) / static_cast<double>(rendered.size()));
        if (auto ok = worst.add(snapshot, rendered, number, progress); !ok) return ok;
        ++number;
    }
    if (number == 0 || number < rendered.size() || progress.stopped()) return {};
    picture.forms_compared = true;
    picture.worst_forms = worst.list(worst_forms_listed, rendered);
    picture.resolution_error_share = worst.resolution_share();
    return {};
}

}  // namespace

void take_census(const PlacingPlan& plan, WalkFacts& facts) {
    const std::vector<rt::DeclaredThread> table = thread_table(plan, true, program_invocation_short_name);
    const auto threads = rt::read_threads();
    if (!threads) {
        facts.census_problems = {threads.error().text()};
        return;
    }
    facts.census_problems = rt::census(table, *threads);
    facts.census_problems.insert(facts.census_problems.end(), facts.worker_problems.begin(), facts.worker_problems.end());
    const std::vector<rt::CensusRow> rows = rt::census_rows(table, *threads);
    facts.threads.insert(facts.threads.end(), rows.begin(), rows.end());
}

SnapshotStore make_snapshot_store(const WalkRequest& request, std::uint64_t frames, const SnapshotRoom& room,
                                  std::vector<std::string>& notes) {
    const bool for_pictures = request.snap_every == 0;
    const std::uint64_t pictures = pictures_wanted(request);
    if (for_pictures && pictures == 0) return {0, 0, 0};
    const std::uint64_t spread = std::max<std::uint64_t>(1, (frames - 1) / std::max<std::uint64_t>(1, pictures - 1));
    const std::uint64_t every = for_pictures ? spread : request.snap_every;
    const std::uint64_t wanted = for_pictures ? pictures : (frames - 1) / every + 1;
    const bool with_last = pictures > 0;
    const std::uint64_t fit = snapshots_that_fit(room, with_last);
    if (wanted > fit) {
        notes.push_back(
            fmt::format("{}: {} of {} pictures are kept, because no more fit in {} MiB of memory. Take fewer with {}",
                        for_pictures ? "--pictures" : "--snap", fit, wanted, snapshot_memory_bytes >> 20U,
                        for_pictures ? fmt::format("--pictures {}", fit) : fmt::format("--every {}", (frames - 1) / fit + 1)));
    }
    return {every, static_cast<std::size_t>(std::min(wanted, fit)), room, with_last};
}

void write_outputs(const WalkRequest& request, const KeptFrame& kept, Engine& engine, const SnapshotStore& snapshots,
                   WalkOutcome& outcome, const Progress& progress) {
    const auto put = [&](const std::string& place, auto write) {
        if (place.empty()) return;
        if (Result<void> written = write(); !written) outcome.failures.push_back(written.error());
    };
    put(request.ledger_file, [&] { return report::write_ledger(request.ledger_file, outcome.records); });
    put(request.trace_file, [&] { return report::write_trace(request.trace_file, outcome.records); });
    put(request.capture_file, [&] { return write_capture(request, kept, engine); });
    if (!outcome.lost) put(request.snap_dir, [&] { return write_snaps(engine, snapshots, request.snap_dir, progress); });
    std::vector<report::ReportSnapshot> rendered;
    if (!outcome.lost) {
        if (auto drawn = render_snapshots(request, engine, snapshots, progress); drawn)
            rendered = std::move(*drawn);
        else
            outcome.failures.push_back(drawn.error());
    }
    outcome.summary.picture = report::compare_pictures(rendered);
    for (const report::ReportSnapshot& snapshot : rendered) outcome.pictures.push_back(report::figures_of(snapshot));
    put(request.report_dir, [&] { return find_worst_forms(engine, snapshots, rendered, outcome.summary.picture, progress); });
    put(request.report_dir, [&]() -> Result<void> {
        if (auto written = report::write_report(request.report_dir, outcome.summary, outcome.records, rendered); !written)
            return written;
        outcome.report_page = request.report_dir + "/index.html";
        return {};
    });
}

}  // namespace surefoot::walk
