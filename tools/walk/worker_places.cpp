// Workers, one by one.
#include "tools/walk/worker_places.hpp"

#include "rt/threads/census.hpp"

namespace surefoot::walk {

ScopedWorkerPriority::ScopedWorkerPriority(const PlacingPlan& plan) {
    rt::Placement placement = prepare_placement(plan);
    placement.name.clear();
    (void)rt::place_thread(0, placement);  // where that is refused, the workers are not above it either
}

prepare::WorkerHooks WorkerPlaces::hooks() {
    return {.on_start = [this](int number) { start(number); }, .on_first_task = [this] { look(); }};
}

void WorkerPlaces::start(int number) {
    const rt::Placement wanted = worker_placement(plan_, number);
    const auto placed = rt::place_thread(0, wanted);
    if (placed) return;
    // By its name the census finds it where it is.
    (void)rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = wanted.cpus, .name = wanted.name});
    const MutexLock lock(mutex_);
    if (!refused_) refused_ = placed.error();
}

void WorkerPlaces::look() {
    auto found = rt::read_thread(0);
    if (!found) return;
    const MutexLock lock(mutex_);
    at_work_.push_back(std::move(*found));
}

std::optional<Error> WorkerPlaces::refused() const {
    const MutexLock lock(mutex_);
    return refused_;
}

std::vector<std::string> WorkerPlaces::problems() const {
    const MutexLock lock(mutex_);
    std::vector<std::string> problems = rt::census(worker_rows(plan_), at_work_);
    for (std::string& problem : problems) problem.insert(0, "first task of a worker: ");
    return problems;
}

}  // namespace surefoot::walk
