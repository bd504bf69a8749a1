// What a walk leaves: its summary, and the files that were asked for.
#include "tools/app/walk_results.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "render/capture/capture.hpp"
#include "rt/base/file.hpp"

namespace surefoot::app {

void fill_summary(const WalkRequest& request, const WalkFacts& facts, const PlacingPlan& plan, std::int64_t period_ns,
                  const std::string& path_source, const Engine& engine, WalkOutcome& outcome) {
    report::WalkSummary& s = outcome.summary;
    s.model = request.model_file;
    s.path = path_source;
    s.selector = request.selector;
    s.backend = request.backend;
    s.renderer = facts.renderer;
    s.machine = facts.machine;
    s.late_policy = request.late;
    s.clock = request.clock;
    s.width = request.width;
    s.height = request.height;
    s.rate_hz = request.rate_hz;
    s.model_triangles = engine.model().triangles();
    s.rasterisers = static_cast<std::uint32_t>(std::max(1, plan.rasterisers));
    s.fifo = plan.fifo;
    s.pinned = facts.pinned;
    s.isolated = facts.isolated;
    s.locked = facts.locked;
    s.steal_ms = facts.steal_ms;
    s.census_problems = facts.census_problems;
    s.degraded = facts.degraded;
    if (facts.dropped_records > 0) {
        s.degraded.push_back({fmt::format("{} frame records were dropped", facts.dropped_records), "give the monitor thread a core with time left"});
    }
    report::summarize(outcome.records, period_ns, s);
}

namespace {

Result<void> write_capture(const WalkRequest& request, const KeptFrame& kept, const Engine& engine) {
    if (!kept.kept) {
        return Error{request.capture_file, fmt::format("frame {} was not selected in this walk", request.capture_frame),
                     "choose a frame within the walk with --capture-frame"};
    }
    const select::SelectInput input{&engine.model(), &kept.prepared, &engine.costs(), kept.budget_us, kept.correction, kept.target_error_rad, request.slice_us};
    return capture::write_capture(request.capture_file,
                                  capture::take(input, request.selector, static_cast<float>(request.hysteresis), kept.memory, kept.cut));
}

Result<void> write_report_pages(const WalkRequest& request, Engine& engine, const ShotStore& shots, WalkOutcome& outcome, const Progress& progress) {
    std::vector<report::ReportShot> developed;
    // Snapshots may be many: the page shows at most seven of them, evenly spread.
    const std::size_t step = std::max<std::size_t>(1, (shots.used() + 6) / 7);
    for (std::size_t i = 0; i < shots.used(); i += step) {
        if (progress.stopped()) break;  // a shorter page is better than none
        progress.say("pictures", static_cast<double>(i) / static_cast<double>(shots.used()));
        auto shot = develop(engine, shots.shots()[i]);
        if (!shot) return shot.error();
        developed.push_back(std::move(*shot));
    }
    auto written = report::write_report(request.report_dir, outcome.summary, outcome.records, developed);
    if (!written) return written;
    outcome.report_page = request.report_dir + "/index.html";
    return {};
}

}  // namespace

Result<void> write_outputs(const WalkRequest& request, const KeptFrame& kept, Engine& engine, const ShotStore& shots, WalkOutcome& outcome,
                           const Progress& progress) {
    if (!request.ledger_file.empty()) {
        if (auto w = report::write_ledger(request.ledger_file, outcome.records); !w) return w;
    }
    if (!request.trace_file.empty()) {
        if (auto w = report::write_trace(request.trace_file, outcome.records); !w) return w;
    }
    if (!request.capture_file.empty()) {
        if (auto w = write_capture(request, kept, engine); !w) return w;
    }
    if (!request.snap_dir.empty()) {
        if (auto w = write_snaps(engine, shots, request.snap_dir, progress); !w) return w;
    }
    if (!request.report_dir.empty()) return write_report_pages(request, engine, shots, outcome, progress);
    return {};
}

}  // namespace surefoot::app
