// A soak: the timetable, the load beside, the walk, the verdict.
#include "tools/soak/soak.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "config/settings.hpp"
#include "input/map/steering_file.hpp"
#include "rt/base/path.hpp"
#include "rt/clock/grid.hpp"
#include "tools/soak/footprint.hpp"
#include "tools/soak/load_runner.hpp"
#include "tools/soak/machine_facts.hpp"
#include "tools/soak/soak_verdict.hpp"
#include "tools/soak/tally.hpp"
#include "tools/walk/settings_request.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::soak {

namespace {

constexpr double after_the_end_s = 120;  // how long load may outlive its plan: the control's proof, and a late judge
constexpr double max_samples = 7200;
constexpr double virtual_sample_s = 10;

/// Does what a service does when it reloads its settings: reads all of them, on an ordinary thread.
bool reload_once(const walk::WalkRequest& r) {
    config::Configuration c(walk::settings_schema());
    const auto read = r.config_file.empty() ? config::load_text(c, config::commented_defaults(*c.schema), "defaults")
                                            : config::load_file(c, r.config_file);
    const auto steering = input::parse_steering(input::steering_text({}), "defaults");
    std::string note;
    const auto costs = walk::load_costs(walk::state_directory(r.state_dir), "", note);
    const bool path_read = r.path_file.empty() || read_path(r.path_file).ok();
    return read.ok() && config::check(c).ok() && steering.ok() && costs.ok() && path_read;
}

/// One soak while it runs.
struct Soak {
    const SoakRequest& request;
    walk::WalkRequest walk;
    LoadPlan plan;
    bool virtual_clock = false;
    std::optional<LoadRunner> runner;
    LoadCounters own;  ///< of the reloads, which are this process's work
    std::unique_ptr<SoakTally> tally;
    std::unique_ptr<Footprint> footprint;
    double next_sample_s = 0;  ///< on the virtual clock
};

Result<void> make_plan(Soak& s) {
    const SoakRequest& r = s.request;
    const auto period_ns = rt::period_of_rate_ns(r.walk.rate_hz);
    if (!period_ns) return period_ns.error();
    s.walk = r.walk;
    s.virtual_clock = r.walk.clock == rt::ClockKind::virtual_time;
    s.walk.control = r.control && !s.virtual_clock;
    s.walk.keep_records = false;
    s.walk.report_dir.clear();
    const double pair_s = 2 * s.walk.control_block_s;
    double seconds = r.seconds;
    if (s.walk.control) {
        s.walk.control_pairs = static_cast<std::uint32_t>(std::max(1.0, std::floor(seconds / pair_s)));
        const rt::ControlSchedule schedule = rt::control_schedule(*period_ns, s.walk.control_block_s, s.walk.control_pairs);
        seconds = static_cast<double>(schedule.slots()) * static_cast<double>(*period_ns) * 1e-9;
    } else {
        s.walk.seconds = seconds;
    }
    s.plan = plan_loads(s.virtual_clock ? r.mix & virtual_loads : r.mix, seconds, pair_s, r.seed);
    s.tally = std::make_unique<SoakTally>(s.plan, *period_ns, seconds);
    s.footprint = std::make_unique<Footprint>(static_cast<std::size_t>(max_samples) + 16);
    return {};
}

LoadSettings load_settings(const Soak& s) {
    LoadSettings settings;
    settings.cores = std::max(1, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)));
    // At most an eighth of the machine's memory: the load is to press, not to push others out.
    const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)), page = static_cast<double>(sysconf(_SC_PAGESIZE));
    settings.memory_bytes = std::min(settings.memory_bytes, static_cast<std::uint64_t>(pages * page / 8));
    std::error_code failed;
    settings.folder = std::filesystem::temp_directory_path(failed).string();
    if (failed) settings.folder = "/tmp";
    settings.clock_step_s = s.request.clock_step_s;
    settings.input_priority = (s.walk.frame_priority + s.walk.raster_priority) / 2;
    settings.longest_s = s.plan.seconds + after_the_end_s;
    return settings;
}

void reload(Soak& s) { reload_once(s.walk) ? ++s.own.amount : ++s.own.failures; }

walk::WalkObserver observer_of(Soak& s) {
    walk::WalkObserver observer;
    observer.on_started = [&s](const walk::WalkStart& start) {
        s.tally->begin(start.t0_ns);
        if (s.runner) s.runner->begin(start.t0_ns);
        if (s.virtual_clock) return;
        const double every_s = std::max(1.0, s.plan.seconds / max_samples);
        s.footprint->watch(start.t0_ns, every_s, [&s](double time_s) {
            if (has_load(s.plan.at(time_s), LoadKind::reloads)) reload(s);
        });
    };
    observer.on_record = [&s](const rt::FrameRecord& record) {
        s.tally->add(record);
        if (!s.virtual_clock) return;
        const double time_s = s.tally->ran_s();
        if (time_s < s.next_sample_s) return;
        const double every_s = std::max(virtual_sample_s, s.plan.seconds / max_samples);
        s.next_sample_s = (std::floor(time_s / every_s) + 1) * every_s;
        if (has_load(s.plan.at(time_s), LoadKind::reloads)) reload(s);
        s.footprint->take(time_s);
    };
    return observer;
}

void describe_loads(const Soak& s, SoakSummary& summary) {
    for (std::size_t i = 0; i < load_kinds; ++i) {
        const auto kind = static_cast<LoadKind>(i);
        if (!has_load(s.plan.mix, kind)) continue;
        const LoadCounters& c = kind == LoadKind::reloads || !s.runner ? s.own : s.runner->board().of(kind);
        LoadFigures f;
        f.kind = kind;
        for (const LoadPhase& phase : s.plan.phases)
            if (has_load(phase.loads, kind))
                f.seconds += std::clamp(summary.ran_s - phase.from_s, 0.0, phase.to_s - phase.from_s);
        if (kind != LoadKind::reloads && s.runner) f.seconds = static_cast<double>(c.on_ns.load()) * 1e-9;
        f.amount = static_cast<double>(c.amount.load());
        f.evidence = static_cast<double>(c.evidence.load());
        f.refused = c.refused.load();
        f.failures = c.failures.load();
        f.cores = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
        const report::ControlSummary& control = summary.walk.control;
        summary.loads.push_back(describe_load(f, control.ran ? control.other_miss_share : -1));
    }
}

}  // namespace

Result<SoakOutcome> run_soak(const SoakRequest& request, const Progress& progress) {
    if (!request.report_dir.empty()) {
        if (auto ok = probe_soak_page(request.report_dir); !ok) return ok.error();
    }
    Soak s{request, {}, {}, false, {}, {}, {}, {}, 0};
    if (auto ok = make_plan(s); !ok) return ok.error();
    if (!s.virtual_clock) {
        auto runner = LoadRunner::start(s.plan, load_settings(s));
        if (!runner) return runner.error();
        s.runner.emplace(std::move(*runner));
    }
    const MachineCounters before = read_counters();
    auto walked = walk::run_walk(s.walk, progress, observer_of(s));
    s.footprint->stop();
    if (s.runner) s.runner->stop();
    if (!walked) return walked.error();

    SoakOutcome outcome;
    outcome.notes = std::move(walked->notes);
    outcome.failures = std::move(walked->failures);
    SoakSummary& summary = outcome.summary;
    summary.walk = std::move(walked->summary);
    s.tally->fill(summary);
    summary.command_line = own_command_line();
    summary.seed = request.seed;
    summary.requested_s = s.plan.seconds;
    summary.stopped = walked->stopped || progress.stopped();
    summary.samples = s.footprint->samples();
    // What is held while the threads go and the control is proven is no longer the walk's.
    std::erase_if(summary.samples, [&](const SoakSample& sample) { return sample.time_s > summary.ran_s; });
    summary.machine = machine_facts(before, read_counters());
    describe_loads(s, summary);
    judge_soak(summary);
    if (request.report_dir.empty()) return outcome;
    if (auto written = write_soak_page(request.report_dir, summary); !written) {
        outcome.failures.push_back(written.error());
    } else {
        outcome.report_page = (std::filesystem::path(request.report_dir) / "index.html").string();
    }
    return outcome;
}

}  // namespace surefoot::soak
