// Loops over all threads of the bake, and their progress.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <string_view>

#include "rt/base/fork_join.hpp"
#include "rt/base/mutex.hpp"
#include "rt/base/progress.hpp"

namespace surefoot::bake {

/// body(0) to body(count - 1) on all threads of the arena.
template <class Body>
void for_all(std::size_t count, const Body& body) {
    ForkJoin loop;
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const ForkJoin::Task task(loop);
        body(i);
    });
    loop.joined();
}

/// Progress from many threads, reported about ten times a second; and the request to stop.
class Stage {
public:
    Stage(const Progress& progress, std::string_view name, std::size_t total) : progress_(progress), name_(name), total_(total) {}
    /// False: stop.
    bool step() {
        const std::size_t done = done_.fetch_add(1) + 1;
        const auto now = std::chrono::steady_clock::now();
        if (mutex_.try_lock()) {
            if (now - last_update_ > std::chrono::milliseconds(100) || done == total_) {
                last_update_ = now;
                progress_.update(name_, static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, total_)));
            }
            mutex_.unlock();
        }
        return !progress_.stopped();
    }

private:
    const Progress& progress_;
    std::string_view name_;
    std::size_t total_;
    std::atomic<std::size_t> done_{0};
    Mutex mutex_;
    std::chrono::steady_clock::time_point last_update_ GUARDED_BY(mutex_){};
};

}  // namespace surefoot::bake
