// The input thread's loop body.
#include "input/steering.hpp"

#include <algorithm>

#include "rt/base/check.hpp"

namespace surefoot::input {

namespace {

bool is_device(int number) { return number >= 0 && static_cast<std::size_t>(number) < max_devices; }

bool free_again(const Source& source) { return !source.connected && !source.output.has_stop && !source.output.has_dead_man; }

}  // namespace

Steering::Steering(const MotionLimits& motion, const SafetyLimits& safety, bool stop_latched)
    : motion_limits_(motion), safety_limits_(safety), devices_(max_devices) {
    safety_.latched = stop_latched;
}

/// Where every report comes again and again, one that does not is old, whatever the device's other reports say. Of an adapter
/// whose pads were seen to stream, the reports of one that was pulled out end while the others' go on.
std::int64_t Steering::age_limit_ns(std::size_t device) const {
    const bool learned = devices_[device].mapper.adapter && safety_.devices[device].cadence.learned_streaming;
    return learned || sources_[device].reporting == Reporting::streaming ? safety_limits_.age_limit_ns : 0;
}

int Steering::attach(Mapper&& mapper, std::size_t controls, Reporting reporting, int again) {
    std::size_t at = 0;
    if (again >= 0 && static_cast<std::size_t>(again) < max_devices && !sources_[static_cast<std::size_t>(again)].connected)
        at = static_cast<std::size_t>(again);
    else
        while (at < max_devices && !free_again(sources_[at])) ++at;
    if (at == max_devices) return -1;
    Device& device = devices_[at];
    std::swap(device.mapper, mapper);
    forget(device.mapper);
    device.controls = std::min(controls, max_controls);
    device.newest = {};
    device.ticked = true;
    Source& source = sources_[at];
    const std::uint32_t connection = source.connection + 1;
    source = {};
    source.connected = true;
    source.connection = connection;
    source.reporting = reporting;
    source.output = evaluate(device.mapper, device.newest, std::max<std::int64_t>(0, safety_.last_ns));
    return static_cast<int>(at);
}

void Steering::detach(int device) {
    if (!is_device(device)) return;
    Source& source = sources_[static_cast<std::size_t>(device)];
    const DeviceOutput before = source.output;
    source.connected = false;
    source.output = {};
    source.output.has_stop = before.has_stop;
    source.output.has_dead_man = before.has_dead_man;
}

void Steering::ended(int device) {
    if (!is_device(device)) return;
    sources_[static_cast<std::size_t>(device)].reporting = Reporting::streaming;
}

void Steering::report(int number, const DeviceState& state, std::int64_t now_ns) {
    CHECK(is_device(number), "A report has a number that attach() gave");
    const auto at = static_cast<std::size_t>(number);
    Source& source = sources_[at];
    if (!source.connected) return;
    Device& device = devices_[at];
    const auto end = state.value.begin() + static_cast<std::ptrdiff_t>(device.controls);
    const bool equal = source.reports > 0 && state.has_value == device.newest.has_value &&
                       std::equal(state.value.begin(), end, device.newest.value.begin());
    if (!equal) {
        std::copy(state.value.begin(), end, device.newest.value.begin());
        device.newest.has_value = state.has_value;
    }
    device.newest.carried_over = state.carried_over;
    device.newest.stamp_ns = state.stamp_ns;
    device.newest.reports = source.reports + 1;
    const DeviceOutput output = evaluate(device.mapper, device.newest, now_ns, age_limit_ns(at));
    source.output = device.ticked ? output : combined(source.output, output);
    device.ticked = false;
    ++source.reports;
    source.stamp_ns = state.stamp_ns;
    source.equal_report = source.equal_report || equal;
    source.moved = source.moved || !(equal || device.mapper.still);
    source.seen_neutral = source.seen_neutral || output.neutral;
}

void Steering::drained(int number, std::uint32_t reports, bool lost) {
    CHECK(is_device(number), "A drain has a number that attach() gave");
    Source& source = sources_[static_cast<std::size_t>(number)];
    source.drained = std::max(source.drained, reports);
    source.lost = source.lost || lost;
}

NavigationSample Steering::tick(const Lines& lines, std::int64_t now_ns, const Ground& ground) {
    for (std::size_t i = 0; i < max_devices; ++i) {
        // Smoothing and debouncing run on between reports.
        if (sources_[i].connected && devices_[i].ticked)
            sources_[i].output = evaluate(devices_[i].mapper, devices_[i].newest, now_ns, age_limit_ns(i));
    }
    const Command command = step(safety_, safety_limits_, sources_, lines, now_ns);
    for (std::size_t i = 0; i < max_devices; ++i)
        if (safety_.devices[i].contributed) flies_ = devices_[i].mapper.flies;
    for (std::size_t i = 0; i < max_devices; ++i) {
        sources_[i].equal_report = sources_[i].moved = sources_[i].seen_neutral = sources_[i].lost = false;
        sources_[i].drained = 0;
        devices_[i].ticked = true;
    }
    return surefoot::input::step(motion_, motion_limits_, command, now_ns, ground);
}

const Mapper& Steering::mapper(int device) const {
    CHECK(is_device(device), "A mapper is asked for by a number that attach() gave");
    return devices_[static_cast<std::size_t>(device)].mapper;
}

double Steering::worst_lag_s() const {
    double mapping = 0;
    for (const Device& device : devices_) mapping = std::max(mapping, mapping_lag_s(device.mapper));
    return mapping + input::worst_lag_s(motion_limits_.filter);
}

}  // namespace surefoot::input
