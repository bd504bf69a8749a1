// The runaway guard, on a process of its own: limits and signals are the whole process's.
#include <gtest/gtest.h>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "rt/clock/clock.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/runaway.hpp"
#include "tests/eventually.hpp"

namespace surefoot::rt {
namespace {

/// 0: demoted and named within a second; else what went wrong.
int let_one_run_away() {
    if (!guard_runaways(500'000)) return 1;
    const RealClock clock;
    const std::int64_t begun = clock.now_ns();  // before the hog, which may keep this thread from its core
    std::thread hog([] {
        if (!place_thread(0, {.policy = Policy::fifo, .priority = 50, .cpus = {}, .name = "hog"})) _exit(2);
        for (std::atomic<unsigned> forever{0};;) ++forever;
    });
    hog.detach();
    if (!surefoot::test::eventually(5, [] { return runaway_seen().has_value(); })) return 3;
    const auto seen = runaway_seen();
    if (seen->name != "hog" || !seen->demoted) return 4;
    const auto now = read_thread(seen->tid);
    if (!now || now->policy != Policy::other) return 5;
    // The limit counts its CPU time; where the machine gives it none, that takes longer.
    return clock.now_ns() - begun < 400'000'000 ? 6 : 0;
}

TEST(Runaway, LosesItsPriorityAndIsNamed) {
    if (!guard_active()) GTEST_SKIP() << "sanitizers make a forked child's signals unreliable";
    if (probe_capabilities(50).fifo_priority < 50) GTEST_SKIP() << "SCHED_FIFO is refused here: nothing can run away";
    const pid_t child = fork();
    if (child == 0) _exit(let_one_run_away());
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(Runaway, TheLimitIsAboveAFrameAndBelowASecond) {
    EXPECT_EQ(runaway_limit_us(16'666'667), 500'000);
    EXPECT_EQ(runaway_limit_us(333'333'333), 666'666);
    EXPECT_EQ(runaway_limit_us(1'000'000'000), 900'000);
}

}  // namespace
}  // namespace surefoot::rt
