// The monitor thread: empties the ring of frame records into reserved memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "rt/base/mutex.hpp"
#include "rt/exchange/spsc_ring.hpp"
#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// Settings of the recorder.
struct RecorderOptions {
    std::size_t reserve_records = 36000;      ///< more are kept too, but memory grows then
    bool keep = true;                         ///< false: records only go to on_record (a walk without end)
    std::int64_t poll_ns = 500'000'000;       ///< how often the ring is emptied: a wake-up costs 15 to 150 us of CPU, a record 1
    std::int64_t first_poll_ns = 20'000'000;  ///< the same until the first record came: who waits for a first frame hears of it
    std::string thread_name = "sf-monitor";
    /// On the monitor thread, each time the ring was emptied, also of nothing: the new records, before they are kept. May be
    /// empty.
    std::function<void(std::span<FrameRecord>)> on_batch;
    std::function<void(const FrameRecord&)> on_record;  ///< live figures; on the monitor thread; may be empty
};

/// Start it from a neutral thread: its thread inherits from its creator. `ring` must outlive it.
class Recorder {
public:
    Recorder(SpscRing<FrameRecord>& ring, RecorderOptions options);
    ~Recorder();  ///< stops
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Empties the ring a last time and ends the thread, at once. Call it when the producer has stopped.
    void stop();
    /// After stop().
    [[nodiscard]] const std::vector<FrameRecord>& records() const { return records_; }
    [[nodiscard]] std::vector<FrameRecord> take_records() { return std::move(records_); }

private:
    void run();
    bool stopping_before_next_poll();
    void drain();
    SpscRing<FrameRecord>& ring_;
    RecorderOptions options_;
    std::vector<FrameRecord> records_, batch_;
    bool any_came_ = false;
    Mutex mutex_;
    Condition stop_;
    bool stopping_ GUARDED_BY(mutex_) = false;
    std::thread thread_;
};

}  // namespace surefoot::rt
