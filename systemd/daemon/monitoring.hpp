// The monitor of the service, as the settings describe it. If it cannot be opened, the service walks without it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "config/settings.hpp"
#include "systemd/daemon/log.hpp"
#include "tools/monitor/monitor.hpp"

namespace surefoot::daemon {

/// The value of the setting `monitor` for no monitor.
constexpr std::string_view no_monitor = "none";

/// The monitor's address: that of the settings, else surefoot.sock in the service's run-time folder if it has one, else nowhere
/// (empty).
std::string monitor_address(const config::Settings& settings, bool has_runtime_directory);

/// Null if the settings have none, or if it cannot be opened, which is logged. Call it from a neutral thread, before the first
/// walk: it stays for all of them, so a reload does not move it.
std::unique_ptr<monitor::Monitor> open_monitor(const config::Configuration& configuration, Log& log);

}  // namespace surefoot::daemon
