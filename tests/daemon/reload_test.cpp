// SIGHUP: a good configuration takes over, a bad one changes nothing, and one that does not walk is taken back.
#include <gtest/gtest.h>

#include "systemd/daemon/exit_code.hpp"
#include "tests/daemon/running.hpp"

namespace surefoot::daemon::test {
namespace {

TEST(Reload, AGoodConfigurationTakesOver) {
    Running daemon("reload-good");
    daemon.environment = {{"WATCHDOG_USEC", "400000"}};  // a ping every 0.1 s, as long as frames come
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    daemon.write_config("width = 640\n");
    const std::int64_t requested_us = NotifySocket::now_ns() / 1000;
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
    const std::string& reloading = daemon.socket.all.back().text;
    const std::size_t stamp = reloading.find("MONOTONIC_USEC=");
    ASSERT_NE(stamp, std::string::npos) << "systemd wants it in the same message";
    EXPECT_GE(std::stoll(reloading.substr(stamp + 15)), requested_us);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.back().has("640x720")) << daemon.socket.text();
    EXPECT_TRUE(daemon.socket.wait_for("WATCHDOG=1", 10)) << "no more frames come: " << daemon.log_text();
    EXPECT_TRUE(daemon.runs()) << daemon.log_text();
}

TEST(Reload, AnotherNumberOfRasterisersWaitsForTheNextStart) {
    Running daemon("reload-rasterisers");
    daemon.write_config("rasterisers = 2\n");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("next start"), 0) << daemon.log_text();
    daemon.write_config("rasterisers = 3\n");
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("rasterisers: 3 take effect at the next start"), 1) << daemon.log_text();
    // As the process was started: nothing to be said.
    daemon.write_config("rasterisers = 2\n");
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("next start"), 1) << daemon.log_text();
}

TEST(Reload, ABadOneIsRefusedOnceAndTheWalkGoesOn) {
    Running daemon("reload-bad");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    const pid_t frame_thread = daemon.thread("sf-frame");
    daemon.write_config("widht = 640\n");
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", 5)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.back().has("The key 'widht' is unknown")) << "not in the status: " << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with("surefoot.toml:5: The key 'widht' is unknown"), 1) << daemon.log_text();
    EXPECT_EQ(daemon.thread("sf-frame"), frame_thread) << "the walk was interrupted";
    // A good one clears it.
    daemon.write_config();
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5));
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_FALSE(daemon.socket.all.back().has("refused")) << daemon.socket.text();
}

TEST(Reload, OneThatDoesNotWalkIsTakenBack) {
    Running daemon("reload-back");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(write_text(daemon.config_file, "model = \"absent.walk\"\nbackend = \"null\"\n").ok());
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_TRUE(daemon.socket.all.back().has("walking forest.walk (50 Hz")) << daemon.socket.text();
    EXPECT_TRUE(daemon.socket.all.back().has("absent.walk")) << "why is not in the status: " << daemon.socket.text();
    EXPECT_EQ(daemon.lines_with("absent.walk"), 1) << daemon.log_text();
}

}  // namespace
}  // namespace surefoot::daemon::test
