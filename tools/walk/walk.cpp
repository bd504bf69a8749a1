// A walk: places the threads, runs the frame loop in an open session, sums up and writes.
#include "tools/walk/walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <latch>
#include <thread>

#include "rt/base/mutex.hpp"
#include "rt/clock/clock.hpp"
#include "rt/monitor/recorder.hpp"
#include "rt/threads/usage.hpp"
#include "tools/walk/control_proof.hpp"
#include "tools/walk/prepare_thread.hpp"
#include "tools/walk/walk_results.hpp"
#include "tools/walk/walk_session.hpp"

namespace surefoot::walk {

namespace {

/// Of real-time rasterisers and workers; 0: they share none.
int shared_cores(const Session& s) { return !s.virtual_clock && s.plan.fifo && !s.rasterisers.empty() ? s.plan.all.count() : 0; }

WalkStagesOptions stages_options(Session& s) {
    const double period_us = static_cast<double>(s.grid.period_ns) * 1e-3;
    WalkStagesOptions o{s.request};
    o.period_ns = s.grid.period_ns;
    o.budget_us = s.request.budget_ms > 0 ? s.request.budget_ms * 1e3 : frame_share * period_us;
    o.limit_us = frame_share * period_us;
    o.shared_cores = shared_cores(s);
    o.target_error_rad = s.request.accuracy > 0 ? 1.0 / s.request.accuracy : 0;
    if (!s.request.capture_file.empty()) o.capture_frame = s.request.capture_frame;
    o.capture_missed = s.request.capture_file.empty() && s.observer.on_missed_frame;
    if (s.observer.inject) o.inject = &s.observer.inject;
    o.display = s.observer.display;
    o.lost = &s.lost;
    return o;
}

void notify_started(const Session& s) {
    if (!s.observer.on_started) return;
    WalkStart start;
    start.t0_ns = s.grid.t0_ns;
    start.period_ns = s.grid.period_ns;
    start.degraded = s.facts.degraded;
    start.uncalibrated = s.facts.uncalibrated;
    start.renderer = s.facts.renderer;
    start.path = s.path.source;
    start.granted = {s.plan.fifo, s.facts.locked, s.facts.isolated, s.plan.frame_core};
    start.rasterisers = s.plan.rasterisers;
    s.observer.on_started(start);
}

void notify_input(Session& s) {
    if (!s.observer.on_input || !s.input || s.input->now() == s.reported_input) return;
    s.reported_input = s.input->now();
    s.observer.on_input(s.reported_input);
}

void notify_census(const Session& s) {
    if (!s.observer.on_degraded) return;
    for (const std::string& problem : s.facts.census_problems)
        s.observer.on_degraded({rt::LackKind::census, "thread census: " + problem, ""});
}

/// How much of the walk is done, 0..1; of a walk without end nothing.
double share_done(const Session& s, double slots_ran) {
    return s.frames == 0 ? 0.0 : std::clamp(slots_ran / static_cast<double>(s.frames), 0.0, 1.0);
}

/// After the frames: an input thread that could not be placed must be reported.
void end_input(Session& s, const Progress& progress) {
    if (!s.input) return;
    if (const auto misplaced = s.input->end(progress, s.notes))
        s.facts.degraded.push_back({rt::LackKind::placing, misplaced->place + ": " + misplaced->what, misplaced->remedy});
}

rt::FrameLoopOptions loop_options(Session& s, const Progress& progress) {
    rt::FrameLoopOptions o;
    o.period_ns = s.grid.period_ns;
    o.t0_ns = s.grid.t0_ns;
    o.frames = s.frames;
    o.late = s.request.late;
    o.shows = !s.virtual_clock;
    o.display = s.display ? &*s.display : nullptr;
    o.control = s.request.control ? &s.control : nullptr;
    o.stop = progress.stop;
    o.failed = &s.lost;
    if (s.window) o.left = &s.window->left();
    if (s.may_be_prolonged) o.prolonged = &s.prolonged;
    o.prolonged_frames = s.request.max_kept_frames;
    o.continued = s.virtual_clock ? nullptr : rt::count_continues();
    o.rasterisers = s.rasterisers;
    o.rasterisers_on_core = s.on_frame_core;
    o.limits.fifo = s.plan.fifo;
    if (s.facts.minor_fault_ns > 0) o.limits.minor_fault_ns = s.facts.minor_fault_ns;
    o.wait_for_ring = s.virtual_clock;
    return o;
}

void notify_missed_frame(Session& s) {
    if (!s.request.capture_file.empty() || !s.observer.on_missed_frame || !s.kept.kept.load(std::memory_order_acquire)) return;
    s.observer.on_missed_frame(capture_of(s.kept, s.request, *s.engine));
    s.kept.kept.store(false, std::memory_order_release);
}

/// What became of the screen.
void notify_screen(Session& s, const Progress& progress) {
    for (std::string& line : s.engine->device().watch_screen()) {
        if (progress.notify)
            progress.notify(line);
        else
            s.notes.push_back(std::move(line));
    }
}

/// The kernel's steal of each core as it is now, beside what the frames' own clocks see.
void read_core_steal(Session& s) {
    const MutexLock in_order(s.steal_order);  // two threads read
    const std::int64_t begun_ns = rt::monotonic_ns();
    const auto steal = rt::read_steal();
    s.steal->read(begun_ns, steal ? std::span<const double>(steal->cpu_ms) : std::span<const double>());
}

/// The end of the frame loop: its thread says so, and the supervising one waits for it.
class LoopEnd {
public:
    void set() {
        {
            const MutexLock lock(mutex_);
            ended_ = true;
        }
        changed_.notify_all();
    }
    /// False: it has not ended within so long.
    bool within(std::chrono::milliseconds time) {
        const auto until = std::chrono::steady_clock::now() + time;
        const MutexLock lock(mutex_);
        while (!ended_ && changed_.wait_until(mutex_, until)) {
        }
        return ended_;
    }

private:
    Mutex mutex_;
    Condition changed_;
    bool ended_ GUARDED_BY(mutex_) = false;
};

/// While the frame thread walks: serves the input, reports progress, and counts the threads once all have started.
void supervise(Session& s, rt::Clock& clock, LoopEnd& end, const Progress& progress) {
    bool counted = s.virtual_clock;
    constexpr std::int64_t steal_every_ns = 95'000'000;  // so long do frames share a reading
    std::int64_t steal_read_ns = 0;
    const int look_ms = s.virtual_clock ? 5 : s.input && s.input->live() ? 10 : 100;
    for (bool ended = false; !ended;) {
        ended = end.within(std::chrono::milliseconds(look_ms));  // and looks once more then
        if (s.input) s.input->poll(progress, s.notes);
        notify_screen(s, progress);
        notify_input(s);
        if (s.may_be_prolonged && s.input->used()) s.prolonged.store(true, std::memory_order_relaxed);
        notify_missed_frame(s);
        if (s.steal && rt::monotonic_ns() - steal_read_ns >= steal_every_ns) {
            steal_read_ns = rt::monotonic_ns();
            read_core_steal(s);
        }
        const double ran =
            s.virtual_clock ? 0.5 : static_cast<double>(clock.now_ns() - s.grid.t0_ns) / static_cast<double>(s.grid.period_ns);
        progress.update("walk", share_done(s, ran));
        if (!counted && ran > 30) {
            take_census(s.plan, s.facts);
            notify_census(s);
            counted = true;
        }
    }
}

/// The frame loop on its own thread; the caller's thread supervises meanwhile.
void run_loop(Session& s, SnapshotStore& snapshots, rt::SpscRing<rt::FrameRecord>& ring, const Progress& progress) {
    rt::RealClock real;
    rt::VirtualClock virtual_time;
    rt::Clock& clock = s.virtual_clock ? static_cast<rt::Clock&>(virtual_time) : real;
    // Far enough ahead that all threads are in place before the first slot, and the first view is rehearsed.
    constexpr std::int64_t in_place_ns = 300'000'000, max_rehearsal_ns = 1'200'000'000;
    const std::int64_t rehearsal_ns =
        rehearses(s.request, s.virtual_clock) ? std::min(rehearsed_frames * s.grid.period_ns, max_rehearsal_ns) : 0;
    const std::int64_t ahead_ns = in_place_ns + rehearsal_ns;
    if (s.display)
        s.grid = s.display->grid_from(real.now_ns() + ahead_ns);
    else
        s.grid.t0_ns = s.virtual_clock ? s.grid.period_ns : real.now_ns() + ahead_ns;
    s.on_frame_core = on_frame_core(s.plan, s.rasterisers);
    const rt::FrameLoopOptions options = loop_options(s, progress);

    PathPoses path_poses(s.path.path, s.grid.period_ns, s.engine->options().device.viewport);
    if (s.input)
        s.input->begin(s.path.path, s.engine->model(), s.grid.t0_ns, !s.virtual_clock, input_placement(s.plan), &path_poses);
    std::unique_ptr<PrepareThread> preparing;
    JumpBuffer* jump_poses = s.input ? s.input->jump_poses() : nullptr;
    RegionClip* clip = s.input ? s.input->clip() : nullptr;
    if (!s.virtual_clock) {
        preparing = std::make_unique<PrepareThread>(*s.engine, s.grid, s.poses, s.prepared, jump_poses, clip,
                                                    prepare_placement(s.plan), shared_cores(s) > 0, s.observer.inject_prepare);
        if (const auto& refused = preparing->misplaced())
            s.facts.degraded.push_back({rt::LackKind::placing, refused->what, refused->remedy});
    }
    PoseSource& pose_source = s.input ? s.input->poses() : static_cast<PoseSource&>(path_poses);
    if (s.virtual_clock) notify_started(s);
    LoopEnd end;
    std::optional<Error> misplaced;  // the frame thread's until it is in place
    std::latch in_place(1);
    std::thread frame_thread([&] {
        auto placed = s.virtual_clock
                          ? rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = "sf-frame"})
                          : rt::place_thread(0, frame_placement(s.plan));
        if (!placed) misplaced = placed.error();
        in_place.count_down();
        rt::prefault_stack();
        if (!s.virtual_clock) rt::prefault_heap();
        WalkStagesOptions of_stages = stages_options(s);
        of_stages.stop = progress.stop;
        if (s.window) of_stages.left = &s.window->left();
        of_stages.clip = clip;
        WalkStages stages(*s.engine, pose_source, clock, s.poses, s.prepared, snapshots, s.kept, of_stages);
        s.engine->device().bind();
        stages.rehearse(s.grid.t0_ns);
        s.burn_ns = rt::run_frame_loop(options, clock, stages, ring).burn_ns;
        s.engine->device().release();
        end.set();
    });
    in_place.wait();
    if (!s.virtual_clock) notify_started(s);
    supervise(s, clock, end, progress);
    frame_thread.join();
    notify_screen(s, progress);
    notify_missed_frame(s);
    s.facts.pinned = !misplaced && !s.virtual_clock;
    if (misplaced) {
        s.plan.fifo = false;  // the figures must say so
        s.facts.degraded.push_back({rt::LackKind::placing, misplaced->what, misplaced->remedy});
    }
    if (preparing) preparing->stop();
    end_input(s, progress);
}

/// What the user should know before the walk begins, where someone listens; else it stays for the end.
void notify_user(std::vector<std::string>& notes, const Progress& progress) {
    if (!progress.notify) return;
    for (const std::string& text : notes) progress.notify(text);
    notes.clear();
}

/// What was walked until then is summed up; pictures can no longer be drawn.
void record_loss(const Session& s, WalkOutcome& outcome) {
    outcome.lost = s.lost.load();
    if (!outcome.lost) return;
    notify_step(s, WalkStep::device);
    outcome.failures.push_back(Error{"graphics context", "The context was lost while walking: the driver was reset or removed",
                                     "Start again, and see the kernel's log for resets of the GPU", ErrorKind::no_device});
}

void end_window(Session& s, WalkOutcome& outcome) {
    if (!s.window) return;
    s.window->stop();
    outcome.left = s.window->left().load();
    if (std::string refused = s.window->refused(); !refused.empty()) outcome.notes.push_back(std::move(refused));
}

/// A walk that a visitor prolongs has no length that he gave, so its end must be explained.
void add_length_message(const Session& s, std::uint64_t seen, WalkOutcome& outcome) {
    if (!s.prolonged.load() || seen + s.facts.dropped_records < s.request.max_kept_frames) return;
    outcome.notes.push_back(fmt::format(
        "The walk ended after {} frames: no more are kept. Start it again, or let surefootd run it, which keeps none.", seen));
}

}  // namespace

Result<WalkOutcome> run_walk(const WalkRequest& request, const Progress& progress, const WalkObserver& observer) {
    Session s(request, observer);
    if (auto ok = open_session(s, progress); !ok) return ok.error();
    if (!s.virtual_clock) {
        auto placed = place_rasterisers(s.plan);
        if (!placed) return placed.error();
        s.rasterisers = *placed;
    }
    warm_up(s);
    open_window_thread(s);
    s.plan.unnamed = count_unnamed(program_invocation_short_name);

    WalkOutcome outcome;
    notify_user(s.notes, progress);
    // After memory is locked: what the store sets aside is locked with it, and touched.
    SnapshotStore snapshots =
        make_snapshot_store(request, s.frames, {s.engine->drawn_capacity(), s.engine->picture_capacity()}, s.notes);
    snapshots.reserve_boxes(s.engine->cache_boxes().size());
    rt::SpscRing<rt::FrameRecord> ring(4096);
    ControlBlocks blocks;
    std::uint64_t seen = 0;
    rt::RecorderOptions recorder_options;
    recorder_options.keep = !request.endless && request.keep_records;
    recorder_options.reserve_records = s.frames + 64;
    if (s.virtual_clock) recorder_options.poll_ns = 10'000'000;  // frames wait for a full ring
    recorder_options.on_record = [&](const rt::FrameRecord& record) {
        ++seen;
        if (!request.endless) blocks.on_record(record);
        if (observer.on_record) observer.on_record(record);
    };
    if (!s.virtual_clock) {
        s.steal.emplace(s.plan.frame_core, s.rasterisers.empty() ? rt::CpuMask{} : s.plan.all);
        read_core_steal(s);  // before the first frame is due
        recorder_options.on_batch = [&](std::span<rt::FrameRecord> records) {
            read_core_steal(s);
            s.steal->judge(records);
        };
    }
    rt::Recorder recorder(ring, recorder_options);

    const double steal_before = total_steal_ms();
    notify_step(s, WalkStep::frames);
    run_loop(s, snapshots, ring, progress);
    recorder.stop();
    notify_step(s, WalkStep::ending);
    outcome.notes.insert(outcome.notes.begin(), s.notes.begin(), s.notes.end());
    s.facts.steal_ms = total_steal_ms() - steal_before;
    s.facts.dropped_records = ring.dropped();
    outcome.records = recorder.take_records();
    record_loss(s, outcome);
    end_window(s, outcome);
    outcome.stopped = progress.stopped() && !outcome.left && (request.endless || s.prolonged.load() || seen < s.frames);
    add_length_message(s, seen, outcome);
    if (s.input) outcome.summary.input = s.input->summary(outcome.records);
    fill_summary(request, s.facts, s.plan, s.grid.period_ns, s.path.source, *s.engine, outcome);
    if (s.window) outcome.summary.display = s.window->displayed();
    if (request.control && !outcome.stopped && !outcome.left && !s.lost)
        judge_control(s.plan, s.grid.period_ns, s.burn_ns, blocks, outcome, progress);
    if (seen == 0 && (outcome.stopped || outcome.left)) {  // nothing to show: what an earlier walk left stays
        outcome.notes.emplace_back("stopped before the first frame: nothing is written");
        return outcome;
    }
    s.engine->device().bind();
    write_outputs(request, s.kept, *s.engine, snapshots, outcome, progress);
    s.engine->device().release();
    return outcome;
}

}  // namespace surefoot::walk
