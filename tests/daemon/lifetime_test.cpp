// surefootd as systemd sees it: ready when frames run, ends when asked, refuses what it must not run with.
#include <gtest/gtest.h>

#include <ostream>

#include "systemd/daemon/exit_code.hpp"
#include "tests/daemon/running.hpp"

namespace surefoot::daemon::test {
namespace {

TEST(Lifetime, IsReadyWhenFramesRunAndEndsWithinTwoSeconds) {
    Running daemon("lifetime");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.front().has("STATUS=opening forest.walk")) << daemon.socket.text();
    EXPECT_TRUE(daemon.socket.all.front().has("EXTEND_TIMEOUT_USEC=")) << "a big model must not be killed while it opens";
    EXPECT_TRUE(daemon.socket.all.back().has("STATUS=walking forest.walk (50 Hz")) << daemon.socket.text();
    EXPECT_NE(daemon.thread("sf-frame"), 0) << "ready without a frame thread";
    const std::int64_t requested_ns = NotifySocket::now_ns();
    ::kill(daemon.pid, SIGTERM);
    ASSERT_EQ(daemon.wait_exit(20), exit_success) << daemon.log_text();
    EXPECT_LT(NotifySocket::now_ns() - requested_ns, 2'000'000'000) << "a clean stop takes less than two seconds";
    EXPECT_TRUE(daemon.socket.wait_for("STOPPING=1", 1)) << daemon.socket.text();
    EXPECT_EQ(daemon.socket.count("WATCHDOG=1"), 0U) << "nobody asked for a watchdog";
}

TEST(Lifetime, AStopWhileAModelOpensIsNoFailure) {
    Running daemon("early-stop");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("STATUS=opening", start_s)) << daemon.log_text();
    ::kill(daemon.pid, SIGINT);
    EXPECT_EQ(daemon.wait_exit(20), exit_success) << daemon.log_text();
    EXPECT_EQ(daemon.socket.count("READY=1"), 0U);
}

TEST(Lifetime, WhatIsWrongInTheFileIsReportedWithLineAndKey) {
    Running daemon("unknown-key");
    daemon.write_config("widht = 640\nheight = 0\n");
    daemon.start();
    EXPECT_EQ(daemon.wait_exit(start_s), exit_config);
    EXPECT_EQ(daemon.lines_with("surefoot.toml:5: The key 'widht' is unknown. Did you mean 'width'?"), 1) << daemon.log_text();
    EXPECT_EQ(
        daemon.lines_with("surefoot.toml:6: The value height = 0 is not allowed. Use a whole number from 16 to 16384 (px)."), 1)
        << daemon.log_text();
    daemon.socket.take_all();
    EXPECT_EQ(daemon.socket.count("READY=1"), 0U);
}

TEST(Lifetime, AModelThatCannotBeReadHasItsOwnExitCode) {
    Running daemon("no-model");
    EXPECT_TRUE(write_text(daemon.config_file, "model = \"absent.walk\"\nbackend = \"null\"\n").ok());
    daemon.start();
    EXPECT_EQ(daemon.wait_exit(start_s), exit_no_input);
    EXPECT_EQ(daemon.lines_with(daemon.dir + "/absent.walk"), 1)
        << "relative to the settings file, said once: " << daemon.log_text();
}

TEST(Lifetime, CheckReadsTheConfigurationOnly) {
    Running daemon("check");
    daemon.write_config();
    daemon.start({"--check"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_success) << daemon.log_text();
    EXPECT_EQ(daemon.printed(), daemon.config_file + ": OK\n");
    daemon.write_config("control = true\nclock = \"virtual\"\nsteering = \"s.toml\"\n");
    daemon.start({"--check"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_failure);
    EXPECT_EQ(daemon.lines_with("surefoot.toml:5, control: "), 1) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("surefoot.toml:6, clock: "), 1) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("surefoot.toml:7, steering: "), 1) << daemon.log_text();
    daemon.start({"--chekc"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_usage);
    daemon.write_config();
    daemon.start({"--check", "--set", "rate_hz"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_usage) << daemon.log_text();
    std::filesystem::remove(daemon.config_file);
    daemon.start({"--set", "x=3"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_usage) << "a wrong key is wrong use, with a settings file or without";
    EXPECT_EQ(daemon.lines_with("--set x=3: The key 'x' is unknown"), 1) << daemon.log_text();
    daemon.start({"--help"});
    EXPECT_EQ(daemon.wait_exit(start_s), exit_success);
    EXPECT_NE(daemon.printed().find("Exit status:"), std::string::npos);
}

struct Lacking {
    const char* name;
    Taken taken;
    const char* more;  ///< settings
    const char* words;
};

void PrintTo(const Lacking& lacking, std::ostream* out) { *out << lacking.name; }

class Degraded : public testing::TestWithParam<Lacking> {};

TEST_P(Degraded, IsReportedOnceAndInTheStatus) {
    Running daemon(std::string("degraded-") + GetParam().name);
    daemon.write_config(GetParam().more);
    daemon.start({}, GetParam().taken);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.back().has("not fully real-time: ")) << daemon.socket.text();
    EXPECT_TRUE(daemon.socket.all.back().has(GetParam().words)) << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with(GetParam().words), 1) << daemon.log_text();
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.back().has(GetParam().words)) << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with(GetParam().words), 1) << "said again after a reload: " << daemon.log_text();
}

TEST_P(Degraded, WithStrictItDoesNotStart) {
    Running daemon(std::string("strict-") + GetParam().name);
    daemon.write_config(std::string("strict = true\n") + GetParam().more);
    daemon.start({}, GetParam().taken);
    EXPECT_EQ(daemon.wait_exit(start_s), exit_no_real_time) << daemon.log_text();
    EXPECT_GE(daemon.lines_with(GetParam().words), 1) << daemon.log_text();
    daemon.socket.take_all();
    EXPECT_EQ(daemon.socket.count("READY=1"), 0U) << daemon.socket.text();
}

INSTANTIATE_TEST_SUITE_P(Privileges, Degraded,
                         testing::Values(Lacking{"nice", {.sys_nice = true}, "", "SCHED_FIFO is refused"},
                                         Lacking{"lock", {.memory_lock = true}, "", "Memory cannot be locked beyond 1 MiB"},
                                         Lacking{"core", {}, "frame_core = 1000\n", "Frame core 1000 does not exist"}),
                         [](const auto& lacking) { return std::string(lacking.param.name); });

}  // namespace
}  // namespace surefoot::daemon::test
