// Placement of threads of this process: policy, priority, cores, name; and restoring it.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::rt {

enum class Policy : std::uint8_t { other, fifo, round_robin, batch, idle, deadline };
std::string_view policy_name(Policy policy);

/// A set of CPU numbers below 1024. As an argument, an empty mask means "any".
class CpuMask {
public:
    CpuMask() { CPU_ZERO(&set_); }
    CpuMask(std::initializer_list<int> cpus) : CpuMask() {
        for (const int cpu : cpus) add(cpu);
    }
    explicit CpuMask(const cpu_set_t& set) : set_(set) {}
    /// Reads "0-2,5" (/sys/devices/system/cpu); empty text is the empty mask.
    static Result<CpuMask> parse(std::string_view text);

    void add(int cpu) {
        if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(cpu, &set_);
    }
    [[nodiscard]] bool has(int cpu) const { return cpu >= 0 && cpu < CPU_SETSIZE && CPU_ISSET(cpu, &set_); }
    [[nodiscard]] int count() const { return CPU_COUNT(&set_); }
    [[nodiscard]] bool empty() const { return count() == 0; }
    [[nodiscard]] std::vector<int> cpus() const;
    [[nodiscard]] std::string text() const;  ///< "0-2,5"
    [[nodiscard]] const cpu_set_t& native() const { return set_; }
    friend bool operator==(const CpuMask& a, const CpuMask& b) { return CPU_EQUAL(&a.set_, &b.set_); }

private:
    cpu_set_t set_;
};

/// The CPUs that this process may use, by the affinity of its main thread.
CpuMask allowed_cpus();

/// Where a thread runs: policy, priority and cores.
struct Placement {
    Policy policy = Policy::other;  ///< deadline is refused
    int priority = 0;               ///< 1 to 99 for fifo and round_robin, else 0
    CpuMask cpus;                   ///< empty: leave as is
    std::string name;               ///< empty: leave as is; at most 15 bytes are kept
    bool reset_on_fork = true;      ///< threads made by this one start at SCHED_OTHER (they still inherit its cores)
};

/// tid 0: the calling thread. Sets cores, then policy, then name. Errors name the refused part and how to grant it.
Result<void> place_thread(pid_t tid, const Placement& placement);
pid_t own_tid();

/// One thread as the kernel has it.
struct ThreadInfo {
    pid_t tid = 0;
    std::string name;
    Policy policy = Policy::other;
    int priority = 0;
    bool reset_on_fork = false;
    CpuMask cpus;
};
Result<ThreadInfo> read_thread(pid_t tid);
/// All threads of this process by rising tid (/proc/self/task); those that end meanwhile are left out.
Result<std::vector<ThreadInfo>> read_threads();

/// Places every thread whose name starts with `prefix`; returns their tids (may be empty).
Result<std::vector<pid_t>> place_by_prefix(std::string_view prefix, const Placement& placement);
/// The same, one a core: the i-th thread (by tid) on cores[i mod n]. placement.cpus is not used.
Result<std::vector<pid_t>> spread_by_prefix(std::string_view prefix, const Placement& placement, std::span<const int> cores);

/// Puts a thread back as it was read (policy, priority, cores, name).
Result<void> restore_thread(const ThreadInfo& before);

/// Puts the calling thread back when the scope ends; a failure to do so is silent (the thread may be ending).
class PlacementScope {
public:
    PlacementScope();
    ~PlacementScope();
    PlacementScope(const PlacementScope&) = delete;
    PlacementScope& operator=(const PlacementScope&) = delete;

private:
    Result<ThreadInfo> before_;
};

}  // namespace surefoot::rt
