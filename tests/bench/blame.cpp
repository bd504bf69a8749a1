// bench_blame [TIMES] [RECORDED.csv]: every cause of a miss injected live TIMES times (50) into the frames of a walk at 60 Hz,
// and how often it was named right. The walk is the product's: its session, stages, prepare thread and rasterisers, in a small
// forest. `stolen`, which cannot be injected from inside a guest, is judged by frames that a host did steal from, recorded by
// bench_stolen_frames and read from RECORDED.csv. An injected frame that the host stole from as well, by its own account, or in
// the readings round it, is left out, right or wrong, and another one injected. Exit status 1 if a cause is named right less than
// 95 % or missed by too few frames, 77 without SCHED_FIFO or a device that draws.
#include "tests/bench/injector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/path.hpp"
#include "rt/base/random.hpp"
#include "rt/clock/grid.hpp"
#include "rt/frame/blame.hpp"
#include "rt/frame/steal_evidence.hpp"
#include "rt/threads/capability.hpp"
#include "tests/bench/stolen_frames.hpp"
#include "tools/scenes/scenes.hpp"
#include "tools/walk/control_proof.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::bench {

namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr double rate_hz = 60;
constexpr int blocker_priority = 90;
constexpr std::array<rt::Cause, 10> live_causes = {
    rt::Cause::woken_late, rt::Cause::preempted,        rt::Cause::select,     rt::Cause::submit,  rt::Cause::raster,
    rt::Cause::upload,     rt::Cause::prepared_too_old, rt::Cause::page_fault, rt::Cause::present, rt::Cause::stopped};

rt::Placement on_core(int core, int priority, const char* name) {
    return {.policy = rt::Policy::fifo, .priority = priority, .cpus = rt::CpuMask{core}, .name = name};
}

}  // namespace

Injector::Injector(rt::Cause cause, int wanted, std::int64_t period_ns, int frame_core, Stopper& stopper)
    : cause_(cause),
      wanted_(wanted),
      period_ns_(period_ns),
      frames_apart_(cause == rt::Cause::prepared_too_old ? 24 : 6),
      stopper_(stopper),
      blocker_(on_core(frame_core, blocker_priority, "blocker")),
      marks_(max_frames) {
    if (cause == rt::Cause::page_fault) pages_.emplace();
}

/// 20 to 36 ms, other for every frame: more than a period, since a frame that is short of time draws less.
std::int64_t Injector::extra_ns(std::uint64_t frame) const {
    Random random(frame * 31 + static_cast<std::uint64_t>(cause_));
    return static_cast<std::int64_t>(random.range(20, 36) * static_cast<double>(ms));
}

/// Sets grow too old when they do: that is seen in the frame itself.
bool Injector::planned(std::uint64_t frame) const {
    return cause_ != rt::Cause::prepared_too_old && frame >= 2 * frames_apart_ && frame % frames_apart_ == frames_apart_ / 2;
}

void Injector::carried_out(const rt::FrameRecord& r) {
    if (r.frame < max_frames) marks_[r.frame].carried_out = true;
}

walk::Fault Injector::at(walk::FramePhase phase, const rt::FrameRecord& r) {
    switch (phase) {
        case walk::FramePhase::sample:
            begin(r);
            break;
        case walk::FramePhase::select:
            in_select(r);
            break;
        case walk::FramePhase::submit:
            return in_submit(r);
        case walk::FramePhase::raster:
            return in_raster(r);
        case walk::FramePhase::finish:
            if (now(r, rt::Cause::woken_late)) {  // the thread wakes next when the picture's time has come
                blocker_.schedule(r.deadline_ns - ms, 0, r.deadline_ns + extra_ns(r.frame));
                blocking_ = true;
                carried_out(r);
            }
            break;
        case walk::FramePhase::present:
            in_present(r);
            break;
    }
    return walk::Fault::none;
}

void Injector::begin(const rt::FrameRecord& r) {
    if (blocking_) blocker_.finish();  // it was given until before this frame
    blocking_ = false;
    drawing_since_ns_ = 0;
    if (r.frame > 0 && injected(r.frame - 1)) marks_[r.frame - 1].stolen_too = walk::total_steal_ms() > steal_before_ms_;
    if (cause_ != rt::Cause::prepared_too_old || r.frame < frames_apart_ || r.frame % frames_apart_ != 0) return;
    stall_ = stalls_ = true;
}

void Injector::in_select(const rt::FrameRecord& r) {
    if (now(r, rt::Cause::select)) clock_.burn_ns(extra_ns(r.frame));
    if (now(r, rt::Cause::page_fault)) pages_->fault_until(clock_.now_ns() + extra_ns(r.frame));
    if (now(r, rt::Cause::select) || now(r, rt::Cause::page_fault)) carried_out(r);
}

walk::Fault Injector::in_submit(const rt::FrameRecord& r) {
    if (now(r, rt::Cause::preempted)) {
        const std::int64_t from_ns = clock_.now_ns() + ms;
        blocker_.schedule(from_ns, 0, from_ns + extra_ns(r.frame));
        blocking_ = true;
        clock_.burn_ns(2 * ms);
        carried_out(r);
    }
    // What is drawn is what nobody had chosen for this frame: the coarse levels of an old set, at whatever they cost.
    const bool too_old = stalls_ && r.prepared_age > rt::oldest_prepared(period_ns_);
    if (too_old) stalls_ = false;
    if (now(r, rt::Cause::submit) || now(r, rt::Cause::upload) || too_old) {
        clock_.burn_ns(extra_ns(r.frame));
        carried_out(r);
    }
    if (now(r, rt::Cause::stopped) && stopped_for(extra_ns(r.frame))) carried_out(r);
    return now(r, rt::Cause::upload) ? walk::Fault::upload : walk::Fault::none;
}

/// The rasterisers draw the picture again and again.
walk::Fault Injector::in_raster(const rt::FrameRecord& r) {
    if (!now(r, rt::Cause::raster)) return walk::Fault::none;
    const std::int64_t now_ns = clock_.now_ns();
    if (drawing_since_ns_ == 0) drawing_since_ns_ = now_ns;
    carried_out(r);
    return now_ns - drawing_since_ns_ < extra_ns(r.frame) ? walk::Fault::draw_again : walk::Fault::none;
}

void Injector::in_present(const rt::FrameRecord& r) {
    if (now(r, rt::Cause::present)) {
        // In turn: a driver that copies, and a display that is waited for.
        const std::int64_t extra = extra_ns(r.frame);
        if (r.frame / frames_apart_ % 2 == 0) {
            clock_.burn_ns(extra);
        } else {
            clock_.sleep_until_ns(clock_.now_ns() + extra);
        }
        carried_out(r);
    }
    if (pages_ && planned(r.frame - 1)) pages_->renew();  // takes its time, in a frame that nobody counts
    if (planned(r.frame + 1) || stalls_) steal_before_ms_ = walk::total_steal_ms();
}

/// Spins until the clock jumps: that was the stop. False: it did not come in time, and will fall on another frame.
bool Injector::stopped_for(std::int64_t ns) {
    stopper_.stop_for(ns);
    const std::int64_t give_up_ns = clock_.now_ns() + 5 * ms;
    for (std::int64_t before_ns = clock_.now_ns(); before_ns < give_up_ns;) {
        const std::int64_t now_ns = clock_.now_ns();
        if (now_ns - before_ns > ns * 9 / 10) return true;
        before_ns = now_ns;
    }
    return false;
}

void Injector::delay_preparing() {
    if (stall_.exchange(false)) clock_.sleep_until_ns(clock_.now_ns() + (rt::oldest_prepared(period_ns_) + 3) * period_ns_);
}

void Injector::seen(const rt::FrameRecord& r) {
    constexpr int spare = 5;  // some may prove to have two causes
    if (injected(r.frame) && r.missed && !has_two_causes(r.frame) && ++missed_ == wanted_ + spare) enough_ = true;
}

namespace {

struct Named {
    int injected = 0, missed = 0, right = 0;
    int two_causes = 0;  ///< not among the missed
    std::map<std::string, int> instead;
};

/// Gone at the end.
struct Folder {
    std::string path = (std::filesystem::temp_directory_path() / "bench-blame-XXXXXX").string();
    Folder() {
        if (::mkdtemp(path.data()) == nullptr) std::abort();
    }
    ~Folder() { std::filesystem::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

/// A small forest, and the request of a walk through it.
Result<walk::WalkRequest> forest_walk(const std::string& folder, int core) {
    auto scene = scenes::generate("forest", 1, 1);
    if (!scene) return scene.error();
    auto model = bake::bake(scene->scene, {}, {});
    if (!model) return model.error();
    walk::WalkRequest request;
    request.model_file = folder + "/forest.walk";
    request.path_file = folder + "/forest.path.csv";
    if (auto ok = model::write_walk(request.model_file, *model); !ok) return ok.error();
    if (auto ok = write_path(request.path_file, scene->path); !ok) return ok.error();
    request.state_dir = folder;
    request.rate_hz = rate_hz;
    request.width = 640;
    request.height = 360;
    request.budget_ms = 5;
    request.resolution_pct = 100;
    request.rest_after_ms = 0;
    request.frame_core = core;
    return request;
}

/// Some injections are lost to what the machine and its host do meanwhile: as many more are made, up to four times as many as are
/// wanted.
Result<Named> inject(rt::Cause cause, int times, walk::WalkRequest request, Stopper& stopper) {
    const std::int64_t period_ns = *rt::period_of_rate_ns(rate_hz);
    Injector injector(cause, times, period_ns, request.frame_core, stopper);
    request.frames = std::min<std::uint64_t>(Injector::max_frames, static_cast<std::uint64_t>(times) * 4 * 24);
    walk::WalkObserver observer;
    observer.inject = [&](walk::FramePhase phase, const rt::FrameRecord& record) { return injector.at(phase, record); };
    observer.inject_prepare = [&] { injector.delay_preparing(); };
    observer.on_record = [&](const rt::FrameRecord& record) { injector.seen(record); };
    Progress progress;
    progress.stop = &injector.enough();
    const auto outcome = walk::run_walk(request, progress, observer);
    if (!outcome) return outcome.error();
    Named named;
    for (const rt::FrameRecord& r : outcome->records) {
        if (!injector.injected(r.frame) || named.missed == times) continue;
        ++named.injected;
        if (!r.missed) continue;
        if (injector.has_two_causes(r.frame) || r.core_steal_ns > 0) {
            ++named.two_causes;
            continue;
        }
        ++named.missed;
        if (r.cause == cause) {
            ++named.right;
        } else {
            ++named.instead[std::string(rt::cause_of(r))];
        }
    }
    return named;
}

/// Some kernels charge a part of the thefts to the thread that was running: then its CPU clock went on, and nothing in the
/// frame's own clocks tells theft from work. Half of the lateness must be missing from it.
bool clock_stood_still(const rt::FrameRecord& r) {
    return 2 * (r.complete_ns - r.woken_ns - r.cpu_ns) >= r.complete_ns - r.deadline_ns;
}

/// By the frame's own clocks; then, where asked for, by the steal of its core as well.
rt::Cause cause_of_theft(rt::FrameRecord r, bool by_cores) {
    rt::BlameLimits limits;
    limits.period_ns = r.deadline_ns - r.due_ns;
    r.cause = rt::blame(r, limits);
    r.own_miss = rt::is_own_miss(r, limits);
    if (!by_cores) return r.cause;
    const std::array<double, 1> before = {0}, after = {static_cast<double>(r.core_steal_ns) * 1e-6};
    rt::StealEvidence evidence(0, rt::CpuMask{0});
    evidence.read(r.due_ns, before);
    evidence.read(r.complete_ns, after);
    evidence.judge({&r, 1});
    return r.cause;
}

/// Frames that a host stole from, through the classifier alone.
Named classify(const std::vector<rt::FrameRecord>& records, bool clock_still, bool by_cores) {
    Named named;
    for (const rt::FrameRecord& r : records) {
        if (clock_stood_still(r) != clock_still) continue;
        ++named.injected;
        ++named.missed;
        const rt::Cause cause = cause_of_theft(r, by_cores);
        if (cause == rt::Cause::stolen) {
            ++named.right;
        } else {
            ++named.instead[std::string(rt::cause_names[static_cast<std::size_t>(cause)])];
        }
    }
    return named;
}

bool print_row(std::string_view cause, const Named& n, int wanted) {
    const bool enough = n.missed >= wanted, right = n.right * 100 >= n.missed * 95;
    std::string instead;
    for (const auto& [name, count] : n.instead) instead += fmt::format(" {} {}", name, count);
    if (n.two_causes > 0) instead += fmt::format(" (left out, stolen from too: {})", n.two_causes);
    fmt::print("{:<18}{:>9}{:>8}{:>8}{:>8.1f} %  {}{}\n", cause, n.injected, n.missed, n.right,
               n.missed > 0 ? 100.0 * n.right / n.missed : 0.0,
               wanted == 0 ? "told, not judged:"
               : !right    ? "BELOW 95 %"
               : enough    ? ""
                           : "TOO FEW",
               instead);
    return enough && right;
}

}  // namespace
}  // namespace surefoot::bench

int main(int argc, char** argv) {
    using namespace surefoot;
    const int times = argc > 1 ? std::clamp(std::atoi(argv[1]), 1, 600) : 50;
    bench::Stopper stopper;  // forks: before there are threads
    if (rt::probe_capabilities(bench::blocker_priority).fifo_priority < bench::blocker_priority) {
        fmt::print("SCHED_FIFO {} is refused here: a late wake-up and a preemption cannot be made\n", bench::blocker_priority);
        return 77;
    }
    const bench::Folder folder;
    const auto request = bench::forest_walk(folder.path, rt::allowed_cpus().cpus().back());
    if (!request) {
        fmt::print("{}\n", request.error().text());
        return 1;
    }
    walk::prepare_process(*request);
    fmt::print("{:<18}{:>9}{:>8}{:>8}{:>10}\n", "cause", "injected", "missed", "right", "");
    bool all = true;
    for (const rt::Cause cause : bench::live_causes) {
        const auto named = bench::inject(cause, times, *request, stopper);
        if (!named) {
            fmt::print("{}\n", named.error().text());
            return named.error().kind == ErrorKind::no_device ? 77 : 1;
        }
        all = bench::print_row(rt::cause_names[static_cast<std::size_t>(cause)], *named, times) && all;
    }
    if (argc > 2) {
        const auto records = bench::read_stolen_frames(argv[2]);
        if (!records) {
            fmt::print("{}\n", records.error().text());
            return 1;
        }
        all = bench::print_row("stolen (recorded)", bench::classify(*records, true, false), 50) && all;
        // Told, not judged: see clock_stood_still(). Then with the steal of the core beside the clocks.
        (void)bench::print_row("  charged to us", bench::classify(*records, false, false), 0);
        all = bench::print_row("  by core's steal", bench::classify(*records, false, true), 10) && all;
    }
    return all ? 0 : 1;
}
