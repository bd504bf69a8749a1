// The live source.
#include "input/live_source.hpp"

#include <algorithm>

#include "input/devices/live.hpp"
#include "input/devices/no_devices.hpp"

namespace surefoot::input {

namespace {

constexpr std::int64_t look_for_ns = 500'000'000;  // the finder has looked everywhere by then

}  // namespace

Result<std::unique_ptr<LiveSource>> LiveSource::open(LiveOptions options) {
    if (!options.devices) return std::make_unique<LiveSource>(std::move(options), std::make_unique<NoDevices>());
    FinderOptions finder;
    finder.wanted = wanted_by(options.mappings);
    finder.attachment_factory = attachment_factory(options.mappings);
    auto live = open_live(std::move(finder), true);
    if (!live) return live.error();
    return std::make_unique<LiveSource>(std::move(options), std::move(*live));
}

LiveSource::LiveSource(LiveOptions options, std::unique_ptr<DeviceSource> devices)
    : options_(std::move(options)),
      sink_([this](std::string_view text) {
          MessageLine line;
          line.size = std::min(text.size(), line.text.size());
          std::copy_n(text.begin(), line.size, line.text.begin());
          messages_.try_push(line);
      }),
      devices_(std::move(devices)) {
    log_.reserve(options_.stamps);
    if (devices_->trouble()) emit(sink_, *devices_->trouble());
    if (!options_.lines.empty())
        panel_.emplace(options_.lines, options_.mappings, options_.open_lines, options_.lines_context, sink_,
                       options_.lines_opened);
    if (options_.window) window_.emplace(options_.window, options_.mappings, options_.window_deg_per_px, sink_);
    watched_.reserve(max_lines + 1);
}

void LiveSource::begin(Steering& steering, std::int64_t start_ns) {
    start_ns_ = start_ns;
    router_.emplace(options_.mappings, steering, sink_);
    if (panel_) panel_->open();
    if (window_) window_->begin(steering, start_ns);
    watch();
}

void LiveSource::watch() {
    watched_.clear();
    if (panel_) watched_.insert(watched_.end(), panel_->polled().begin(), panel_->polled().end());
    if (window_) watched_.push_back(window_->polled());
    if (!watched_.empty()) devices_->watch_also(watched_);
}

void LiveSource::wait(rt::Clock& /*clock*/, std::int64_t until_ns) { devices_->wait(until_ns); }

Lines LiveSource::drain(Steering& steering, std::int64_t now_ns) {
    for (const DeviceEvent& e : devices_->take()) {
        const std::uint64_t before = router_->accepted_reports();
        router_->dispatch(e);
        if (router_->accepted_reports() != before) log_.add(e.stamp_ns);
    }
    Lines lines;
    if (panel_) {
        const PanelDevice::Step step = panel_->step(steering, now_ns);
        lines = step.lines;
        if (step.reported) log_.add(now_ns);
        watch();
    }
    if (window_) window_->step(steering, now_ns, [this](std::int64_t stamp_ns) { log_.add(stamp_ns); });
    steering_now_.store(router_->steering_now() + (panel_ && panel_->has_controls() ? 1 : 0) + (window_ ? 1 : 0),
                        std::memory_order_relaxed);
    if (!somebody_) warn_if_nobody_steers(now_ns);
    if (!unused_reported_ && now_ns >= start_ns_ + look_for_ns) {
        unused_reported_ = true;
        router_->warn_unused_mappings([&](const DeviceMapping& m) {
            return (panel_ && panel_->has_controls() && panel_->mapping() == m.name) || (window_ && window_->mapping() == m.name);
        });
    }
    return lines;
}

void LiveSource::warn_if_nobody_steers(std::int64_t now_ns) {
    if (router_->pluggings() > 0 || window_ || (panel_ && panel_->has_controls())) {
        somebody_ = true;
    } else if (now_ns >= start_ns_ + look_for_ns) {
        somebody_ = true;
        emit(sink_,
             "No connected device steers. The walk rests at its start until one is plugged in. "
             "See `surefoot devices list` for the reasons.");
    }
}

std::vector<rt::SteeringDevice> LiveSource::devices() const {
    std::vector<rt::SteeringDevice> list;
    if (router_) list = router_->known_devices();
    if (panel_ && panel_->has_controls())
        list.push_back({std::string(panel_name), class_name(DeviceClass::buttons), panel_->mapping()});
    if (window_) list.push_back({std::string(window_device_name), "keyboard and mouse", window_->mapping()});
    return list;
}

bool has_stop(const SteeringFile& steering) {
    const auto stops = [](const ButtonMapping& b) { return b.action == Action::stop; };
    return std::any_of(steering.lines.begin(), steering.lines.end(),
                       [](const LineConfig& l) { return l.role == LineRole::stop; }) ||
           std::any_of(steering.devices.begin(), steering.devices.end(),
                       [&](const DeviceMapping& m) { return std::any_of(m.buttons.begin(), m.buttons.end(), stops); }) ||
           std::any_of(steering.lines.begin(), steering.lines.end(),
                       [](const LineConfig& l) { return l.role == LineRole::button && l.name == name_of(Action::stop); });
}

}  // namespace surefoot::input
