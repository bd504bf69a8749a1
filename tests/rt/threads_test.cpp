// Placing, census, guard, exchange: what a session relies on, on real threads.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <latch>
#include <thread>

#include "rt/exchange/spsc_ring.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/threads/census.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/placement.hpp"
#include "rt/threads/usage.hpp"
#include "tests/rt/syscall_trap.hpp"

namespace surefoot::rt {
namespace {

Placement fifo(const char* name, int priority, CpuMask cpus) {
    Placement p;
    p.policy = Policy::fifo;
    p.priority = priority;
    p.cpus = cpus;
    p.name = name;
    return p;
}

/// Runs `body` on a thread of its own, so that nothing placed outlives the test.
template <class Body>
void on_own_thread(Body body) {
    std::thread(body).join();
}

std::vector<std::string> census_of_helpers(bool place_first, bool& refused) {
    std::vector<std::string> problems;
    on_own_thread([&] {
        const int core = allowed_cpus().cpus().back();
        const auto place = [&] {
            Placement p = fifo("sf-t-frame", 40, CpuMask{core});
            p.reset_on_fork = false;  // as a naive program would
            refused = !place_thread(0, p).ok();
        };
        if (place_first) place();
        std::atomic<bool> stop{false}, named{false};
        std::thread helper([&] {
            Placement p;
            p.name = "sf-t-work";
            // Only the name: policy and cores stay as they were inherited.
            auto now = read_thread(own_tid());
            p.policy = now->policy;
            p.priority = now->priority;
            p.reset_on_fork = false;
            (void)place_thread(0, p);
            named = true;
            named.notify_one();
            stop.wait(false);
        });
        named.wait(false);
        if (!place_first) place();
        auto threads = read_threads();
        std::erase_if(*threads, [](const ThreadInfo& t) { return !t.name.starts_with("sf-t-"); });
        std::vector<DeclaredThread> table(2);
        table[0].name = "sf-t-frame";
        table[0].policy = Policy::fifo;
        table[0].priority = 40;
        table[0].cpus = CpuMask{core};
        table[1].name = "sf-t-work";
        table[1].cpus = allowed_cpus();
        problems = census(table, *threads);
        stop = true;
        stop.notify_one();
        helper.join();
    });
    return problems;
}

TEST(Census, TheNaiveOrderOfCreationFailsAndTheNeutralOnePasses) {
    bool refused = false;
    const std::vector<std::string> neutral = census_of_helpers(false, refused);
    if (refused) GTEST_SKIP() << "SCHED_FIFO is refused here: run as root or with RLIMIT_RTPRIO";
    EXPECT_TRUE(neutral.empty()) << neutral.front();
    const std::vector<std::string> naive = census_of_helpers(true, refused);
    EXPECT_FALSE(naive.empty()) << "a helper made by a FIFO, pinned thread inherits both";
}

TEST(Census, NamesMissingUndeclaredAndWronglyPlacedThreads) {
    std::vector<DeclaredThread> table(1);
    table[0].name = "sf-frame";
    table[0].policy = Policy::fifo;
    table[0].priority = 80;
    ThreadInfo right;
    right.name = "sf-frame";
    right.policy = Policy::fifo;
    right.priority = 80;
    EXPECT_TRUE(census(table, std::vector{right}).empty());
    EXPECT_EQ(census(table, {}).size(), 1U);
    ThreadInfo stranger;
    stranger.name = "stranger";
    EXPECT_EQ(census(table, std::vector{right, stranger}).size(), 1U);
    right.priority = 79;
    EXPECT_EQ(census(table, std::vector{right}).size(), 1U);
}

TEST(Census, RowsCountThreadsThatAreAlike) {
    std::vector<DeclaredThread> table(2);
    table[0].name = "sf-frame";
    table[1].name = "llvmpipe-";
    ThreadInfo frame, first, second, other;
    frame.name = "sf-frame";
    first.name = "llvmpipe-0";
    second.name = "llvmpipe-1";
    first.policy = second.policy = Policy::fifo;
    first.priority = second.priority = 70;
    other.name = "stranger";
    const auto rows = census_rows(table, std::vector{other, first, frame, second});
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[0].name, "sf-frame");
    EXPECT_EQ(rows[1].name, "llvmpipe-");
    EXPECT_EQ(rows[1].count, 2U);
    EXPECT_EQ(rows[1].priority, 70);
    EXPECT_EQ(rows[2].name, "stranger");
}

TEST(Guard, OwnScopeCountsAllocationsAndDriverScopeCountsApart) {
    if (!guard_active()) GTEST_SKIP() << "a sanitizer owns the allocator";
    const GuardCounters before = guard_counters();
    {
        const OwnScope own;
        void* volatile block = std::malloc(64);
        std::free(block);
        {
            const DriverScope driver;
            void* volatile other = std::malloc(64);
            std::free(other);
        }
    }
    void* volatile outside = std::malloc(64);
    std::free(outside);
    const GuardCounters after = guard_counters();
    EXPECT_EQ(after.own_violations - before.own_violations, 2U);
    EXPECT_EQ(after.driver_allocations - before.driver_allocations, 1U);
    EXPECT_EQ(after.driver_frees - before.driver_frees, 1U);
}

TEST(SystemCallTrap, NamesWhatTheFrameThreadsOwnCodeMayNotCall) {
    TrapCounters counters;
    bool refused = false;
    on_own_thread([&] {
        refused = !trap_system_calls(frame_thread_system_calls()).ok();
        if (refused) return;
        {
            const OwnScope own;
            (void)own_cpu_ns();          // allowed
            (void)syscall(SYS_getppid);  // not
        }
        (void)syscall(SYS_getppid);  // outside: counted apart
        counters = trap_counters();
    });
    if (refused) GTEST_SKIP() << "seccomp filters are refused here";
    EXPECT_EQ(counters.own, 1U);
    EXPECT_EQ(counters.last_own, SYS_getppid);
    EXPECT_GE(counters.other, 1U);
    EXPECT_EQ(system_call_name(SYS_mmap), "mmap");
}

TEST(Usage, ThreadsAreMeasuredApart) {
    pid_t tid = 0;
    std::latch known(1), work(1), worked(1), looked(1);
    std::thread busy([&] {
        tid = own_tid();
        known.count_down();
        work.wait();
        volatile double x = 1;
        for (const std::int64_t from = own_cpu_ns(); own_cpu_ns() - from < 5'000'000;) x = x * 1.0000001;
        worked.count_down();
        looked.wait();  // its clock is there as long as it is
    });
    known.wait();
    const std::int64_t before = thread_cpu_ns(tid), own_before = own_cpu_ns();
    work.count_down();
    worked.wait();
    const std::int64_t after = thread_cpu_ns(tid), own_after = own_cpu_ns();
    looked.count_down();
    busy.join();
    EXPECT_GE(after - before, 5'000'000);
    EXPECT_LT(own_after - own_before, after - before) << "waiting is no work";
    EXPECT_LT(own_cpu_ns(), 60'000'000'000);
}

TEST(TripleBuffer, TheReaderSeesWholeValuesNeverOlderOnes) {
    struct Value {
        std::uint64_t a = 0, b = 0;
    };
    TripleBuffer<Value> buffer;
    std::atomic<bool> done{false};
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= 200000; ++i) {
            buffer.back() = {i, ~i};
            buffer.publish();
        }
        done = true;
    });
    std::uint64_t last = 0;
    while (!done || buffer.refresh()) {
        buffer.refresh();
        const Value v = buffer.front();
        if (v.a == 0) continue;
        ASSERT_EQ(v.b, ~v.a);
        ASSERT_GE(v.a, last);
        last = v.a;
    }
    writer.join();
    EXPECT_EQ(last, 200000U);
}

TEST(SpscRing, NothingIsLostButWhatIsCounted) {
    SpscRing<std::uint64_t> ring(64);
    constexpr std::uint64_t total = 200000;
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < total; ++i) ring.try_push(i);
    });
    std::uint64_t got = 0, value = 0, last = 0;
    while (got + ring.dropped() < total) {
        if (!ring.try_pop(value)) continue;
        ASSERT_TRUE(got == 0 || value > last);
        last = value;
        ++got;
    }
    producer.join();
    while (ring.try_pop(value)) ++got;
    EXPECT_EQ(got + ring.dropped(), total);
}

}  // namespace
}  // namespace surefoot::rt
