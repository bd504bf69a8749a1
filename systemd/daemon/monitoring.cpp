// From settings to a monitor.
#include "systemd/daemon/monitoring.hpp"

#include <cstdlib>

#include "tools/monitor/address.hpp"

namespace surefoot::daemon {

std::string monitor_address(const config::Settings& settings, bool has_runtime_directory) {
    if (settings.monitor == no_monitor) return {};
    if (!settings.monitor.empty()) return settings.monitor;
    return has_runtime_directory ? monitor::default_address() : std::string();
}

std::unique_ptr<monitor::Monitor> open_monitor(const config::Configuration& configuration, Log& log) {
    monitor::MonitorOptions options;
    options.address = monitor_address(configuration.values, std::getenv("RUNTIME_DIRECTORY") != nullptr);
    options.incidents_dir = config::file_setting(configuration, "incidents", {});
    options.version = SUREFOOT_VERSION;
    options.notify = [&log](std::string_view text) { log.write(Priority::notice, event::misses, text); };
    if (options.address.empty() && options.incidents_dir.empty()) return nullptr;
    auto monitor = monitor::Monitor::open(std::move(options));
    if (monitor) return std::move(*monitor);
    log.write(Priority::error, event::fault,
              "The monitor cannot start, and the walk goes on without it. " + monitor.error().text());
    return nullptr;
}

}  // namespace surefoot::daemon
