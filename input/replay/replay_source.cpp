// Recorded reports handed on in their time.
#include "input/replay/replay_source.hpp"

#include <algorithm>

#include "input/steering.hpp"

namespace surefoot::input {

ReplaySource::ReplaySource(RecordedDevice recorded) : recorded_(std::move(recorded)), decoder_(recorded_.device) {
    const auto& reports = recorded_.recording.reports;
    due_ns_.reserve(reports.size());
    for (const RecordedReport& r : reports) {
        const std::int64_t due = std::max<std::int64_t>(0, r.time_us - reports.front().time_us) * 1000;
        due_ns_.push_back(due_ns_.empty() ? 0 : std::max(due, due_ns_.back()));
    }
    log_.reserve(reports.size());
}

void ReplaySource::begin(Steering& steering, std::int64_t start_ns) {
    start_ns_ = start_ns;
    device_ = steering.attach(Mapper(recorded_.mapper), recorded_.device.controls.size(), recorded_.reporting);
    state_.connected = true;
}

std::int64_t ReplaySource::next_ns() const { return next_ < due_ns_.size() ? start_ns_ + due_ns_[next_] : never_ns; }

void ReplaySource::wait(rt::Clock& clock, std::int64_t until_ns) { clock.sleep_until_ns(std::min(until_ns, next_ns())); }

Lines ReplaySource::drain(Steering& steering, std::int64_t now_ns) {
    std::uint32_t read = 0;
    while (next_ns() <= now_ns) {
        const std::int64_t stamp_ns = next_ns();
        if (decoder_.decode(recorded_.recording.report(next_), stamp_ns, state_) == ReportFate::accepted) {
            steering.report(device_, state_, now_ns);
            log_.add(stamp_ns);
        } else {
            ++refused_;
        }
        ++read;
        if (++next_ == due_ns_.size()) steering.ended(device_);
    }
    if (read > 0) steering.drained(device_, read);
    return {};
}

std::vector<rt::SteeringDevice> ReplaySource::devices() const {
    return {{recorded_.recording.name, class_name(recorded_.device.device_class), recorded_.mapping}};
}

}  // namespace surefoot::input
