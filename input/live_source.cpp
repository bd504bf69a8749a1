// The live source.
#include "input/live_source.hpp"

#include <algorithm>

#include "input/devices/live.hpp"

namespace surefoot::input {

namespace {

constexpr std::int64_t look_for_ns = 500'000'000;  // the finder has looked everywhere by then

}  // namespace

Result<std::unique_ptr<LiveSource>> LiveSource::open(LiveOptions options) {
    FinderOptions finder;
    finder.wanted = wanted_by(options.mappings);
    finder.ready = readier(options.mappings);
    auto live = open_live(std::move(finder), true);
    if (!live) return live.error();
    return std::make_unique<LiveSource>(std::move(options), std::move(*live));
}

LiveSource::LiveSource(LiveOptions options, std::unique_ptr<DeviceSource> devices)
    : options_(std::move(options)),
      say_([this](std::string_view text) {
          NoteLine line;
          line.size = std::min(text.size(), line.text.size());
          std::copy_n(text.begin(), line.size, line.text.begin());
          notes_.try_push(line);
      }),
      devices_(std::move(devices)) {
    log_.reserve(options_.stamps);
    if (devices_->trouble()) tell(say_, *devices_->trouble());
    if (!options_.lines.empty())
        panel_.emplace(options_.lines, options_.mappings, options_.open_lines, options_.lines_context, say_,
                       options_.lines_opened);
}

void LiveSource::begin(Steering& steering, std::int64_t start_ns) {
    start_ns_ = start_ns;
    attendant_.emplace(options_.mappings, steering, say_);
    if (panel_) panel_->open();
}

void LiveSource::wait(rt::Clock& /*clock*/, std::int64_t until_ns) { devices_->wait(until_ns); }

Lines LiveSource::drain(Steering& steering, std::int64_t now_ns) {
    for (const DeviceEvent& e : devices_->take()) {
        const std::uint64_t before = attendant_->accepted_reports();
        attendant_->attend(e);
        if (attendant_->accepted_reports() != before) log_.add(e.stamp_ns);
    }
    Lines lines;
    if (panel_) {
        const PanelDevice::Step step = panel_->step(steering, now_ns);
        lines = step.lines;
        if (step.reported) log_.add(now_ns);
        devices_->watch_also(panel_->polled());
    }
    steering_now_.store(attendant_->steering_now() + (panel_ && panel_->has_controls() ? 1 : 0), std::memory_order_relaxed);
    if (!somebody_) say_if_nobody_steers(now_ns);
    if (!waiting_said_ && now_ns >= start_ns_ + look_for_ns) {
        waiting_said_ = true;
        attendant_->say_waiting(
            [&](const DeviceMapping& m) { return panel_ && panel_->has_controls() && panel_->mapping() == m.name; });
    }
    return lines;
}

void LiveSource::say_if_nobody_steers(std::int64_t now_ns) {
    if (attendant_->pluggings() > 0 || (panel_ && panel_->has_controls())) {
        somebody_ = true;
    } else if (now_ns >= start_ns_ + look_for_ns) {
        somebody_ = true;
        tell(say_,
             "No connected device steers. The walk rests at its start until one is plugged in. "
             "See `surefoot devices list` for the reasons.");
    }
}

std::vector<rt::SteeringDevice> LiveSource::devices() const {
    std::vector<rt::SteeringDevice> list;
    if (attendant_) list = attendant_->met();
    if (panel_ && panel_->has_controls())
        list.push_back({std::string(panel_name), class_name(DeviceClass::buttons), panel_->mapping()});
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
