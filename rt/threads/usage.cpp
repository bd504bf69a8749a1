// What a thread has used, from clock_gettime and getrusage; steal from /proc/stat.
#include "rt/threads/usage.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>

namespace surefoot::rt {

namespace {
std::int64_t clock_ns(clockid_t clock) {
    timespec t{};
    if (clock_gettime(clock, &t) != 0) return 0;
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}
}  // namespace

std::int64_t own_cpu_ns() { return clock_ns(CLOCK_THREAD_CPUTIME_ID); }

// The kernel's encoding of a thread's CPU clock (MAKE_THREAD_CPUCLOCK with CPUCLOCK_SCHED): driver threads have no
// pthread_t that we could ask pthread_getcpuclockid for.
std::int64_t thread_cpu_ns(pid_t tid) {
    constexpr int per_thread = 4, sched = 2;
    return clock_ns(static_cast<clockid_t>((~static_cast<unsigned>(tid) << 3U) | per_thread | sched));
}

ThreadUsage own_usage() {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    ThreadUsage out;
    out.cpu_ns = own_cpu_ns();
    out.minor_faults = static_cast<std::uint64_t>(usage.ru_minflt);
    out.major_faults = static_cast<std::uint64_t>(usage.ru_majflt);
    out.voluntary = static_cast<std::uint64_t>(usage.ru_nvcsw);
    out.involuntary = static_cast<std::uint64_t>(usage.ru_nivcsw);
    return out;
}

ThreadUsage operator-(const ThreadUsage& a, const ThreadUsage& b) {
    return {a.cpu_ns - b.cpu_ns, a.minor_faults - b.minor_faults, a.major_faults - b.major_faults, a.voluntary - b.voluntary,
            a.involuntary - b.involuntary};
}

double host_steal_ms() {
    std::FILE* stat = std::fopen("/proc/stat", "re");
    if (stat == nullptr) return 0;
    unsigned long long user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
    const int read = std::fscanf(stat, "cpu %llu %llu %llu %llu %llu %llu %llu %llu", &user, &nice, &system, &idle, &iowait, &irq, &softirq, &steal);
    std::fclose(stat);
    if (read != 8) return 0;
    return static_cast<double>(steal) * 1000.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace surefoot::rt
