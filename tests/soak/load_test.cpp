// The processes that load the machine: each kind does what it says and counts it; none outlives the soak, however that ends.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "rt/clock/clock.hpp"
#include "tests/eventually.hpp"
#include "tools/soak/load_runner.hpp"
#include "tools/soak/machine_facts.hpp"

namespace surefoot::soak {
namespace {

using test::eventually;

LoadSettings small_load() {
    LoadSettings s;
    s.cores = 1;
    s.memory_bytes = 16U << 20U;
    s.file_bytes = 8U << 20U;
    s.folder = std::filesystem::temp_directory_path().string();
    s.clock_step_s = 0.05;  // the time of day of the whole machine: no more than a blink
    s.longest_s = 30;
    return s;
}

LoadPlan all_the_time(LoadSet mix) { return {mix, 1000, {{0, 1000, mix}}}; }

/// Descendants of `root` by /proc, and `root` itself.
std::vector<pid_t> family_of(pid_t root) {
    std::vector<pid_t> family = {root};
    for (std::size_t i = 0; i < family.size(); ++i) {
        std::ifstream children("/proc/" + std::to_string(family[i]) + "/task/" + std::to_string(family[i]) + "/children");
        for (pid_t child = 0; children >> child;) family.push_back(child);
    }
    return family;
}

bool alive(pid_t pid) {
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    std::getline(stat, text);
    const std::size_t end = text.rfind(')');
    return end != std::string::npos && end + 2 < text.size() && text[end + 2] != 'Z';
}

class SoakLoadTest : public testing::TestWithParam<LoadKind> {};

TEST_P(SoakLoadTest, IsThereAndCounted) {
    const LoadKind kind = GetParam();
    auto runner = LoadRunner::start(all_the_time(load_bit(kind)), small_load());
    ASSERT_TRUE(runner.ok()) << runner.error().text();
    const LoadCounters& c = runner->board().of(kind);
    EXPECT_FALSE(eventually(0.06, [&] { return c.amount.load() > 0; })) << "it began before it was told to";
    runner->begin(rt::monotonic_ns());
    const bool has_evidence = kind == LoadKind::memory || kind == LoadKind::forks || kind == LoadKind::devices;
    const bool counted = eventually(
        10, [&] { return (c.amount.load() > 0 && (c.evidence.load() > 0 || !has_evidence)) || c.refused.load() != 0; });
    runner->stop();
    if (c.refused.load() != 0) GTEST_SKIP() << "not permitted here: " << std::strerror(c.refused.load());
    EXPECT_TRUE(counted);
    EXPECT_EQ(c.failures.load(), 0U);
    EXPECT_GT(c.on_ns.load(), 0);
    const std::uint64_t after = c.amount.load();
    EXPECT_FALSE(eventually(0.1, [&] { return c.amount.load() != after; })) << "it goes on after it was stopped";
    if (has_evidence) {
        EXPECT_GT(c.evidence.load(), 0U);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SoakLoadTest,
                         testing::Values(LoadKind::cpu, LoadKind::memory, LoadKind::io, LoadKind::forks, LoadKind::devices),
                         [](const auto& kind) { return std::string(load_names[static_cast<std::size_t>(kind.param)]); });

constexpr LoadSet some_loads =
    load_bit(LoadKind::cpu) | load_bit(LoadKind::memory) | load_bit(LoadKind::forks) | load_bit(LoadKind::io);

/// A soak in a process of its own, that tells the runner's number through a pipe and waits to be killed.
pid_t soak_process(pid_t& runner_pid) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t soak = fork();
    if (soak == 0) {
        auto runner = LoadRunner::start(all_the_time(some_loads), small_load());
        if (!runner.ok()) _exit(1);
        runner->begin(rt::monotonic_ns());
        const pid_t pid = runner->pid();
        (void)!write(ends[1], &pid, sizeof pid);
        for (;;) pause();
    }
    EXPECT_EQ(read(ends[0], &runner_pid, sizeof runner_pid), static_cast<ssize_t>(sizeof runner_pid));
    close(ends[0]);
    close(ends[1]);
    return soak;
}

TEST(SoakLoads, ASoakThatIsKilledLeavesNothingBehind) {
    // What loses its parent comes to this process instead of to init, and can be waited for.
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    pid_t runner = -1;
    const pid_t soak = soak_process(runner);
    EXPECT_TRUE(eventually(10, [&] { return family_of(runner).size() >= 5; })) << "the load never came";
    const std::vector<pid_t> family = family_of(runner);
    kill(soak, SIGKILL);
    const bool gone = eventually(10, [&] {
        while (waitpid(-1, nullptr, WNOHANG) > 0) {
        }
        for (const pid_t pid : family)
            if (alive(pid)) return false;
        return true;
    });
    EXPECT_TRUE(gone) << "load goes on for a soak that is dead";
    for (const pid_t pid : family) kill(pid, SIGKILL);
}

TEST(SoakLoads, AnInterruptOfTheTerminalIsTheSoaksToHear) {
    auto runner = LoadRunner::start(all_the_time(some_loads), small_load());
    ASSERT_TRUE(runner.ok());
    runner->begin(rt::monotonic_ns());
    EXPECT_TRUE(eventually(10, [&] { return family_of(runner->pid()).size() >= 5; }));
    for (const pid_t pid : family_of(runner->pid())) kill(pid, SIGINT);
    EXPECT_FALSE(eventually(0.2, [&] { return !alive(runner->pid()); })) << "Ctrl-C ended the load's own parent";
    EXPECT_GE(family_of(runner->pid()).size(), 5U) << "Ctrl-C took the load away before the walk ended";
    const std::vector<pid_t> family = family_of(runner->pid());
    runner->stop();
    for (const pid_t pid : family) EXPECT_FALSE(alive(pid)) << pid;
}

TEST(SoakLoads, EndByThemselvesWhenTheirTimeIsOver) {
    LoadSettings settings = small_load();
    settings.longest_s = 1;
    auto runner = LoadRunner::start(all_the_time(some_loads), settings);
    ASSERT_TRUE(runner.ok());
    runner->begin(rt::monotonic_ns());
    const pid_t pid = runner->pid();
    EXPECT_TRUE(eventually(10, [&] { return !alive(pid); }));
}

TEST(SoakLoads, ClockStepsAreUndoneAlsoWhereTheyAreEnded) {
    if (std::getenv("SUREFOOT_CLOCK_STEPS") == nullptr)
        GTEST_SKIP() << "steps the time of day of this machine by 50 ms: only with SUREFOOT_CLOCK_STEPS set";
    const auto offset_ns = [] {
        timespec day{};
        clock_gettime(CLOCK_REALTIME, &day);
        return static_cast<std::int64_t>(day.tv_sec) * 1'000'000'000 + day.tv_nsec - rt::monotonic_ns();
    };
    const std::int64_t before = offset_ns();
    auto runner = LoadRunner::start(all_the_time(load_bit(LoadKind::clock)), small_load());
    ASSERT_TRUE(runner.ok());
    const LoadCounters& c = runner->board().of(LoadKind::clock);
    runner->begin(rt::monotonic_ns());
    std::int64_t furthest = 0;
    eventually(10, [&] {
        furthest = std::max<std::int64_t>(furthest, std::llabs(offset_ns() - before));
        return c.refused.load() != 0 || c.amount.load() >= 2;
    });
    if (c.refused.load() != 0) GTEST_SKIP() << "not permitted here: " << std::strerror(c.refused.load());
    // Ended in the middle of a step, if it is in one.
    eventually(3, [&] { return std::llabs(offset_ns() - before) > 30'000'000; });
    runner->stop();
    EXPECT_GT(furthest, 30'000'000) << "no step was seen";
    EXPECT_LT(std::llabs(offset_ns() - before), 5'000'000) << "the last step was not undone";
    EXPECT_EQ(c.failures.load(), 0U);
}

TEST(ProcFigure, IsThatOfItsOwnLineOrNothing) {
    const std::string io = "wchar: 7\ncancelled_write_bytes: 4\nwrite_bytes: 8192\n";
    EXPECT_EQ(proc_figure(io, "write_bytes"), 8192U);
    EXPECT_EQ(proc_figure(io, "wchar"), 7U);
    EXPECT_EQ(proc_figure("Cached:    17 kB\n", "Cached"), 17U);
    EXPECT_EQ(proc_figure("intr 1 2\nctxt 5\n", "ctxt"), 5U);
    for (const char* text : {"", "ctxt", "\nctxt ", "ctxts 4\n"}) EXPECT_EQ(proc_figure(text, "ctxt"), 0U) << text;
    EXPECT_EQ(proc_figure_of("/nonexistent", "ctxt"), 0U);
    EXPECT_GT(proc_figure_of("/proc/stat", "processes"), 0U);
}

}  // namespace
}  // namespace surefoot::soak
