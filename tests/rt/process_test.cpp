// Proofs that need a process of their own: oneTBB's order of creation, a stopped process, the loop under the system-call trap.
#include <gtest/gtest.h>
#include <signal.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iterator>
#include <optional>
#include <thread>

#include "rt/base/mutex.hpp"
#include "rt/clock/clock.hpp"
#include "rt/frame/loop.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/census.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/placement.hpp"
#include "tests/rt/idle_stages.hpp"
#include "tests/rt/in_child.hpp"
#include "tests/rt/syscall_trap.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

using test::failed;
using test::in_child;
using test::passed;

constexpr auto start_within = std::chrono::seconds(5);

/// Names and places each worker as it starts.
class Placing final : public tbb::task_scheduler_observer {
public:
    explicit Placing(tbb::task_arena& arena) : task_scheduler_observer(arena) { observe(true); }
    ~Placing() override { observe(false); }
    Placing(const Placing&) = delete;
    Placing& operator=(const Placing&) = delete;
    void on_scheduler_entry(bool is_worker) override {
        if (is_worker)
            (void)place_thread(0, {.policy = Policy::fifo, .priority = 30, .cpus = allowed_cpus(), .name = "sf-worker"});
    }
};

/// Makes oneTBB start its workers: three tasks that all wait until three threads have met (or none more comes).
int start_workers(bool placed) {
    std::array<pid_t, 3> tids{};
    int arrived = 0;
    Mutex mutex;
    Condition changed;
    const auto deadline = std::chrono::steady_clock::now() + start_within;
    tbb::task_arena arena(3);
    arena.initialize();
    std::optional<Placing> placing;
    if (placed) placing.emplace(arena);
    arena.execute([&] {
        tbb::parallel_for(
            0, 3,
            [&](int i) {
                const MutexLock lock(mutex);
                tids[static_cast<std::size_t>(i)] = own_tid();
                ++arrived;
                changed.notify_all();
                while (arrived < 3 && changed.wait_until(mutex, deadline)) {
                }
            },
            tbb::simple_partitioner{});
    });
    return static_cast<int>(std::count_if(std::begin(tids), std::end(tids), [](pid_t t) { return t != own_tid(); }));
}

/// Who makes the workers, and whether they are placed as they start.
enum class Made { by_the_frame_thread, by_the_main_thread, by_the_main_thread_and_placed };

/// A frame thread and oneTBB's workers; what the census says.
std::vector<std::string> census_with_workers(Made made) {
    const tbb::global_control three(tbb::global_control::max_allowed_parallelism, 3);
    const int core = allowed_cpus().cpus().back();
    const std::string program = read_thread(0).value().name;
    const bool naive = made == Made::by_the_frame_thread;
    int workers = 0;
    std::vector<std::string> problems;
    if (!naive) workers = start_workers(made == Made::by_the_main_thread_and_placed);
    std::thread([&] {
        // As a program would that does not know: without the flag that resets what children inherit.
        (void)place_thread(
            0, {.policy = Policy::fifo, .priority = 40, .cpus = CpuMask{core}, .name = "sf-frame", .reset_on_fork = false});
        if (naive) workers = start_workers(false);
        const std::vector<DeclaredThread> table = {
            {.name = program, .policy = Policy::other, .priority = 0, .cpus = allowed_cpus()},
            {.name = "sf-frame", .whole_name = true, .policy = Policy::fifo, .priority = 40, .cpus = CpuMask{core}},
            {.name = "sf-worker",
             .policy = Policy::fifo,
             .priority = 30,
             .cpus = allowed_cpus(),
             .min_count = 2,
             .max_count = 2}};
        problems = census(table, read_threads().value());
    }).join();
    if (workers != 2) problems.emplace_back("oneTBB did not start two workers");
    return problems;
}

bool has(const std::vector<std::string>& problems, const std::string& words) {
    return std::any_of(problems.begin(), problems.end(),
                       [&](const std::string& p) { return p.find(words) != std::string::npos; });
}

TEST(CensusWithTbb, OnlyWorkersThatArePlacedAsTheyStartPass) {
    if (probe_capabilities(40).fifo_priority < 40)
        GTEST_SKIP() << "SCHED_FIFO is refused here: run as root or with RLIMIT_RTPRIO";
    if (!guard_active()) GTEST_SKIP() << "sanitizers do not follow a fork into threads";
    EXPECT_EQ(in_child([] {
                  const auto problems = census_with_workers(Made::by_the_main_thread_and_placed);
                  for (const std::string& p : problems) std::fprintf(stderr, "placed: %s\n", p.c_str());
                  return problems.empty() ? passed : failed;
              }),
              passed);
    EXPECT_EQ(in_child([] {
                  // The workers carry the program's name and are SCHED_OTHER.
                  const auto problems = census_with_workers(Made::by_the_main_thread);
                  return has(problems, "is there too often") && has(problems, "'sf-worker' is missing") ? passed : failed;
              }),
              passed);
    EXPECT_EQ(in_child([] {
                  // The workers carry the frame thread's name and priority.
                  return has(census_with_workers(Made::by_the_frame_thread), "'sf-frame' is there too often") ? passed : failed;
              }),
              passed);
}

TEST(Stopped, AProcessStoppedForThreeTenthsOfASecondCountsItsSlotsAndNamesTheCause) {
    if (!guard_active()) GTEST_SKIP() << "sanitizers make a forked child's signals unreliable";
    test::StartSignal under_way;
    const auto body = [&] {
        RealClock clock;
        test::SignallingStages stages(under_way);
        SpscRing<FrameRecord> ring(128);
        FrameLoopOptions options;
        options.frames = 30;
        options.continued = count_continues();
        const FrameLoopResult result = run_frame_loop(options, clock, stages, ring);
        std::uint64_t slot = 0, stopped = 0;
        FrameRecord r;
        while (ring.try_pop(r)) {
            if (r.woken_ns < r.due_ns || (r.frame > 0 && r.slot != slot + 1 + r.skipped_before)) return failed;
            slot = r.slot;
            if (r.cause == Cause::stopped && !r.own_miss) ++stopped;
        }
        // 300 ms are 18 periods: at least 17 whole ones lie within, one of them the stopped frame's own.
        return result.run + result.skipped == result.elapsed && result.skipped >= 16 && stopped == 1 ? passed : failed;
    };
    EXPECT_EQ(in_child(body,
                       [&](pid_t child) {
                           under_way.wait();
                           ::kill(child, SIGSTOP);
                           std::this_thread::sleep_for(std::chrono::milliseconds(300));  // how long it is stopped
                           ::kill(child, SIGCONT);
                       }),
              passed);
}

/// Idle, but one frame makes a system call in own code and another in the driver's tier.
class Calling final : public test::IdleStages {
public:
    void select(FrameRecord& r) override {
        if (r.frame == forbidden_at) (void)::getppid();
    }
    void finish(FrameRecord& r) override {
        if (r.frame == 5) (void)::getppid();
    }
    std::uint64_t forbidden_at = 1000;
};

TEST(SystemCallTrap, TheLoopItselfMakesNoCallBeyondItsList) {
    for (const auto& [forbidden, shows] : {std::pair{false, false}, {true, false}, {false, true}}) {
        TrapCounters before, after;
        bool refused = false;
        std::thread([&, calls = forbidden, presents = shows] {
            RealClock clock;
            Calling stages;
            if (calls) stages.forbidden_at = 7;
            SpscRing<FrameRecord> ring(64);
            FrameLoopOptions options;
            options.period_ns = 2 * ms;
            options.frames = 20;
            options.shows = presents;
            options.continued = count_continues();
            const pid_t self[] = {own_tid()};
            options.rasterisers = self;
            refused = !trap_system_calls(frame_thread_system_calls()).ok();
            if (refused) return;
            before = trap_counters();
            run_frame_loop(options, clock, stages, ring);
            after = trap_counters();
        }).join();
        if (refused) GTEST_SKIP() << "seccomp filters are refused here, or this is a sanitizer build";
        EXPECT_EQ(after.own - before.own, forbidden ? 1U : 0U) << system_call_name(after.last_own);
        EXPECT_EQ(after.other - before.other, 1U);
        if (forbidden) {
            EXPECT_EQ(system_call_name(after.last_own), "getppid");
        }
    }
}

}  // namespace
}  // namespace surefoot::rt
