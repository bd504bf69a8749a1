// A ring, a window of misses, and a hand-over by one atomic word.
#include "rt/monitor/incident_recorder.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::rt {

namespace {

std::int64_t in_ns(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace

IncidentRecorder::IncidentRecorder(const IncidentRecorderOptions& options) : options_(options) {}

void IncidentRecorder::begin(std::int64_t period_ns) {
    period_ns_ = std::max<std::int64_t>(period_ns, 1);
    capacity_ = static_cast<std::size_t>(std::max<std::int64_t>(in_ns(options_.keep_s) / period_ns_, 1));
    ring_.clear();
    ring_.reserve(capacity_);
    next_ = 0;
    recent_misses_.clear();
    recent_count_ = 0;
    hand_over_ns_ = 0;
}

void IncidentRecorder::add(const FrameRecord& record) {
    if (ring_.size() < capacity_) {
        ring_.push_back(record);
    } else {
        ring_[next_] = record;
    }
    next_ = (next_ + 1) % capacity_;
    if (hand_over_ns_ == 0) {
        look_for_burst(record);
    } else if (record.complete_ns >= hand_over_ns_) {
        hand_over();
    }
}

void IncidentRecorder::look_for_burst(const FrameRecord& record) {
    while (!recent_misses_.empty() && record.complete_ns - recent_misses_.front().at_ns > in_ns(options_.burst_s)) {
        recent_count_ -= recent_misses_.front().count;
        recent_misses_.pop_front();
    }
    // The control's bare frames miss too, and are nobody's fault.
    const std::uint64_t missed = record.control ? 0 : (record.missed ? 1U : 0U) + record.skipped_before;
    if (missed == 0) return;
    recent_misses_.push_back({record.complete_ns, record.frame, missed});
    recent_count_ += missed;
    if (recent_count_ < options_.burst_misses) return;
    bursts_.fetch_add(1, std::memory_order_relaxed);
    burst_frame_ = recent_misses_.front().frame;
    recent_misses_.clear();
    recent_count_ = 0;
    const bool too_soon =
        ever_ && record.complete_ns >= handed_over_ns_ && record.complete_ns - handed_over_ns_ < in_ns(options_.between_s);
    if (too_soon) {
        suppress();
    } else {
        hand_over_ns_ = record.complete_ns + in_ns(options_.after_s);
    }
}

void IncidentRecorder::finish() {
    if (hand_over_ns_ != 0) hand_over();
}

void IncidentRecorder::hand_over() {
    hand_over_ns_ = 0;
    if (state_.load(std::memory_order_acquire) != idle) {
        suppress();
        return;
    }
    incident_.number = bursts();
    incident_.first_frame = burst_frame_;
    incident_.suppressed = suppressed();
    incident_.period_ns = period_ns_;
    const std::size_t oldest = ring_.size() < capacity_ ? 0 : next_;
    incident_.records.clear();
    incident_.records.reserve(capacity_);
    for (std::size_t i = 0; i < ring_.size(); ++i) incident_.records.push_back(ring_[(oldest + i) % ring_.size()]);
    handed_over_ns_ = incident_.records.back().complete_ns;
    ever_ = true;
    state_.store(full, std::memory_order_release);
    state_.notify_all();
}

const IncidentRecorder::Incident* IncidentRecorder::wait() {
    for (;;) {
        const std::uint32_t state = state_.load(std::memory_order_acquire);
        if (state == full) return &incident_;
        if (state == stopped) return nullptr;
        state_.wait(state, std::memory_order_acquire);
    }
}

void IncidentRecorder::done() {
    state_.store(stopping_.load(std::memory_order_acquire) ? stopped : idle, std::memory_order_release);
}

void IncidentRecorder::stop() {
    stopping_.store(true, std::memory_order_release);
    std::uint32_t expected = idle;
    state_.compare_exchange_strong(expected, stopped, std::memory_order_acq_rel);
    state_.notify_all();
}

}  // namespace surefoot::rt
