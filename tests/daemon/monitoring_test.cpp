// The daemon looked at from outside: live figures where the settings say, over a reload, and a walk that needs nobody to look.
#include <gtest/gtest.h>

#include "systemd/daemon/exit_code.hpp"
#include "systemd/daemon/monitoring.hpp"
#include "tests/daemon/running.hpp"
#include "tools/monitor/address.hpp"

namespace surefoot::daemon::test {
namespace {

std::string page(const std::string& socket_file, std::string_view path) {
    const auto address = monitor::parse_address("unix:" + socket_file);
    if (!address) return {};
    auto body = monitor::fetch(*address, path);
    return body ? *body : std::string();
}

TEST(Monitoring, IsWhereTheSettingsNameItElseInTheRunTimeFolder) {
    config::Settings settings;
    EXPECT_EQ(monitor_address(settings, false), "");
    EXPECT_EQ(monitor_address(settings, true), monitor::default_address());
    settings.monitor = "127.0.0.1:9464";
    EXPECT_EQ(monitor_address(settings, true), "127.0.0.1:9464");
    settings.monitor = "none";
    EXPECT_EQ(monitor_address(settings, true), "");
}

TEST(Monitoring, FiguresAreServedAndGoOnOverAReload) {
    Running daemon("monitored");
    daemon.environment = {{"RUNTIME_DIRECTORY", daemon.dir}};
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    const std::string socket = daemon.dir + "/surefoot.sock";
    EXPECT_NE(page(socket, "/metrics").find("surefoot_frames_total"), std::string::npos);
    EXPECT_NE(page(socket, "/status.json").find("forest.walk"), std::string::npos);
    ::kill(daemon.pid, SIGHUP);
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_NE(page(socket, "/status.json").find("walking"), std::string::npos) << "the same socket, after the walk began anew";
    ::kill(daemon.pid, SIGTERM);
    EXPECT_EQ(daemon.wait_exit(20), exit_success) << daemon.log_text();
    EXPECT_FALSE(std::filesystem::exists(socket)) << "nothing is left behind";
}

TEST(Monitoring, AnAddressThatCannotBeHadCostsTheFiguresAndNotTheWalk) {
    Running daemon("unmonitored");
    daemon.write_config("monitor = \"unix:" + daemon.dir + "/absent/s.sock\"\n");
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    EXPECT_EQ(daemon.lines_with("The monitor cannot start, and the walk goes on without it. "), 1) << daemon.log_text();
}

TEST(Monitoring, AnAddressThatIsNoneIsRefusedByLine) {
    Running daemon("misaddressed");
    daemon.write_config("monitor = \"0.0.0.0:80\"\n");
    daemon.start();
    EXPECT_EQ(daemon.wait_exit(start_s), exit_config);
    EXPECT_EQ(daemon.lines_with("surefoot.toml:5, monitor: "), 1) << daemon.log_text();
}

}  // namespace
}  // namespace surefoot::daemon::test
