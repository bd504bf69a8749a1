// The session: opens everything from a neutral thread, places the threads, runs the frame loop, sums up and writes.
#include "tools/app/walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "render/engine.hpp"
#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "rt/clock/clock.hpp"
#include "rt/frame/control.hpp"
#include "rt/frame/loop.hpp"
#include "rt/monitor/recorder.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "tools/app/control_proof.hpp"
#include "tools/app/input_session.hpp"
#include "tools/app/outputs.hpp"
#include "tools/app/path_source.hpp"
#include "tools/app/placing.hpp"
#include "tools/app/prepare_thread.hpp"
#include "tools/app/real_time.hpp"
#include "tools/app/state.hpp"
#include "tools/app/walk_results.hpp"
#include "tools/app/walk_stages.hpp"

namespace surefoot::app {

namespace {

constexpr double budget_share = 0.80;             // of the period, where none is asked for
constexpr std::uint64_t most_frames = 4'000'000;  // records of 0.4 KiB
constexpr double limit_share = 0.88;              // of the period: when the in-frame check wants the frame done

/// Everything that one walk holds, in the order in which it must be made and (backwards) taken down.
struct Session {
    const WalkRequest& request;
    const WalkWatch& watch;
    WalkFacts facts;
    PlacingPlan plan;
    std::unique_ptr<Engine> engine;
    ChosenPath path;
    std::unique_ptr<InputSession> input;  ///< null: the path is followed
    WalkInput input_told;
    std::vector<std::string> notes;
    rt::Grid grid;
    rt::LatePolicy late = rt::LatePolicy::lock;
    bool virtual_clock = false;
    std::uint64_t frames = 0;  ///< 0: until stopped
    std::vector<pid_t> rasterisers;
    rt::TripleBuffer<PoseSample> poses;
    rt::TripleBuffer<prepare::PreparedFrame> prepared;
    KeptFrame kept;
    rt::ControlSchedule control;
    std::int64_t burn_ns = 0;  ///< the control's
    model::CostModel costs;
    std::atomic<bool> lost{false};  ///< the graphics context

    Session(const WalkRequest& r, const WalkWatch& w) : request(r), watch(w) {}
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    /// On every way out, refusals included: the memory that claim() had locked.
    ~Session() {
        if (!virtual_clock && rt::guard_active()) rt::release_memory();
    }
};

/// Where nothing is kept, nothing can be summed up or written.
Result<void> read_endless(const WalkRequest& r) {
    if (r.control || r.frames > 0 || r.seconds > 0)
        return Error{"a walk without end", "was given an end", "leave one of them out"};
    const bool writes = !(r.ledger_file + r.trace_file + r.report_dir + r.snap_dir + r.capture_file).empty();
    if (writes)
        return Error{"a walk without end", "keeps no frames, so none can be written", "leave out the outputs, or give it an end"};
    return {};
}

Result<void> read_request(Session& s) {
    const WalkRequest& r = s.request;
    auto late = rt::parse_late_policy(r.late);
    if (!late) return late.error();
    s.late = *late;
    auto period = rt::period_of_rate_ns(r.rate_hz);
    if (!period) return period.error();
    s.grid.period_ns = *period;
    if (r.clock != "real" && r.clock != "virtual")
        return Error{"--clock " + r.clock, "there is no such clock", "real or virtual"};
    s.virtual_clock = r.clock == "virtual";
    if (r.control && s.virtual_clock) return Error{"--control", "judges real time", "leave out --clock virtual"};
    if (r.strict && s.virtual_clock) return Error{"--strict", "asks for real time", "leave out --clock virtual"};
    if (r.input_file == live_input && s.virtual_clock)
        return Error{"--input devices", "are hands in real time", "leave out --clock virtual, or give a recording"};
    if (!r.input_file.empty() && r.control)
        return Error{"--control", "compares blocks of the same walk, and nobody steers the same twice", "leave out --input"};
    return r.endless ? read_endless(r) : Result<void>{};
}

void tell(const Session& s, WalkStep step) {
    if (s.watch.on_step) s.watch.on_step(step);
}

/// Read first of all: a wrong steering file is found before a large model is opened.
Result<void> open_input(Session& s) {
    if (s.request.input_file.empty()) return {};
    tell(s, WalkStep::input);
    auto input = InputSession::open(s.request, s.grid.period_ns, s.notes);
    if (!input) return input.error();
    s.input = std::move(*input);
    return {};
}

/// Real time and the cost table, or what they lack; with --strict a lack is an error.
Result<void> claim(Session& s) {
    const WalkRequest& r = s.request;
    tell(s, WalkStep::real_time);
    auto plan = claim_real_time(r, !s.virtual_clock, s.facts);
    if (!plan) return plan.error();
    s.plan = *plan;
    s.plan.input = s.input != nullptr;
    s.plan.devices = s.input && s.input->live();
    tell(s, WalkStep::input);
    auto costs = load_costs(state_directory(r.state_dir), "", s.facts.uncalibrated);
    if (!costs) return costs.error();
    s.costs = std::move(*costs);
    if (!r.strict) return {};
    tell(s, WalkStep::real_time);
    std::vector<report::Degraded> lacks = s.facts.degraded;
    if (!s.facts.uncalibrated.empty()) lacks.push_back({s.facts.uncalibrated, ""});
    return require_real_time(lacks);
}

Result<void> open_session(Session& s, const Progress& progress) {
    const WalkRequest& r = s.request;
    tell(s, WalkStep::model);
    progress.say("open", 0.1);
    model::WalkFileInfo file;
    auto model = model::read_walk(r.model_file, &file);
    if (!model) return model.error();
    auto costs = fitted_costs(state_directory(r.state_dir), s.costs, {file.hash, r.width, r.height, r.backend});
    if (!costs) return costs.error();
    s.costs = std::move(*costs);
    auto path = choose_path(r.path_file, r.model_file, *model, r.lift_m);
    if (!path) return path.error();
    s.path = std::move(*path);

    EngineOptions options;
    auto kind = gl::parse_backend(r.backend);
    if (!kind) return kind.error();
    options.device.kind = *kind;
    options.device.viewport = {r.width, r.height};
    options.device.rasterisers = r.rasterisers;
    options.device.sky = r.sky;
    options.null.cost_scale = r.cost_scale;
    options.null.noise = r.cost_noise;
    const int others = s.plan.all.count() - (s.plan.all.has(s.plan.frame_core) ? 1 : 0);
    options.prepare.workers = r.workers > 0 ? r.workers : std::max(1, others);
    options.selector = r.selector;
    options.slice_us = r.slice_us;
    options.hysteresis = static_cast<float>(r.hysteresis);
    options.in_frame_check = r.in_frame_check;
    tell(s, WalkStep::device);
    progress.say("open", 0.5);
    auto engine = Engine::open(std::move(*model), s.costs, options);
    if (!engine) return engine.error();
    s.engine = std::move(*engine);
    s.facts.renderer = s.engine->device().renderer();
    s.facts.machine = measure::machine_identity(s.facts.renderer, r.rasterisers);
    if (s.costs.calibrated && *kind != gl::BackendKind::null && s.costs.machine != s.facts.machine) {
        s.facts.uncalibrated = "the cost table was measured on \"" + s.costs.machine + "\", this is \"" + s.facts.machine +
                               "\"; run `surefoot calibrate` here";
        if (r.strict) {
            tell(s, WalkStep::real_time);
            return require_real_time(std::vector<report::Degraded>{{s.facts.uncalibrated, ""}});
        }
    }
    for (std::size_t i = 0; i < 3; ++i) s.engine->reserve(s.prepared.slot(i));
    if (r.capture_file.empty()) return {};
    s.engine->reserve(s.kept.prepared);
    select::reserve(s.kept.cut, s.engine->options().prepare.max_candidates);
    s.kept.memory.reserve(s.engine->model().nodes.size());
    return {};
}

/// A few frames at the start of the path, so that programs, buffers and caches are warm and memory is touched.
void warm_up(Session& s) {
    Engine& engine = *s.engine;
    engine.device().bind();
    SubmitLimits limits;
    limits.limit_us = 1e9;
    const double period_us = static_cast<double>(s.grid.period_ns) * 1e-3;
    for (int i = 0; i < 12; ++i) {
        const Pose pose = pose_at(s.path.path, i * s.path.path.duration_s() / 12.0);
        prepare::PreparedFrame& set = s.prepared.slot(0);
        engine.prepare({pose, 0.1, 0.05}, 0, 0, 0, set);
        engine.select(set, budget_share * period_us, {}, 0);
        engine.submit(pose, limits);
        engine.select_coarse();
        engine.submit(pose, limits);
    }
    engine.device().release();
    // Ready for the first frame: a complete set for where the path begins.
    engine.prepare({pose_at(s.path.path, 0), 0.5, 0.2}, 0, 0, 0, s.prepared.back());
    s.prepared.publish();
}

/// How many frames to walk; 0: until stopped. Where each leaves a record in memory, there is an end to them.
Result<std::uint64_t> frames_wanted(const Session& s) {
    if (s.request.endless) return std::uint64_t{0};
    const double period_s = static_cast<double>(s.grid.period_ns) * 1e-9;
    const bool recorded = s.input && !s.input->live();
    const double own_s = recorded ? s.input->duration_s() : std::max(s.path.path.duration_s(), 1.0);
    const double seconds = s.request.seconds > 0 ? s.request.seconds : own_s;
    const double frames = s.request.control      ? static_cast<double>(s.control.slots())
                          : s.request.frames > 0 ? static_cast<double>(s.request.frames)
                                                 : std::max(1.0, std::round(seconds / period_s));
    if (s.request.keep_records && !(frames <= static_cast<double>(most_frames))) {
        const bool asked = s.request.frames > 0 || s.request.seconds > 0 || s.request.control;
        return Error{asked      ? "walk"
                     : recorded ? s.request.input_file
                                : s.path.source,
                     fmt::format("would take {:.4g} frames; at most {} are kept ({:.0f} hours at this rate)", frames, most_frames,
                                 static_cast<double>(most_frames) * period_s / 3600.0),
                     "give a smaller --frames or --seconds"};
    }
    if (!s.request.capture_file.empty() && static_cast<double>(s.request.capture_frame) >= frames) {
        return Error{fmt::format("--capture-frame {}", s.request.capture_frame),
                     fmt::format("the walk has {:.0f} frames, from 0", frames),
                     "choose one of them, or walk longer with --frames"};
    }
    return static_cast<std::uint64_t>(frames);
}

WalkStagesOptions stages_options(Session& s) {
    const double period_us = static_cast<double>(s.grid.period_ns) * 1e-3;
    WalkStagesOptions o;
    o.period_ns = s.grid.period_ns;
    o.budget_us = s.request.budget_ms > 0 ? s.request.budget_ms * 1e3 : budget_share * period_us;
    o.limit_us = limit_share * period_us;
    o.target_error_rad = s.request.accuracy > 0 ? 1.0 / s.request.accuracy : 0;
    o.correct_costs = s.request.correct_costs;
    o.control = s.request.control;
    o.virtual_clock = s.virtual_clock;
    o.cost_scale = s.request.cost_scale;
    if (!s.request.capture_file.empty()) o.capture_frame = s.request.capture_frame;
    if (s.watch.inject) o.inject = &s.watch.inject;
    o.lost = &s.lost;
    return o;
}

void tell_started(const Session& s) {
    if (!s.watch.on_started) return;
    WalkStart start;
    start.t0_ns = s.grid.t0_ns;
    start.period_ns = s.grid.period_ns;
    start.degraded = s.facts.degraded;
    start.uncalibrated = s.facts.uncalibrated;
    start.renderer = s.facts.renderer;
    start.path = s.path.source;
    start.fifo = s.plan.fifo;
    start.locked = s.facts.locked;
    start.isolated = s.facts.isolated;
    start.frame_core = s.plan.frame_core;
    start.rasterisers = s.plan.rasterisers;
    s.watch.on_started(start);
}

void tell_input(Session& s) {
    if (!s.watch.on_input || !s.input || s.input->now() == s.input_told) return;
    s.input_told = s.input->now();
    s.watch.on_input(s.input_told);
}

void tell_census(const Session& s) {
    if (!s.watch.on_degraded) return;
    for (const std::string& problem : s.facts.census_problems) s.watch.on_degraded({"thread census: " + problem, ""});
}

/// How much of the walk is done, 0..1; of a walk without end nothing.
double share_done(const Session& s, double slots_ran) {
    return s.frames == 0 ? 0.0 : std::clamp(slots_ran / static_cast<double>(s.frames), 0.0, 1.0);
}

/// After the frames: what kept the input thread from its place must be said.
void end_input(Session& s, const Progress& progress) {
    if (!s.input) return;
    if (const auto misplaced = s.input->end(progress, s.notes))
        s.facts.degraded.push_back({misplaced->place + ": " + misplaced->what, misplaced->remedy});
}

/// The frame loop on its own thread; the caller's thread waits, and takes the census meanwhile.
void run_loop(Session& s, ShotStore& shots, rt::SpscRing<rt::FrameRecord>& ring, const Progress& progress) {
    rt::RealClock real;
    rt::VirtualClock virtual_time;
    rt::Clock& clock = s.virtual_clock ? static_cast<rt::Clock&>(virtual_time) : real;
    rt::FrameLoopOptions options;
    options.period_ns = s.grid.period_ns;
    options.frames = s.frames;
    options.late = s.late;
    options.control = s.request.control ? &s.control : nullptr;
    options.stop = progress.stop;
    options.failed = &s.lost;
    options.continued = s.virtual_clock ? nullptr : rt::count_continues();
    const std::vector<pid_t> sharing = on_frame_core(s.plan, s.rasterisers);
    options.rasterisers = s.rasterisers;
    options.rasterisers_on_core = sharing;
    options.limits.fifo = s.plan.fifo;
    if (s.facts.minor_fault_ns > 0) options.limits.minor_fault_ns = s.facts.minor_fault_ns;
    options.wait_for_ring = s.virtual_clock;
    // Far enough ahead that all threads are in place before the first slot.
    options.t0_ns = s.virtual_clock ? s.grid.period_ns : real.now_ns() + 300'000'000;
    s.grid.t0_ns = options.t0_ns;

    std::unique_ptr<PrepareThread> preparing;
    PlaceBuffer* places = s.input ? s.input->places() : nullptr;
    if (!s.virtual_clock) preparing = std::make_unique<PrepareThread>(*s.engine, s.grid, s.poses, s.prepared, places);
    PathPoses path_poses(s.path.path, s.grid.period_ns);
    if (s.input) s.input->begin(s.path.path, s.grid.t0_ns, !s.virtual_clock, input_placement(s.plan));
    PoseSource& pose_source = s.input ? s.input->poses() : static_cast<PoseSource&>(path_poses);
    if (s.virtual_clock) tell_started(s);
    std::atomic<bool> done{false};
    std::optional<Error> misplaced;  // the frame thread's until it is joined
    std::thread frame_thread([&] {
        auto placed = s.virtual_clock
                          ? rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = "sf-frame"})
                          : rt::place_thread(0, frame_placement(s.plan));
        if (!placed) misplaced = placed.error();
        rt::prefault_stack();
        WalkStages stages(*s.engine, pose_source, clock, s.poses, s.prepared, shots, s.kept, stages_options(s));
        s.engine->device().bind();
        s.burn_ns = rt::run_frame_loop(options, clock, stages, ring).burn_ns;
        s.engine->device().release();
        done.store(true);
    });
    if (!s.virtual_clock) {
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        if (auto placed = place_workers(s.plan); !placed)
            s.facts.degraded.push_back({placed.error().what, placed.error().remedy});
        tell_started(s);
    }
    bool counted = s.virtual_clock;
    const int look_ms = s.virtual_clock ? 5 : s.input && s.input->live() ? 10 : 100;
    while (!done.load()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(look_ms));
        if (s.input) s.input->attend(progress, s.notes);
        tell_input(s);
        const double ran =
            s.virtual_clock ? 0.5 : static_cast<double>(real.now_ns() - s.grid.t0_ns) / static_cast<double>(s.grid.period_ns);
        progress.say("walk", share_done(s, ran));
        if (!counted && ran > 30) {
            take_census(s.plan, s.facts);
            tell_census(s);
            counted = true;
        }
    }
    frame_thread.join();
    s.facts.pinned = !misplaced && !s.virtual_clock;
    if (misplaced) {
        s.plan.fifo = false;  // the figures must say so
        s.facts.degraded.push_back({misplaced->what, misplaced->remedy});
    }
    if (preparing) preparing->stop();
    end_input(s, progress);
}

/// What the user should know before the walk begins, where someone listens; else it stays for the end.
void tell_now(std::vector<std::string>& notes, const Progress& progress) {
    if (!progress.note) return;
    for (const std::string& text : notes) progress.note(text);
    notes.clear();
}

/// What was walked until then is summed up; pictures can no longer be drawn.
void note_loss(const Session& s, WalkOutcome& outcome) {
    outcome.lost = s.lost.load();
    if (!outcome.lost) return;
    tell(s, WalkStep::device);
    outcome.failures.push_back({"graphics context", "was lost while walking: the driver was reset, or took it away",
                                "start again; see the kernel's log for resets of the GPU"});
}

}  // namespace

Result<WalkOutcome> run_walk(const WalkRequest& request, const Progress& progress, const WalkWatch& watch) {
    Session s(request, watch);
    tell(s, WalkStep::request);
    if (auto ok = read_request(s); !ok) return ok.error();
    if (auto ok = check_outputs(request); !ok) return ok.error();
    if (auto ok = open_input(s); !ok) return ok.error();
    if (auto ok = claim(s); !ok) return ok.error();
    if (auto ok = open_session(s, progress); !ok) return ok.error();
    s.control = rt::control_schedule(s.grid.period_ns, request.control_block_s, request.control_pairs);
    auto frames = frames_wanted(s);
    if (!frames) return frames.error();
    s.frames = *frames;
    if (!s.virtual_clock) {
        auto placed = place_rasterisers(s.plan);
        if (!placed) return placed.error();
        s.rasterisers = *placed;
    }
    warm_up(s);

    WalkOutcome outcome;
    tell_now(s.notes, progress);
    // After memory is locked: what the store sets aside is locked with it, and touched.
    ShotStore shots = make_shot_store(request, s.frames, s.engine->drawn_capacity(), s.notes);
    rt::SpscRing<rt::FrameRecord> ring(4096);
    ControlBlocks blocks;
    std::uint64_t seen = 0;
    rt::RecorderOptions recorder_options;
    recorder_options.keep = !request.endless && request.keep_records;
    recorder_options.reserve_records = s.frames + 64;
    recorder_options.on_record = [&](const rt::FrameRecord& record) {
        ++seen;
        if (!request.endless) blocks.on_record(record);
        if (watch.on_record) watch.on_record(record);
    };
    rt::Recorder recorder(ring, recorder_options);

    const double steal_before = total_steal_ms();
    tell(s, WalkStep::frames);
    run_loop(s, shots, ring, progress);
    recorder.stop();
    tell(s, WalkStep::ending);
    outcome.notes.insert(outcome.notes.begin(), s.notes.begin(), s.notes.end());
    s.facts.steal_ms = total_steal_ms() - steal_before;
    s.facts.dropped_records = ring.dropped();
    outcome.records = recorder.take_records();
    note_loss(s, outcome);
    outcome.stopped = progress.stopped() && (request.endless || seen < s.frames);
    if (s.input) outcome.summary.input = s.input->summary(outcome.records);
    fill_summary(request, s.facts, s.plan, s.grid.period_ns, s.path.source, *s.engine, outcome);
    if (request.control && !outcome.stopped && !s.lost)
        judge_control(s.plan, s.grid.period_ns, s.burn_ns, blocks, outcome, progress);
    s.engine->device().bind();
    write_outputs(request, s.kept, *s.engine, shots, outcome, progress);
    s.engine->device().release();
    return outcome;
}

}  // namespace surefoot::app
