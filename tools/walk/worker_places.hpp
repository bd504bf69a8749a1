// The preparation's workers in their places: put there as each starts, before its first task, and looked at within that task.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/prepare/prepared.hpp"
#include "rt/base/mutex.hpp"
#include "rt/threads/placement.hpp"
#include "tools/walk/placing.hpp"

namespace surefoot::walk {

/// The calling thread among the workers, at their priority, while this lives. Whoever hands them work or ends them and stood
/// below them would wait for his core while they look for work, which on a machine of few cores is long.
class ScopedWorkerPriority {
public:
    explicit ScopedWorkerPriority(const PlacingPlan& plan);

private:
    const rt::PlacementScope back_;
};

/// Must outlive the engine that its hooks are given to.
class WorkerPlaces {
public:
    explicit WorkerPlaces(PlacingPlan plan) : plan_(std::move(plan)) {}
    [[nodiscard]] prepare::WorkerHooks hooks();

    /// What kept a worker from its place: the first refusal.
    [[nodiscard]] std::optional<Error> refused() const EXCLUDES(mutex_);
    /// Workers that were not in their places within their first tasks; in the census's words.
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
