// What is read from and asked of the machine: clocks, placing, memory, limits, steal. Skipped where it is refused.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/monitor/recorder.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "rt/threads/placement.hpp"
#include "rt/threads/usage.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/time_units.hpp"

namespace surefoot::rt {
namespace {

/// A folder that stands for / with a few files in it.
struct FakeRoot : test::TemporaryFolder {
    void file(const std::string& name, const std::string& text) const {
        const std::filesystem::path whole = path() + name;
        std::filesystem::create_directories(whole.parent_path());
        std::ofstream(whole) << text;
    }
};

TEST(RealClock, NeverWakesEarlyThoughSignalsRainOnIt) {
    struct sigaction action {
    }, before{};
    action.sa_handler = [](int) {};
    sigaction(SIGALRM, &action, &before);
    const itimerval rain{{0, 1000}, {0, 1000}}, dry{};
    setitimer(ITIMER_REAL, &rain, nullptr);
    RealClock clock;
    for (int i = 0; i < 3; ++i) {
        const std::int64_t until = clock.now_ns() + 10 * ms;
        clock.sleep_until_ns(until);
        EXPECT_GE(clock.now_ns(), until);
    }
    setitimer(ITIMER_REAL, &dry, nullptr);
    sigaction(SIGALRM, &before, nullptr);
}

TEST(RealClock, BurnsCpuTimeNotWallTime) {
    RealClock clock;
    const ThreadUsage before = clock.usage();
    clock.burn_ns(2 * ms);
    EXPECT_GE((clock.usage() - before).cpu_ns, 2 * ms);
}

TEST(Grid, FractionalRatesAndNonsense) {
    EXPECT_EQ(period_of_rate_ns(60).value(), 16'666'667);
    EXPECT_EQ(period_of_rate_ns(59.94).value(), 16'683'350);
    for (const double bad : {0.0, -60.0, 1e9, std::nan("")}) EXPECT_FALSE(period_of_rate_ns(bad)) << bad;
}

/// The slots that frames of equal work run in.
std::vector<std::uint64_t> slots_of(LatePolicy late, std::int64_t work_ns, int frames) {
    const Grid grid{0, 10 * ms};
    std::vector<std::uint64_t> slots;
    NextSlot next;
    for (int i = 0; i < frames; ++i) {
        slots.push_back(next.slot);
        next = next_slot(grid, late, next.slot, next.start_ns + work_ns);
    }
    return slots;
}

TEST(Grid, TheExactSlotsOfEachPolicyForHalfOneAndTwoPeriodsOfWork) {
    using Slots = std::vector<std::uint64_t>;
    EXPECT_EQ(slots_of(LatePolicy::lock, 5 * ms, 4), (Slots{0, 1, 2, 3}));
    EXPECT_EQ(slots_of(LatePolicy::lock, 12 * ms, 4), (Slots{0, 2, 4, 6}));
    EXPECT_EQ(slots_of(LatePolicy::lock, 23 * ms, 4), (Slots{0, 3, 6, 9}));
    EXPECT_EQ(slots_of(LatePolicy::floating, 5 * ms, 4), (Slots{0, 1, 2, 3}));
    EXPECT_EQ(slots_of(LatePolicy::floating, 12 * ms, 7), (Slots{0, 1, 2, 3, 4, 6, 7}));
    EXPECT_EQ(slots_of(LatePolicy::floating, 23 * ms, 5), (Slots{0, 2, 4, 6, 9}));
}

TEST(CpuMask, ReadsAndWritesTheKernelsLists) {
    for (const char* text : {"", "0", "0-2,5", "1,3,5-7,63-65"}) EXPECT_EQ(CpuMask::parse(text).value().text(), text);
    EXPECT_EQ(CpuMask::parse("0-1\n").value().count(), 2);
    for (const char* bad : {"a", "3-1", "1,,2", "-1", "0-99999", "1-"}) EXPECT_FALSE(CpuMask::parse(bad)) << bad;
}

TEST(Placement, AnotherThreadIsPlacedNamedAndPutBack) {
    std::atomic<pid_t> tid{0};
    std::atomic<bool> stop{false};
    std::thread other([&] {
        tid = own_tid();
        tid.notify_one();
        stop.wait(false);
    });
    tid.wait(0);
    const ThreadInfo before = read_thread(tid).value();
    const int core = allowed_cpus().cpus().front();
    const auto placed =
        place_thread(tid, {.policy = Policy::batch, .priority = 0, .cpus = CpuMask{core}, .name = "a name that is too long"});
    EXPECT_TRUE(placed.ok());
    const ThreadInfo now = read_thread(tid).value();
    EXPECT_EQ(now.name, "a name that is ");
    EXPECT_EQ(now.policy, Policy::batch);
    EXPECT_EQ(now.cpus, CpuMask{core});
    EXPECT_TRUE(restore_thread(before).ok());
    const ThreadInfo after = read_thread(tid).value();
    EXPECT_EQ(after.name, before.name);
    EXPECT_EQ(after.policy, before.policy);
    EXPECT_EQ(after.cpus, before.cpus);
    stop = true;
    stop.notify_one();
    other.join();
    EXPECT_FALSE(place_thread(1 << 22, {}).ok()) << "there is no such thread";
}

TEST(Placement, WhatDoesNotExistIsRefusedByName) {
    EXPECT_FALSE(place_thread(0, {.policy = Policy::fifo, .priority = 0, .cpus = {}, .name = {}}));
    EXPECT_FALSE(place_thread(0, {.policy = Policy::other, .priority = 5, .cpus = {}, .name = {}}));
    EXPECT_FALSE(place_thread(0, {.policy = Policy::deadline, .priority = 0, .cpus = {}, .name = {}}));
    const auto refused = place_thread(0, {.policy = Policy::other, .priority = 0, .cpus = CpuMask{1023}, .name = {}});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().text().find("cores 1023"), std::string::npos) << refused.error().text();
    EXPECT_FALSE(refused.error().remedy.empty());
}

TEST(Capability, NamesWhatIsMissingAndHowToGrantIt) {
    Capabilities c;
    c.fifo_priority = 80;
    c.can_lock = true;
    c.allowed = CpuMask{0, 1};
    c.isolated = CpuMask{1};
    c.rt_runtime_us = 950000;
    EXPECT_TRUE(find_lacking(c, 80).empty());
    Capabilities poor = c;
    poor.fifo_priority = 0;
    poor.can_lock = false;
    poor.isolated = {};
    poor.rt_runtime_us = 500000;
    EXPECT_EQ(find_lacking(poor, 80).size(), 4U);
    for (const Lack& lack : find_lacking(poor, 80)) EXPECT_FALSE(lack.remedy.empty()) << lack.what;
    EXPECT_EQ((Lack{LackKind::fifo, "SCHED_FIFO is refused", "Run it as root"}).text(), "SCHED_FIFO is refused. Run it as root.");
    EXPECT_EQ((Lack{LackKind::census, "A thread is missing", ""}).text(), "A thread is missing.");
    c.fifo_priority = 20;
    EXPECT_EQ(find_lacking(c, 80).size(), 1U);
    c.rt_runtime_us = -1;
    EXPECT_EQ(find_lacking(c, 20).size(), 0U) << "no throttling at all is not a lack";
}

TEST(Capability, AnIsolatedCoreOutsideOfTheMaskIsTakenWhereItIsGranted) {
    // As after boot with isolcpus=: the last core is isolated, and taken from this process's mask.
    const std::vector<int> all = allowed_cpus().cpus();
    if (all.size() < 2) GTEST_SKIP() << "one core";
    const PlacementScope scope;
    CpuMask rest;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) rest.add(all[i]);
    ASSERT_TRUE(place_thread(0, {.policy = Policy::other, .priority = 0, .cpus = rest, .name = {}}).ok());
    const FakeRoot root;
    root.file("/sys/devices/system/cpu/isolated", std::to_string(all.back()) + ",1000\n");
    EXPECT_EQ(isolated_cpus(rest, root.path()), CpuMask{all.back()}) << "1000 is not there";
}

TEST(Capability, ReadsTheSystemsFilesAndKeepsToAllowedCores) {
    const FakeRoot root;
    const int core = allowed_cpus().cpus().front();
    root.file("/sys/devices/system/cpu/isolated", std::to_string(core) + ",1000-1001\n");
    root.file("/proc/sys/kernel/sched_rt_runtime_us", "100000\n");
    root.file("/proc/cpuinfo", "flags\t\t: fpu hypervisor sse\n");
    const Capabilities c = probe_capabilities(1, root.path());
    EXPECT_EQ(c.isolated, CpuMask{core});
    EXPECT_EQ(c.rt_runtime_us, 100000);
    EXPECT_TRUE(c.virtual_machine);
    const Capabilities blind = probe_capabilities(1, root.path() + "/nowhere");
    EXPECT_TRUE(blind.isolated.empty());
    EXPECT_EQ(blind.rt_runtime_us, -1);
}

TEST(Capability, TryingLeavesTheCallerWhereItWas) {
    const ThreadInfo before = read_thread(0).value();
    const Capabilities c = probe_capabilities(50);
    EXPECT_EQ(read_thread(0).value().policy, before.policy);
    EXPECT_TRUE(c.fifo_priority == 50 || !c.lacking.empty());
}

TEST(Limits, AreRaisedNoFurtherThanAllowedAndPutBack) {
    rlimit before{}, raised{}, after{};
    getrlimit(RLIMIT_RTPRIO, &before);
    const SavedLimits saved = raise_limits(80);
    getrlimit(RLIMIT_RTPRIO, &raised);
    EXPECT_GE(raised.rlim_cur, before.rlim_cur);
    restore_limits(saved);
    getrlimit(RLIMIT_RTPRIO, &after);
    EXPECT_EQ(after.rlim_cur, before.rlim_cur);
}

TEST(Memory, IsLockedAndReleased) {
    if (!guard_active()) GTEST_SKIP() << "a sanitizer's shadow memory is too large to lock";
    prefault_stack();
    const auto locked = prepare_memory({.heap_bytes = 4U << 20U, .growth_bytes = 64U << 20U});
    const std::uint64_t bytes = locked_bytes();
    release_memory();
    if (!locked) GTEST_SKIP() << locked.error().text();
    EXPECT_GT(bytes, 4U << 20U);
    EXPECT_EQ(locked_bytes(), 0U);
}

/// Page faults of the calling thread while it takes 4 MiB in blocks, writes to them and gives them back.
std::uint64_t faults_of_four_mib() {
    constexpr std::size_t block = 48U << 10U;
    std::vector<std::unique_ptr<char[]>> blocks((4U << 20U) / block);
    const ThreadUsage before = read_own_usage();
    for (auto& memory : blocks) {
        memory = std::make_unique<char[]>(block);  // zeroed, and so touched
        *const_cast<volatile char*>(memory.get()) = 1;
    }
    return (read_own_usage() - before).minor_faults;
}

TEST(Memory, AThreadsOwnHeapIsGrownBeforehand) {
    if (!guard_active()) GTEST_SKIP() << "the sanitizers have an allocator of their own";
    ASSERT_EQ(prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0), 0);  // a huge page would be one fault for 512
    (void)prepare_memory({.lock = false, .heap_bytes = 0});
    // Two at once, so that each has a heap of its own; the one that is given nothing shows that there is something to fault.
    std::uint64_t grown = 0, bare = 0;
    std::atomic<int> ready = 0;
    const auto together = [&] {
        for (++ready; ready < 2;) std::this_thread::yield();
    };
    std::thread with([&] {
        prefault_heap(8U << 20U);
        together();
        grown = faults_of_four_mib();
    });
    std::thread without([&] {
        (void)std::make_unique<char[]>(1000);
        together();
        bare = faults_of_four_mib();
    });
    with.join();
    without.join();
    release_memory();
    (void)prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
    EXPECT_LE(grown, 8U);
    EXPECT_GE(bare, 512U) << "the other's would prove nothing";
}

TEST(Memory, AFiniteLimitThatLeavesNoRoomToGrowIsRefusedWithTheRemedy) {
    if (lock_unlimited()) GTEST_SKIP() << "this user may lock everything";
    const auto locked = prepare_memory({.heap_bytes = 0, .growth_bytes = 1ULL << 50U});
    release_memory();
    ASSERT_FALSE(locked);
    EXPECT_NE(locked.error().remedy.find("MEMLOCK"), std::string::npos);
}

TEST(Usage, AFreshPageIsCountedAsAFault) {
    const ThreadUsage before = read_own_usage();
    constexpr std::size_t bytes = 64U << 10U;
    auto* const memory =
        static_cast<volatile char*>(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    ASSERT_NE(static_cast<volatile void*>(memory), MAP_FAILED);
    for (std::size_t at = 0; at < bytes; at += 4096) memory[at] = 1;
    const ThreadUsage used = read_own_usage() - before;
    munmap(const_cast<char*>(memory), bytes);
    EXPECT_GE(used.minor_faults, 1U);
    EXPECT_GT(used.cpu_ns, 0);
}

TEST(Usage, AThreadThatIsNotThereHasNoClock) {
    EXPECT_EQ(thread_cpu_ns(1 << 22), -1);
    const pid_t gone[] = {1 << 22};
    const ThreadClocks clocks(gone);
    EXPECT_EQ(clocks.spent().sum_ns, 0);
}

TEST(Steal, ReadsTicksOfEachCoreAndSurvivesShortLines) {
    const FakeRoot root;
    root.file("/proc/stat",
              "cpu  1 2 3 4 5 6 7 30 0 0\ncpu0 1 2 3 4 5 6 7 10 0 0\ncpu3 1 2 3 4 5 6 7 20 0 0\ncpu4 1 2\nintr 5\n");
    const auto steal = read_steal(root.path());
    ASSERT_TRUE(steal.ok());
    const double tick_ms = 1000.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
    EXPECT_DOUBLE_EQ(steal->total_ms, 30 * tick_ms);
    ASSERT_EQ(steal->cpu_ms.size(), 5U);
    EXPECT_DOUBLE_EQ(steal->cpu_ms[0], 10 * tick_ms);
    EXPECT_DOUBLE_EQ(steal->cpu_ms[1], 0);
    EXPECT_DOUBLE_EQ(steal->cpu_ms[3], 20 * tick_ms);
    EXPECT_DOUBLE_EQ(steal->cpu_ms[4], 0);
    root.file("/proc/stat", "nothing\n");
    EXPECT_FALSE(read_steal(root.path()));
    EXPECT_FALSE(read_steal(root.path() + "/nowhere"));
}

TEST(Recorder, KeepsEveryRecordInOrderOnAThreadOfItsOwnName) {
    SpscRing<FrameRecord> ring(64);
    std::uint64_t seen = 0;
    RecorderOptions options;
    options.reserve_records = 10;
    options.poll_ns = ms / 10;
    std::string name;  // the monitor thread's until it is stopped
    options.on_record = [&](const FrameRecord&) {
        if (seen++ == 0) name = read_thread(0).value().name;
    };
    Recorder recorder(ring, options);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        FrameRecord r;
        r.frame = i;
        while (ring.full()) std::this_thread::yield();
        ring.try_push(r);
    }
    recorder.stop();
    EXPECT_EQ(name, "sf-monitor");
    EXPECT_EQ(ring.dropped(), 0U);
    EXPECT_EQ(seen, 2000U);
    ASSERT_EQ(recorder.records().size(), 2000U);
    for (std::uint64_t i = 0; i < 2000; ++i) ASSERT_EQ(recorder.records()[i].frame, i);
}

TEST(Recorder, HandsTheFirstRecordOverSoonHoweverSeldomItLooksLater) {
    SpscRing<FrameRecord> ring(64);
    std::promise<void> came;
    RecorderOptions options;
    options.poll_ns = 3600 * 1000 * ms;
    options.on_record = [&](const FrameRecord&) { came.set_value(); };
    Recorder recorder(ring, options);
    ring.try_push(FrameRecord{});
    EXPECT_EQ(came.get_future().wait_for(std::chrono::seconds(20)), std::future_status::ready);
    recorder.stop();
}

TEST(FrameCore, IsTheLastIsolatedOneElseTheLastThatIsAllowed) {
    EXPECT_EQ(default_frame_core({0, 1, 2, 3}, {1, 2}), 2);
    EXPECT_EQ(default_frame_core({0, 1}, {2, 3}), 3) << "isolcpus= takes its cores from everybody's mask";
    EXPECT_EQ(default_frame_core({0, 1, 2}, {1, 3}), 3);
    EXPECT_EQ(default_frame_core({0, 4}, {}), 4);
    EXPECT_EQ(default_frame_core({}, {}), -1);
}

}  // namespace
}  // namespace surefoot::rt
