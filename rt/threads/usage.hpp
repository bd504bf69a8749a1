// Resource usage of threads: CPU time, faults, context switches; and steal time of the host. Plain numbers.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::rt {

/// Usage of one thread since it started, or the difference of two readings.
struct ThreadUsage {
    std::int64_t cpu_ns = 0;
    std::uint64_t minor_faults = 0, major_faults = 0;
    std::uint64_t voluntary = 0, involuntary = 0;  ///< context switches
};

constexpr ThreadUsage operator-(const ThreadUsage& after, const ThreadUsage& before) {
    return {after.cpu_ns - before.cpu_ns, after.minor_faults - before.minor_faults, after.major_faults - before.major_faults,
            after.voluntary - before.voluntary, after.involuntary - before.involuntary};
}
constexpr ThreadUsage operator+(const ThreadUsage& a, const ThreadUsage& b) {
    return {a.cpu_ns + b.cpu_ns, a.minor_faults + b.minor_faults, a.major_faults + b.major_faults, a.voluntary + b.voluntary,
            a.involuntary + b.involuntary};
}

/// The calling thread's, by two system calls (about 1 us).
ThreadUsage read_own_usage();
/// The calling thread's CPU time.
std::int64_t own_cpu_ns();
/// CPU time of any thread of this process; -1 when there is no such thread.
std::int64_t thread_cpu_ns(pid_t tid);

/// CPU time of a set of threads (the driver's rasterisers), read by the frame thread without allocating.
class ThreadClocks {
public:
    static constexpr std::size_t capacity = 64;
    ThreadClocks() = default;
    /// Threads beyond the capacity are left out.
    explicit ThreadClocks(std::span<const pid_t> tids);
    [[nodiscard]] std::size_t size() const { return count_; }
    /// Starts a measurement.
    void start();
    /// CPU time since start().
    struct Spent {
        std::int64_t sum_ns = 0;      ///< over all threads
        std::int64_t longest_ns = 0;  ///< of the busiest
    };
    /// Since start(). Threads that have ended count 0.
    [[nodiscard]] Spent spent() const;

private:
    std::array<pid_t, capacity> tids_{};
    std::array<std::int64_t, capacity> started_ns_{};
    std::size_t count_ = 0;
};

/// Time that the host took while this guest wanted to run, since boot (/proc/stat; steps of one tick, 10 ms).
struct Steal {
    double total_ms = 0;
    std::vector<double> cpu_ms;  ///< by CPU number; offline CPUs are 0
};
/// root: where /proc lies, for tests.
Result<Steal> read_steal(const std::string& root = "");

}  // namespace surefoot::rt
