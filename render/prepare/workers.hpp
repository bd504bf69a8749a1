// The workers of preparation: a oneTBB arena of fixed size. With hooks, all threads start at once and are announced first.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// Owns the arena and its threads. Made, used and destroyed by one thread.
class Workers {
public:
    /// `count`: workers with the caller; 1: no threads. With hooks all threads start here, else at first use.
    Workers(int count, WorkerHooks hooks);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    /// Null if the caller is the only worker.
    [[nodiscard]] tbb::task_arena* arena() { return arena_ ? &*arena_ : nullptr; }

    /// Ends the threads. The caller is the only worker from now on.
    void end();

private:
    class Observer final : public tbb::task_scheduler_observer {
    public:
        Observer(tbb::task_arena& arena, const WorkerHooks& hooks, int max_workers);
        ~Observer() override { observe(false); }
        Observer(const Observer&) = delete;
        Observer& operator=(const Observer&) = delete;
        void on_scheduler_entry(bool is_worker) override;

    private:
        const WorkerHooks& hooks_;
        const int max_workers_;
        const std::uint64_t id_;
        std::atomic<int> started_{0};
    };
    void start_all(int workers);

    WorkerHooks hooks_;
    tbb::task_scheduler_handle handle_;                   ///< with hooks: ends the threads with this object
    std::optional<tbb::global_control> more_than_cores_;  ///< raises oneTBB's own cap on threads, which it reports on stderr
    std::optional<tbb::task_arena> arena_;
    std::optional<Observer> observer_;
};

}  // namespace surefoot::prepare
