// Tells the thread sanitizer the order of a parallel loop: tasks start after the code before it, and end before the code after
// it. It cannot see that, because oneTBB is not built with it. Empty in other builds.
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

    /// One task of the loop: made when it starts, destroyed when it ends.
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
