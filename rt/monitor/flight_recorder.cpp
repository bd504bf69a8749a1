// The flight recorder.
#include "rt/monitor/flight_recorder.hpp"

namespace surefoot::rt {

FlightRecorder::FlightRecorder(std::size_t max_dumps) : max_dumps_(max_dumps) { recent_.reserve(before); }

void FlightRecorder::add(const FrameRecord& record) {
    if (recent_.size() < before) {
        recent_.push_back(record);
    } else {
        recent_[next_] = record;
    }
    next_ = (next_ + 1) % before;
    if (left_ > 0) {
        dumps_.back().records.push_back(record);
        --left_;
    } else if (record.missed && !record.control) {
        open(record);
    }
}

void FlightRecorder::open(const FrameRecord& miss) {
    if (dumps_.size() == max_dumps_) {
        ++suppressed_;
        return;
    }
    Dump dump;
    dump.missed_frame = miss.frame;
    dump.records.reserve(before + after);
    const std::size_t oldest = recent_.size() < before ? 0 : next_;
    for (std::size_t i = 0; i < recent_.size(); ++i) dump.records.push_back(recent_[(oldest + i) % recent_.size()]);
    dumps_.push_back(std::move(dump));
    left_ = after;
}

void FlightRecorder::finish() { left_ = 0; }

}  // namespace surefoot::rt
