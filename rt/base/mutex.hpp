// A mutex, its scope and its condition, annotated for -Wthread-safety (the standard library's are not).
#pragma once

#include <condition_variable>
#include <mutex>

#include "rt/base/thread_annotations.hpp"

namespace surefoot {

class CAPABILITY("mutex") Mutex {
public:
    void lock() ACQUIRE() { mutex_.lock(); }
    void unlock() RELEASE() { mutex_.unlock(); }
    bool try_lock() TRY_ACQUIRE(true) { return mutex_.try_lock(); }

private:
    std::mutex mutex_;
};

/// Locks a Mutex while it lives.
class SCOPED_CAPABILITY MutexLock {
public:
    explicit MutexLock(Mutex& mutex) ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
    ~MutexLock() RELEASE() { mutex_.unlock(); }
    MutexLock(const MutexLock&) = delete;
    MutexLock& operator=(const MutexLock&) = delete;

private:
    Mutex& mutex_;
};

/// Releases the mutex, waits, and locks it again. It may return without a cause, so test the condition again.
class Condition {
public:
    void notify_all() { condition_.notify_all(); }
    /// False: the deadline has passed.
    template <class TimePoint>
    bool wait_until(Mutex& mutex, const TimePoint& deadline) REQUIRES(mutex) NO_THREAD_SAFETY_ANALYSIS {
        return condition_.wait_until(mutex, deadline) == std::cv_status::no_timeout;
    }

private:
    std::condition_variable_any condition_;
};

}  // namespace surefoot
