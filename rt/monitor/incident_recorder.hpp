// Keeps the last minute of frame records, and hands them to a writer after a burst of misses.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <vector>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// Limits of the incident recorder.
struct IncidentRecorderOptions {
    double keep_s = 60;              ///< length of the kept history
    std::uint32_t burst_misses = 3;  ///< late frames and skipped slots within burst_s that make a burst
    double burst_s = 1;
    double after_s = 1;     ///< recording continues so long after the burst
    double between_s = 60;  ///< minimum time between two hand-overs; earlier bursts are suppressed
};

/// Fed by the monitor thread, which never waits. A burst is suppressed and counted if the writer still holds the last one, or if
/// it comes too soon after it. One writer thread. All times are those of the records.
class IncidentRecorder {
public:
    explicit IncidentRecorder(const IncidentRecorderOptions& options);

    /// Starts a walk; call it before the first record. Discards the records of an earlier walk.
    void begin(std::int64_t period_ns);
    /// Monitor thread, in order.
    void add(const FrameRecord& record);
    /// Monitor thread, or after it has ended: hands over a burst that is still being recorded.
    void finish();

    /// One burst, for the writer.
    struct Incident {
        std::uint64_t number = 0;       ///< of all bursts, from 1
        std::uint64_t first_frame = 0;  ///< whose miss or skipped slots began the burst
        std::uint64_t suppressed = 0;   ///< bursts so far that were not handed over
        std::int64_t period_ns = 0;
        std::vector<FrameRecord> records;  ///< in order; at most keep_s
    };
    /// Writer: waits for an incident; null after stop(). It stays valid until done().
    const Incident* wait();
    void done();
    /// Any thread: wait() returns null from now on, once nothing is waiting to be written.
    void stop();
    /// Any thread.
    [[nodiscard]] std::uint64_t bursts() const { return bursts_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t suppressed() const { return suppressed_.load(std::memory_order_relaxed); }

private:
    enum State : std::uint32_t { idle, full, stopped };
    void look_for_burst(const FrameRecord& record);
    void hand_over();
    void suppress() { suppressed_.fetch_add(1, std::memory_order_relaxed); }

    IncidentRecorderOptions options_;
    std::int64_t period_ns_ = 1;
    std::vector<FrameRecord> ring_;
    std::size_t capacity_ = 1, next_ = 0;
    struct Misses {
        std::int64_t at_ns = 0;
        std::uint64_t frame = 0, count = 0;
    };
    std::deque<Misses> recent_misses_;  ///< of the last burst_s
    std::uint64_t recent_count_ = 0;
    std::int64_t hand_over_ns_ = 0;  ///< when the burst that is being recorded ends; 0: none is
    std::uint64_t burst_frame_ = 0;
    std::int64_t handed_over_ns_ = 0;
    bool ever_ = false;
    Incident incident_;  ///< the writer's while state_ is full
    std::atomic<std::uint32_t> state_{idle};
    std::atomic<bool> stopping_{false};
    std::atomic<std::uint64_t> bursts_{0}, suppressed_{0};
};

}  // namespace surefoot::rt
