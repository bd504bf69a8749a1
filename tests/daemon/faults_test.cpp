// Faults while it runs: a frame thread that hangs, one that never sleeps, a graphics context that is lost.
#include <gtest/gtest.h>

#include <sys/ptrace.h>

#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "systemd/daemon/exit_code.hpp"
#include "tests/daemon/running.hpp"

namespace surefoot::daemon::test {
namespace {

TEST(Faults, TheWatchdogStarvesWhileTheFrameThreadAloneIsFrozen) {
    Running daemon("freeze");
    daemon.rate_hz = 10;  // a frame that other programs delay by some ms is not late
    daemon.write_config();
    daemon.environment = {{"WATCHDOG_USEC", "800000"}};  // a ping every 0.2 s
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    for (int ping = 0; ping < 3; ++ping)
        ASSERT_TRUE(daemon.socket.wait_for("WATCHDOG=1", 5)) << "not fed: " << daemon.socket.text();

    const int missed_before = daemon.lines_with("missed");  // frames that this machine delayed
    // A tracer stops one thread; a signal would stop them all.
    const pid_t frame = daemon.thread("sf-frame");
    ASSERT_NE(frame, 0);
    if (::ptrace(PTRACE_SEIZE, frame, nullptr, nullptr) != 0) GTEST_SKIP() << "ptrace is refused here: " << std::strerror(errno);
    ASSERT_EQ(::ptrace(PTRACE_INTERRUPT, frame, nullptr, nullptr), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(frame, &status, __WALL), frame);
    ASSERT_TRUE(WIFSTOPPED(status));
    daemon.socket.take_all();
    const std::size_t frozen_from = daemon.socket.all.size();
    ASSERT_TRUE(daemon.socket.wait_for("STATUS=NO FRAMES COME", 10)) << daemon.socket.text();  // a second after the last one
    EXPECT_LE(daemon.socket.count("WATCHDOG=1", frozen_from), 1U) << "but for what was on its way: " << daemon.socket.text();
    const std::size_t stalled_from = daemon.socket.all.size();
    daemon.socket.listen(1.0);  // longer than systemd waits
    EXPECT_EQ(daemon.socket.count("WATCHDOG=1", stalled_from), 0U) << daemon.socket.text();
    EXPECT_EQ(daemon.socket.count("STATUS=NO FRAMES COME"), 1U) << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with("No frame was presented for"), 1) << daemon.log_text();

    ASSERT_EQ(::ptrace(PTRACE_DETACH, frame, nullptr, nullptr), 0);
    EXPECT_TRUE(daemon.socket.wait_for("WATCHDOG=1", 5)) << "recovery does not resume the pings: " << daemon.socket.text();
    EXPECT_TRUE(daemon.socket.wait_for("STATUS=walking", 5)) << "the status still says that none come: " << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with("Frames are presented again."), 1) << daemon.log_text();
    EXPECT_TRUE(daemon.wait_line("missed", missed_before, 20)) << "a burst is told once it is over: " << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("missed") - missed_before, 1) << "one line for the whole burst: " << daemon.log_text();
    ::kill(daemon.pid, SIGTERM);
    EXPECT_EQ(daemon.wait_exit(20), exit_success);
    EXPECT_EQ(daemon.lines_with("missed") - missed_before, 1) << "one line for the whole burst: " << daemon.log_text();
}

TEST(Faults, AThreadThatNeverSleepsEndsItWithinASecond) {
    if (!rt::guard_active()) GTEST_SKIP() << "sanitizers hold signal handlers back";
    if (rt::probe_capabilities(80).fifo_priority < 80) GTEST_SKIP() << "SCHED_FIFO is refused here: nothing can run away";
    Running daemon("runaway");
    daemon.environment = {{"SUREFOOT_TEST_FAULT", "runaway"}};
    daemon.start({}, {}, SUREFOOT_DAEMON_WITH_FAULTS);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    // It runs away 40 frames of 20 ms after the first.
    const std::int64_t ready_ns = daemon.socket.all.back().at_ns;
    ASSERT_EQ(daemon.wait_exit(20), exit_runaway) << daemon.log_text();
    EXPECT_LT(NotifySocket::now_ns() - ready_ns, 1'900'000'000) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("thread sf-frame"), 1) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("real-time priority was taken"), 1) << daemon.log_text();
}

TEST(Faults, ALostContextHasItsOwnExitCode) {
    Running daemon("context-lost");
    daemon.environment = {{"SUREFOOT_TEST_FAULT", "context-lost"}};
    daemon.start({}, {}, SUREFOOT_DAEMON_WITH_FAULTS);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_EQ(daemon.wait_exit(20), exit_unavailable) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("graphics context: The context was lost while walking"), 1) << daemon.log_text();
}

TEST(Faults, AStateFolderThatCannotBeWrittenIsKnownAtTheStart) {
    Running daemon("no-state");
    daemon.write_config("input = \"devices\"\n");
    // A file stands where the folder should be: not even root can write below it.
    EXPECT_TRUE(write_text(daemon.dir + "/file", "").ok());
    daemon.start({"--set", "state=" + daemon.dir + "/file"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_cannot_write) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("The emergency stop cannot be stored in the state folder"), 1) << daemon.log_text();
}

TEST(Faults, AWindowWithoutAStopNeedsNoStateFolder) {
    Running daemon("window-no-state");
    EXPECT_TRUE(write_text(daemon.dir + "/file", "").ok());
    daemon.environment = {{"DISPLAY", ""}};
    daemon.write_config("", "window");
    daemon.start({"--set", "state=" + daemon.dir + "/file"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_unavailable) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("The emergency stop cannot be stored"), 0) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("DISPLAY is not set"), 1) << "it came as far as its window: " << daemon.log_text();
}

TEST(Faults, AWindowWithAStopNeedsTheStateFolder) {
    Running daemon("window-stop-no-state");
    EXPECT_TRUE(write_text(daemon.dir + "/file", "").ok());
    EXPECT_TRUE(
        write_text(daemon.dir + "/keys.toml",
                   "[[device]]\nproduct_name = \"window\"\n[[device.button]]\ncontrol = \"key-space\"\naction = \"stop\"\n")
            .ok());
    daemon.environment = {{"DISPLAY", ""}};
    daemon.write_config("steering = \"keys.toml\"\n", "window");
    daemon.start({"--set", "state=" + daemon.dir + "/file"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_cannot_write) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("The emergency stop cannot be stored in the state folder"), 1) << daemon.log_text();
}

TEST(Faults, AFullDiskIsKnownAtTheStart) {
    Running daemon("full-disk");
    daemon.write_config("input = \"devices\"\n");
    daemon.start({}, {.file_bytes = 3000});  // enough for what it says, not for a page
    EXPECT_EQ(daemon.wait_exit(start_s), exit_cannot_write) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("The emergency stop cannot be stored in the state folder"), 1) << daemon.log_text();
}

}  // namespace
}  // namespace surefoot::daemon::test
