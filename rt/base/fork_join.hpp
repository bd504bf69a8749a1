// Says to the thread sanitizer what it cannot see: oneTBB is not built with it, so it knows neither that a task begins after what
// was written before the loop, nor that the loop ends after its tasks. In other builds all of it is nothing.
#pragma once

#ifdef SUREFOOT_WATCHES_THREADS
#include <sanitizer/tsan_interface.h>
#endif

namespace surefoot {

/// One of each parallel loop: made before it, joined() after it, and in every task a `Task` for as long as it runs.
class ForkJoin {
public:
    ForkJoin() { release(); }
    void joined() { acquire(); }

    class Task {
    public:
        explicit Task(ForkJoin& loop) : loop_(loop) { loop_.acquire(); }
        ~Task() { loop_.release(); }
        Task(const Task&) = delete;
        Task& operator=(const Task&) = delete;

    private:
        ForkJoin& loop_;
    };

private:
#ifdef SUREFOOT_WATCHES_THREADS
    void acquire() { __tsan_acquire(this); }
    void release() { __tsan_release(this); }
#else
    void acquire() {}
    void release() {}
#endif
};

}  // namespace surefoot
