// Dumps around misses, cut from a ring of the last frames.
#include "rt/monitor/flight_recorder.hpp"

#include <algorithm>

namespace surefoot::rt {

FlightRecorder::FlightRecorder(std::size_t max_dumps) : max_dumps_(max_dumps) {
    recent_.reserve(before);
    dumps_.reserve(max_dumps);
}

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
        return;
    }
    if (!record.missed || record.control) return;
    if (dumps_.size() < max_dumps_) {
        open(record);
    } else {
        ++suppressed_;
    }
}

void FlightRecorder::open(const FrameRecord& miss) {
    Dump& dump = dumps_.emplace_back();
    dump.missed_frame = miss.frame;
    dump.records.reserve(before + after);
    const std::size_t oldest = recent_.size() < before ? 0 : next_;
    for (std::size_t i = 0; i < recent_.size(); ++i) dump.records.push_back(recent_[(oldest + i) % recent_.size()]);
    left_ = after;
}

void FlightRecorder::finish() { left_ = 0; }

}  // namespace surefoot::rt
