// Places the workers of preparation (core, policy, priority). Each is placed when it starts, and checked within its first task.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/prepare/prepared.hpp"
#include "rt/base/mutex.hpp"
#include "rt/threads/placement.hpp"
#include "tools/walk/placing.hpp"

namespace surefoot::walk {

/// Gives the calling thread the workers' place and priority while this lives. A thread of lower priority that starts or ends the
/// workers may lose its core to them. Idle workers spin, so on few cores it would wait long.
class ScopedWorkerPriority {
public:
    explicit ScopedWorkerPriority(const PlacingPlan& plan);

private:
    const rt::PlacementScope back_;
};

/// The workers' places, as they start. Must outlive the engine that its hooks are given to. Any thread may call it.
class WorkerPlaces {
public:
    explicit WorkerPlaces(PlacingPlan plan) : plan_(std::move(plan)) {}
    [[nodiscard]] prepare::WorkerHooks hooks();

    /// The first error of placing a worker.
    [[nodiscard]] std::optional<Error> refused() const EXCLUDES(mutex_);
    /// Workers that were not in their places within their first tasks: a line for each, as the census writes it.
    [[nodiscard]] std::vector<std::string> problems() const EXCLUDES(mutex_);

private:
    void start(int number) EXCLUDES(mutex_);
    void look() EXCLUDES(mutex_);

    const PlacingPlan plan_;
    mutable Mutex mutex_;  ///< workers start side by side
    std::optional<Error> refused_ GUARDED_BY(mutex_);
    std::vector<rt::ThreadInfo> at_work_ GUARDED_BY(mutex_);
};

}  // namespace surefoot::walk
