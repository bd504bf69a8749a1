// The attendant.
#include "input/devices/attendant.hpp"

#include <algorithm>

#include "rt/base/check.hpp"

namespace surefoot::input {

namespace {

constexpr std::size_t most_met = 64;

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

std::unique_ptr<ReadyDevice> make_ready(std::span<const DeviceMapping> mappings, const PluggedDevice& p) {
    const DeviceMapping* configured = find_mapping(mappings, identity_for_mapping(p));
    const DeviceMapping mapping = configured != nullptr ? *configured : default_mapping(p.device.controls, p.device.device_class);
    auto ready = std::make_unique<ReadyDevice>(p.device);
    ready->mapper = compile_what_fits(mapping, p.device.controls);
    ready->reporting = mapping.reporting;
    ready->state.connected = true;
    ready->identity = p.identity();
    ready->mapping = mapping.name;
    if (configured != nullptr) ready->configured = static_cast<int>(configured - mappings.data());
    ready->met = {ready->identity, {p.name, class_name(p.device.device_class), mapping.name}};
    return ready;
}

std::function<std::unique_ptr<Readied>(const PluggedDevice&)> readier(std::vector<DeviceMapping> mappings) {
    return [mappings = std::move(mappings)](const PluggedDevice& p) { return make_ready(mappings, p); };
}

Attendant::Attendant(std::vector<DeviceMapping> mappings, Steering& steering, Say say)
    : mappings_(std::move(mappings)), fitted_(mappings_.size(), false), steering_(steering), say_(std::move(say)) {
    met_.reserve(most_met);
}

Attendant::Slot* Attendant::find(int device) {
    const auto found = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.device == device; });
    return found == slots_.end() ? nullptr : &*found;
}

void Attendant::attend(const DeviceEvent& e) {
    steering_.steers.plays();
    switch (e.kind) {
        case DeviceEvent::Kind::added:
            return added(e);
        case DeviceEvent::Kind::removed:
            return removed(e);
        case DeviceEvent::Kind::refused:
            return tell(say_, *e.why);
        case DeviceEvent::Kind::report:
            if (const Slot* s = find(e.device)) {
                if (s->ready->decoder.decode(e.bytes, e.stamp_ns, s->ready->state) == ReportFate::accepted) {
                    ++accepted_reports_;
                    steering_.report(s->steering, s->ready->state, e.stamp_ns);
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
int Attendant::number_before(const std::string& identity) const {
    for (std::size_t i = 0; i < identities_.size(); ++i) {
        const int number = static_cast<int>(i);
        const auto has_it = [&](const Slot& s) { return s.device >= 0 && s.steering == number; };
        if (identities_[i] == identity && std::none_of(slots_.begin(), slots_.end(), has_it)) return number;
    }
    return -1;
}

void Attendant::meet(ReadyDevice& device) {
    ++pluggings_;
    const auto same = [&](const MetDevice& m) { return m.identity == device.identity && m.words.mapping == device.mapping; };
    if (met_.size() == most_met || std::any_of(met_.begin(), met_.end(), same)) return;
    met_.push_back(std::move(device.met));
}

void Attendant::added(const DeviceEvent& e) {
    const PluggedDevice& p = *e.plugged;
    std::unique_ptr<ReadyDevice> own;
    auto* ready = static_cast<ReadyDevice*>(e.readied);
    if (ready == nullptr) {
        own = make_ready(mappings_, p);
        ready = own.get();
    }
    for (const std::string& note : ready->mapper.notes) tell(say_, "{} ({}): {}", p.node, p.name, note);
    if (ready->configured >= 0) fitted_[static_cast<std::size_t>(ready->configured)] = true;
    Slot* slot = find(-1);
    const int number = slot == nullptr ? -1
                                       : steering_.attach(std::move(ready->mapper), p.device.controls.size(), ready->reporting,
                                                          number_before(ready->identity));
    if (number < 0) return tell(say_, "{} ({}): {} devices steer already; unplug one", p.node, p.name, max_devices);
    tell(say_, "{} ({}): steers, by the mapping \"{}\"", p.node, p.name, ready->mapping);
    CHECK(static_cast<std::size_t>(number) < identities_.size(), "the steering numbers no more devices than there is room for");
    slot->device = e.device;
    slot->steering = number;
    slot->ready = ready;
    slot->own = std::move(own);
    slot->plugged = e.plugged;
    meet(*ready);
    std::swap(identities_[static_cast<std::size_t>(number)], ready->identity);
}

void Attendant::say_waiting(const std::function<bool(const DeviceMapping&)>& elsewhere) const {
    for (std::size_t i = 0; i < mappings_.size(); ++i) {
        if (fitted_[i] || !steers(mappings_[i]) || elsewhere(mappings_[i])) continue;
        tell(say_, "[[device]] {} \"{}\" steers none of the devices so far (`surefoot devices list` says what is there)", i + 1,
             mappings_[i].name);
    }
}

void Attendant::removed(const DeviceEvent& e) {
    Slot* s = e.device < 0 ? nullptr : find(e.device);
    if (s == nullptr) return;
    steering_.detach(s->steering);
    tell(say_, "{} ({}): {}", s->plugged->node, s->plugged->name, e.why->what);
    *s = {};
}

std::vector<Attendant::Attended> Attendant::attended() const {
    std::vector<Attended> list;
    for (const Slot& s : slots_)
        if (s.device >= 0) list.push_back({s.device, s.steering, s.ready->mapping, s.plugged});
    return list;
}

int Attendant::steering_now() const {
    return static_cast<int>(std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.device >= 0; }));
}

std::vector<rt::SteeringDevice> Attendant::met() const {
    std::vector<rt::SteeringDevice> list;
    for (const MetDevice& m : met_) list.push_back(m.words);
    return list;
}

}  // namespace surefoot::input
