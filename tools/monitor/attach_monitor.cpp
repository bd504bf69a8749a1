// The walk's words into the monitor's.
#include "tools/monitor/monitor.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "render/capture/capture.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::monitor {

namespace {

MonitoredWalk monitored(const walk::WalkRequest& request, const walk::WalkStart& start) {
    MonitoredWalk w;
    w.model = request.model_file;
    w.path = request.input_file.empty() ? start.path : request.input_file;
    w.selector = request.selector;
    w.backend = request.backend;
    w.renderer = start.renderer;
    w.clock = rt::name_of(request.clock);
    w.rate_hz = request.rate_hz;
    w.cache = request.cache != rt::ImageCache::off;
    w.setup.period_ns = start.period_ns;
    w.setup.late = request.late;
    w.setup.rasterisers = static_cast<std::uint32_t>(std::max(start.rasterisers, 1));
    w.granted = start.granted;
    return w;
}

/// `then` after what was there.
template <class Argument, class Then>
void chain(std::function<void(Argument)>& callback, Then then) {
    callback = [before = std::exchange(callback, {}), then](Argument argument) {
        if (before) before(argument);
        then(argument);
    };
}

}  // namespace

void attach_monitor(Monitor& monitor, const walk::WalkRequest& request, walk::WalkObserver& observer) {
    chain(observer.on_started, [&monitor, &request](const walk::WalkStart& start) {
        std::vector<rt::Lack> lacks(start.degraded.begin(), start.degraded.end());
        if (!start.uncalibrated.empty()) lacks.push_back({rt::LackKind::cost_table, start.uncalibrated, ""});
        monitor.set_degraded(std::move(lacks));
        monitor.begin_walk(monitored(request, start));
    });
    chain(observer.on_record, [&monitor](const rt::FrameRecord& record) { monitor.on_record(record); });
    chain(observer.on_degraded, [&monitor](const rt::Lack& lack) { monitor.add_degraded(lack); });
    chain(observer.on_input, [&monitor](const rt::InputState& input) { monitor.set_input(input); });
    if (monitor.writes_incidents()) {
        chain(observer.on_missed_frame, [&monitor](const capture::Capture& frame) {
            // Shared, for the writer's thread may hold it when the next one comes.
            monitor.offer({frame.frame, [kept = std::make_shared<const capture::Capture>(frame)](const std::string& file) {
                               return capture::write_capture(file, *kept);
                           }});
        });
    }
    chain(observer.on_step, [&monitor](walk::WalkStep step) {
        if (step == walk::WalkStep::ending) monitor.end_walk();
    });
}

}  // namespace surefoot::monitor
