// The pages of a running service, as Prometheus text, and as JSON for `surefoot status` and `surefoot top`. They show the walk's
// figures and settings, the process, and the monitor itself. Pure functions of one struct.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/check.hpp"
#include "rt/monitor/process.hpp"
#include "rt/monitor/telemetry.hpp"
#include "tools/report/report.hpp"

namespace surefoot::monitor {

/// What the service does. Prometheus has a series for each.
enum class ServicePhase : std::uint8_t { starting, walking, stopped, failed };
constexpr std::size_t service_state_count = 4;
std::string_view service_phase_name(ServicePhase state);

/// Known when a walk begins.
struct MonitoredWalk {
    std::string model, path, selector, backend, renderer, clock;
    double rate_hz = 0;
    bool cache = false;  ///< pictures may be made while walking
    rt::TelemetrySetup setup;
    rt::Granted granted;
};

/// A message that was shown to the user.
struct MonitoredNote {
    double age_s = 0;
    std::string text;
};

/// The monitor's own counters.
struct MonitorCounts {
    std::uint64_t scrapes = 0, refused = 0;            ///< answered with a page; answered with an error
    std::uint64_t dropped_slow = 0, dropped_full = 0;  ///< readers dropped: too slow, or too many
    std::uint64_t bursts = 0, incidents_written = 0, incidents_suppressed = 0, incidents_failed = 0;
    std::uint64_t open_readers = 0;
    double monitor_cpu_s = 0;  ///< of the monitor thread, this walk's
};

/// Everything at one moment. `figures` must outlive it.
struct MonitorPage {
    const rt::Figures* figures = nullptr;
    std::string version;
    std::int64_t pid = 0;
    ServicePhase state = ServicePhase::starting;
    double up_s = 0;               ///< of this monitor
    double started_unix_s = 0;     ///< the same moment as wall time, seconds since 1970
    double last_frame_age_s = -1;  ///< since the newest frame that the figures know of; -1: none yet, or the clock is not real
    MonitoredWalk walk;
    std::vector<rt::Lack> degraded;
    rt::InputState input;
    std::vector<MonitoredNote> notes;  ///< the last few, oldest first; only in the JSON
    rt::ProcessFigures process;
    std::vector<rt::BusyThread> threads;  ///< only in the JSON
    MonitorCounts counts;
    std::vector<RareCheck> rare_checks;  ///< of this process: counts of failed CHECK_RARE
};

/// What a lack is about, as a label's value: fifo, memory_lock, isolated_core, throttled, placing, cost_table, switched_off,
/// census, sanitizer, other.
std::string_view degraded_reason(rt::LackKind kind);
std::span<const std::string_view> degraded_reasons();  ///< by kind

/// Prometheus' text format 0.0.4. Names, units and HELP are the contract; every label's values are bounded.
std::string prometheus_text(const MonitorPage& page);
constexpr std::string_view prometheus_content_type = "text/plain; version=0.0.4; charset=utf-8";

/// One JSON object; numbers that are not known are null.
std::string status_json(const MonitorPage& page);

}  // namespace surefoot::monitor
