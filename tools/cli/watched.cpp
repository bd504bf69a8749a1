// The walk's words into the monitor's.
#include "tools/cli/watched.hpp"

#include "tools/cli/command.hpp"

namespace surefoot::cli {

namespace {

report::MonitoredWalk monitored(const app::WalkRequest& request, const app::WalkStart& start) {
    report::MonitoredWalk w;
    w.model = request.model_file;
    w.path = request.input_file.empty() ? start.path : request.input_file;
    w.selector = request.selector;
    w.backend = request.backend;
    w.renderer = start.renderer;
    w.clock = request.clock;
    w.rate_hz = request.rate_hz;
    w.setup.period_ns = start.period_ns;
    w.setup.late = request.late == "lock" ? rt::LatePolicy::lock : rt::LatePolicy::floating;
    w.setup.rasterisers = static_cast<std::uint32_t>(std::max(start.rasterisers, 1));
    w.budget_ms = request.budget_ms;
    w.fifo = start.fifo;
    w.locked = start.locked;
    w.isolated = start.isolated;
    w.frame_core = start.frame_core;
    return w;
}

}  // namespace

Result<std::unique_ptr<console::Monitor>> open_monitor(const WatchRequest& request) {
    if (request.address.empty() && request.incidents_dir.empty()) return std::unique_ptr<console::Monitor>();
    console::MonitorOptions options;
    options.address = request.address;
    options.incidents_dir = request.incidents_dir;
    options.version = SUREFOOT_VERSION;
    options.say = [](std::string_view text) { note(std::string(text)); };
    return console::Monitor::open(std::move(options));
}

app::WalkWatch watch_of(console::Monitor& monitor, const app::WalkRequest& request) {
    app::WalkWatch watch;
    watch.on_started = [&monitor, &request](const app::WalkStart& start) {
        std::vector<report::Degraded> lacks(start.degraded.begin(), start.degraded.end());
        if (!start.uncalibrated.empty()) lacks.push_back({start.uncalibrated, ""});
        monitor.set_degraded(std::move(lacks));
        monitor.begin_walk(monitored(request, start));
    };
    watch.on_record = [&monitor](const rt::FrameRecord& record) { monitor.on_record(record); };
    watch.on_degraded = [&monitor](const report::Degraded& lack) { monitor.add_degraded(lack); };
    watch.on_input = [&monitor](const app::WalkInput& input) {
        monitor.set_input({input.live, input.devices, input.emergency_stop});
    };
    watch.on_step = [&monitor](app::WalkStep step) {
        if (step == app::WalkStep::ending) monitor.end_walk();
    };
    return watch;
}

}  // namespace surefoot::cli
