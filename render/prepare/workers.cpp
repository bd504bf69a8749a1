// Starts the workers, announces them, and ends them.
#include "render/prepare/workers.hpp"

#include <chrono>
#include <memory>
#include <new>

#include <tbb/info.h>

#include "rt/base/check.hpp"
#include "rt/base/fork_join.hpp"
#include "rt/base/mutex.hpp"

namespace surefoot::prepare {

namespace {

constexpr auto start_within = std::chrono::seconds(2);  // threads that are not there by then are refused by the system

/// A barrier: a known number of workers wait for each other, and one other thread waits for all of them. Until a deadline at
/// most.
class Meeting {
public:
    explicit Meeting(int workers) : missing_(workers) {}
    void arrive() {
        const MutexLock lock(mutex_);
        --missing_;
        changed_.notify_all();
        wait_for_all();
    }
    void wait() {
        const MutexLock lock(mutex_);
        wait_for_all();
    }

private:
    void wait_for_all() REQUIRES(mutex_) {
        while (missing_ > 0 && changed_.wait_until(mutex_, deadline_)) {
        }
    }
    const std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::now() + start_within;
    Mutex mutex_;
    Condition changed_;
    int missing_ GUARDED_BY(mutex_);
};

/// Numbers observers, so that each thread is announced once to each observer. Threads outlive arenas and may come back.
std::uint64_t next_id() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace

Workers::Observer::Observer(tbb::task_arena& arena, const WorkerHooks& hooks, int max_workers)
    : task_scheduler_observer(arena), hooks_(hooks), max_workers_(max_workers), id_(next_id()) {
    observe(true);
}

void Workers::Observer::on_scheduler_entry(bool is_worker) {
    thread_local std::uint64_t registered_with = 0;
    if (!is_worker || registered_with == id_) return;
    registered_with = id_;
    const int number = ++started_;
    (void)CHECK_RARE(number <= max_workers_, "An arena has no more workers than requested");
    if (hooks_.on_start) hooks_.on_start(number);
}

Workers::Workers(int count, WorkerHooks hooks) : hooks_(std::move(hooks)) {
    if (count <= 1) return;
    if (hooks_.any()) handle_ = tbb::task_scheduler_handle(tbb::attach{});
    if (count > tbb::info::default_concurrency())
        more_than_cores_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
    arena_.emplace(count);
    if (!hooks_.any()) return;
    arena_->initialize();
    observer_.emplace(*arena_, hooks_, count - 1);
    start_all(count - 1);
}

Workers::~Workers() { end(); }

void Workers::end() {
    observer_.reset();
    arena_.reset();
    more_than_cores_.reset();
    // Else they would wait, still in their places, for a next walk that may want fewer. False where others use the library too.
    if (handle_) (void)tbb::finalize(handle_, std::nothrow);
    handle_ = {};
}

/// As many tasks as workers, none of which ends before all have begun: so each worker has one. They lie ready before a worker
/// comes and the caller sleeps meanwhile: workers that look for work would keep it from its core, where they go before it.
void Workers::start_all(int workers) {
    struct Start {
        Start(int count, std::function<void()> hook) : meeting(count), on_first_task(std::move(hook)) {}
        Meeting meeting;
        std::function<void()> on_first_task;
        ForkJoin loop;
    };
    const auto start = std::make_shared<Start>(workers, hooks_.on_first_task);  // a late worker may outlast this call
    for (int i = 0; i < workers; ++i) {
        arena_->enqueue([start] {
            const ForkJoin::Task task(start->loop);
            if (start->on_first_task) start->on_first_task();
            start->meeting.arrive();
        });
    }
    start->meeting.wait();
    start->loop.joined();
}

}  // namespace surefoot::prepare
