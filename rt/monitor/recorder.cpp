// The monitor thread.
#include "rt/monitor/recorder.hpp"

#include <algorithm>
#include <chrono>

#include "rt/threads/placement.hpp"

namespace surefoot::rt {

namespace {

constexpr std::size_t max_batch = 256;

}  // namespace

Recorder::Recorder(SpscRing<FrameRecord>& ring, RecorderOptions options) : ring_(ring), options_(std::move(options)) {
    if (options_.keep) records_.reserve(options_.reserve_records);
    batch_.reserve(max_batch);
    thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() { stop(); }

void Recorder::stop() {
    if (!thread_.joinable()) return;
    {
        const MutexLock lock(mutex_);
        stopping_ = true;
    }
    stop_.notify_all();
    thread_.join();
}

void Recorder::run() {
    // Only the name: the thread's place is its creator's, who is neutral.
    if (auto own = read_thread(0)) {
        own->name = options_.thread_name;
        (void)restore_thread(*own);
    }
    while (!stopping_before_next_poll()) drain();
    drain();
}

bool Recorder::stopping_before_next_poll() {
    const std::int64_t poll_ns = any_came_ ? options_.poll_ns : std::min(options_.poll_ns, options_.first_poll_ns);
    const auto next = std::chrono::steady_clock::now() + std::chrono::nanoseconds(poll_ns);
    const MutexLock lock(mutex_);
    while (!stopping_ && stop_.wait_until(mutex_, next)) {
    }
    return stopping_;
}

void Recorder::drain() {
    do {
        FrameRecord popped;
        batch_.clear();
        while (batch_.size() < max_batch && ring_.try_pop(popped)) batch_.push_back(popped);
        any_came_ = any_came_ || !batch_.empty();
        if (options_.on_batch) options_.on_batch(batch_);
        for (const FrameRecord& record : batch_) {
            if (options_.keep) records_.push_back(record);
            if (options_.on_record) options_.on_record(record);
        }
    } while (batch_.size() == max_batch);
}

}  // namespace surefoot::rt
