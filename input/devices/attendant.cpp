// The attendant.
#include "input/devices/attendant.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::input {

Wanted wanted_by(std::vector<DeviceMapping> mappings) {
    return [mappings = std::move(mappings)](const PluggedDevice& p) {
        const DeviceMapping* m = find_mapping(mappings, identity_for_mapping(p));
        if (m == nullptr) return steers_by_class(p);
        return !m->axes.empty() || !m->sticks.empty() || !m->hats.empty() || !m->buttons.empty();
    };
}

DeviceIdentity identity_for_mapping(const PluggedDevice& p) { return {p.vendor, p.product, p.name, p.device.device_class}; }

Attendant::Attendant(std::vector<DeviceMapping> mappings, Steering& steering, Say say)
    : mappings_(std::move(mappings)), steering_(steering), say_(std::move(say)) {}

Attendant::Device* Attendant::find(int device) {
    const auto found = std::find_if(devices_.begin(), devices_.end(),
                                    [&](const std::unique_ptr<Device>& d) { return d->attended.device == device; });
    return found == devices_.end() ? nullptr : found->get();
}

void Attendant::attend(const DeviceEvent& e) {
    switch (e.kind) {
        case DeviceEvent::Kind::added:
            return added(e);
        case DeviceEvent::Kind::removed:
            return removed(e);
        case DeviceEvent::Kind::refused:
            return say(e.why->text());
        case DeviceEvent::Kind::report:
            if (Device* d = find(e.device)) {
                if (d->decoder.decode(e.bytes, e.stamp_ns, d->state) == ReportFate::accepted) {
                    ++accepted_reports_;
                    steering_.report(d->attended.steering, d->state, e.stamp_ns);
                } else {
                    ++refused_reports_;
                }
            }
            return;
        case DeviceEvent::Kind::drained:
            if (const Device* d = find(e.device)) steering_.drained(d->attended.steering, e.reports);
            return;
    }
}

void Attendant::added(const DeviceEvent& e) {
    const PluggedDevice& p = *e.plugged;
    const DeviceMapping* configured = find_mapping(mappings_, identity_for_mapping(p));
    const DeviceMapping mapping = configured != nullptr ? *configured : default_mapping(p.device.controls, p.device.device_class);
    Mapper mapper = compile_what_fits(mapping, p.device.controls);
    for (const std::string& note : mapper.notes) say(fmt::format("{} ({}): {}", p.node, p.name, note));
    const std::string identity = p.identity();
    int again = -1;
    if (const auto known = numbers_.find(identity); known != numbers_.end()) {
        const bool taken = std::any_of(devices_.begin(), devices_.end(),
                                       [&](const std::unique_ptr<Device>& d) { return d->attended.steering == known->second; });
        if (!taken) again = known->second;
    }
    const int number = steering_.attach(std::move(mapper), p.device.controls.size(), mapping.reporting, again);
    if (number < 0) return say(fmt::format("{} ({}): {} devices steer already; unplug one", p.node, p.name, max_devices));
    std::erase_if(numbers_, [&](const auto& known) { return known.second == number; });
    numbers_[identity] = number;
    auto device = std::make_unique<Device>(p.device);
    device->attended = {e.device, number, mapping.name, e.plugged};
    device->state.connected = true;
    say(fmt::format("{} ({}): steers, by the mapping \"{}\"", p.node, p.name, mapping.name));
    devices_.push_back(std::move(device));
}

void Attendant::removed(const DeviceEvent& e) {
    const Device* d = find(e.device);
    if (d == nullptr) return;
    steering_.detach(d->attended.steering);
    say(fmt::format("{} ({}): {}", d->attended.plugged->node, d->attended.plugged->name, e.why->what));
    std::erase_if(devices_, [&](const std::unique_ptr<Device>& other) { return other.get() == d; });
}

std::vector<Attendant::Attended> Attendant::attended() const {
    std::vector<Attended> list;
    for (const auto& d : devices_) list.push_back(d->attended);
    return list;
}

}  // namespace surefoot::input
