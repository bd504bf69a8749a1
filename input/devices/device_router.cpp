// Routes events of live devices to the steering.
#include "input/devices/device_router.hpp"

#include <algorithm>

#include "rt/base/check.hpp"

namespace surefoot::input {

namespace {

constexpr std::size_t max_known = 64;

/// A mapping without controls is there to switch a device off.
bool steers(const DeviceMapping& m) { return !m.axes.empty() || !m.sticks.empty() || !m.hats.empty() || !m.buttons.empty(); }

}  // namespace

Wanted wanted_by(std::vector<DeviceMapping> mappings) {
    return [mappings = std::move(mappings)](const PluggedDevice& p) {
        const DeviceMapping* m = find_mapping(mappings, identity_for_mapping(p));
        if (m == nullptr) return steers_by_class(p);
        return steers(*m);
    };
}

DeviceIdentity identity_for_mapping(const PluggedDevice& p) { return {p.vendor, p.product, p.name, p.device.device_class}; }

std::unique_ptr<SteeringAttachment> make_attachment(std::span<const DeviceMapping> mappings, const PluggedDevice& p) {
    const DeviceMapping* configured = find_mapping(mappings, identity_for_mapping(p));
    const DeviceMapping mapping = configured != nullptr ? *configured : default_mapping(p.device.controls, p.device.device_class);
    auto attachment = std::make_unique<SteeringAttachment>(p.device);
    attachment->mapper = compile_what_fits(mapping, p.device.controls);
    attachment->reporting = mapping.reporting;
    attachment->state.connected = true;
    attachment->identity = p.identity();
    attachment->mapping = mapping.name;
    if (configured != nullptr) attachment->configured = static_cast<int>(configured - mappings.data());
    attachment->known = {attachment->identity, {p.name, class_name(p.device.device_class), mapping.name}};
    return attachment;
}

std::function<std::unique_ptr<DeviceAttachment>(const PluggedDevice&)> attachment_factory(std::vector<DeviceMapping> mappings) {
    return [mappings = std::move(mappings)](const PluggedDevice& p) { return make_attachment(mappings, p); };
}

DeviceRouter::DeviceRouter(std::vector<DeviceMapping> mappings, Steering& steering, MessageSink sink)
    : mappings_(std::move(mappings)), fitted_(mappings_.size(), false), steering_(steering), sink_(std::move(sink)) {
    known_.reserve(max_known);
}

DeviceRouter::Slot* DeviceRouter::find(int device) {
    const auto found = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.device == device; });
    return found == slots_.end() ? nullptr : &*found;
}

void DeviceRouter::dispatch(const DeviceEvent& e) {
    steering_.steers.plays();
    switch (e.kind) {
        case DeviceEvent::Kind::added:
            return added(e);
        case DeviceEvent::Kind::removed:
            return removed(e);
        case DeviceEvent::Kind::refused:
            return emit(sink_, *e.why);
        case DeviceEvent::Kind::report:
            if (const Slot* s = find(e.device)) {
                if (s->attachment->decoder.decode(e.bytes, e.stamp_ns, s->attachment->state) == ReportFate::accepted) {
                    ++accepted_reports_;
                    steering_.report(s->steering, s->attachment->state, e.stamp_ns);
                } else {
                    ++refused_reports_;
                }
            }
            return;
        case DeviceEvent::Kind::drained:
            if (const Slot* s = find(e.device)) steering_.drained(s->steering, e.reports);
            return;
    }
}

/// The number that this device had, if nobody has it now; else -1.
int DeviceRouter::number_before(const std::string& identity) const {
    for (std::size_t i = 0; i < identities_.size(); ++i) {
        const int number = static_cast<int>(i);
        const auto has_it = [&](const Slot& s) { return s.device >= 0 && s.steering == number; };
        if (identities_[i] == identity && std::none_of(slots_.begin(), slots_.end(), has_it)) return number;
    }
    return -1;
}

void DeviceRouter::remember(SteeringAttachment& device) {
    ++pluggings_;
    const auto same = [&](const KnownDevice& m) {
        return m.identity == device.identity && m.description.mapping == device.mapping;
    };
    if (known_.size() == max_known || std::any_of(known_.begin(), known_.end(), same)) return;
    known_.push_back(std::move(device.known));
}

void DeviceRouter::added(const DeviceEvent& e) {
    const PluggedDevice& p = *e.plugged;
    std::unique_ptr<SteeringAttachment> own;
    auto* attachment = static_cast<SteeringAttachment*>(e.attachment);
    if (attachment == nullptr) {
        own = make_attachment(mappings_, p);
        attachment = own.get();
    }
    for (const std::string& message : attachment->mapper.messages) emit(sink_, "{} ({}): {}", p.node, p.name, message);
    if (attachment->configured >= 0) fitted_[static_cast<std::size_t>(attachment->configured)] = true;
    Slot* slot = find(-1);
    const int number = slot == nullptr ? -1
                                       : steering_.attach(std::move(attachment->mapper), p.device.controls.size(),
                                                          attachment->reporting, number_before(attachment->identity));
    if (number < 0) return emit(sink_, "{} ({}): {} devices steer already. Unplug one.", p.node, p.name, max_devices);
    emit(sink_, "{} ({}): The device steers by the mapping \"{}\".", p.node, p.name, attachment->mapping);
    CHECK(static_cast<std::size_t>(number) < identities_.size(), "A number of the steering fits the table of identities");
    slot->device = e.device;
    slot->steering = number;
    slot->attachment = attachment;
    slot->own = std::move(own);
    slot->plugged = e.plugged;
    remember(*attachment);
    std::swap(identities_[static_cast<std::size_t>(number)], attachment->identity);
}

void DeviceRouter::warn_unused_mappings(const std::function<bool(const DeviceMapping&)>& elsewhere) const {
    for (std::size_t i = 0; i < mappings_.size(); ++i) {
        if (fitted_[i] || !steers(mappings_[i]) || elsewhere(mappings_[i])) continue;
        emit(sink_, "[[device]] {} \"{}\" matches no connected device. See `surefoot devices list`.", i + 1, mappings_[i].name);
    }
}

void DeviceRouter::removed(const DeviceEvent& e) {
    Slot* s = e.device < 0 ? nullptr : find(e.device);
    if (s == nullptr) return;
    steering_.detach(s->steering);
    emit(sink_, "{} ({}): {}.", s->plugged->node, s->plugged->name, e.why->what);
    *s = {};
}

int DeviceRouter::steering_now() const {
    return static_cast<int>(std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.device >= 0; }));
}

std::vector<rt::SteeringDevice> DeviceRouter::known_devices() const {
    std::vector<rt::SteeringDevice> list;
    for (const KnownDevice& m : known_) list.push_back(m.description);
    return list;
}

}  // namespace surefoot::input
