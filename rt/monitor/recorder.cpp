// The monitor thread.
#include "rt/monitor/recorder.hpp"

#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::rt {

Recorder::Recorder(SpscRing<FrameRecord>& ring, RecorderOptions options) : ring_(ring), options_(std::move(options)) {
    records_.reserve(options_.reserve_records);
    thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() { stop(); }

void Recorder::stop() {
    stopping_.store(true);
    if (!thread_.joinable()) return;
    thread_.join();
    drain();
    flight_.finish();
}

void Recorder::run() {
    Placement named;
    named.name = options_.thread_name;
    (void)place_thread(0, named);
    RealClock clock;
    while (!stopping_.load(std::memory_order_relaxed)) {
        drain();
        clock.sleep_until_ns(clock.now_ns() + options_.poll_ns);
    }
}

void Recorder::drain() {
    FrameRecord record;
    while (ring_.try_pop(record)) {
        records_.push_back(record);
        flight_.add(record);
        if (options_.on_record) options_.on_record(record);
    }
}

}  // namespace surefoot::rt
