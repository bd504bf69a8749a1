// Usage read from the kernel: two system calls for the own thread, one for another's CPU time, /proc/stat for steal.
#include "rt/threads/usage.hpp"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot::rt {

namespace {

std::int64_t read_clock_ns(clockid_t id) {
    timespec t{};
    if (clock_gettime(id, &t) != 0) return -1;
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

/// The kernel's number for "CPU time of thread tid" (include/linux/posix-timers.h: CPUCLOCK_SCHED | CPUCLOCK_PERTHREAD_MASK),
/// as pthread_getcpuclockid() makes it, for threads whose pthread_t is not ours (the driver's).
clockid_t cpu_clock_of(pid_t tid) { return static_cast<clockid_t>((~static_cast<unsigned>(tid) << 3U) | 6U); }

/// The n-th (from 0) number of a /proc/stat line after its name; 0 when there are fewer.
std::uint64_t number_at(std::string_view line, int n) {
    for (int i = 0;; ++i) {
        const auto space = line.find(' ');
        if (space == std::string_view::npos) return 0;
        line.remove_prefix(std::min(line.find_first_not_of(' ', space), line.size()));
        if (i == n) return leading_number<std::uint64_t>(line, 0);
    }
}

}  // namespace

std::int64_t own_cpu_ns() { return read_clock_ns(CLOCK_THREAD_CPUTIME_ID); }

std::int64_t thread_cpu_ns(pid_t tid) { return read_clock_ns(cpu_clock_of(tid)); }

ThreadUsage read_own_usage() {
    rusage r{};
    getrusage(RUSAGE_THREAD, &r);
    ThreadUsage usage;
    // rusage's own times are rounded to ticks on some kernels: the clock is exact.
    usage.cpu_ns = own_cpu_ns();
    usage.minor_faults = static_cast<std::uint64_t>(r.ru_minflt);
    usage.major_faults = static_cast<std::uint64_t>(r.ru_majflt);
    usage.voluntary = static_cast<std::uint64_t>(r.ru_nvcsw);
    usage.involuntary = static_cast<std::uint64_t>(r.ru_nivcsw);
    return usage;
}

ThreadClocks::ThreadClocks(std::span<const pid_t> tids) : count_(std::min(tids.size(), capacity)) {
    std::copy_n(tids.begin(), count_, tids_.begin());
    start();
}

void ThreadClocks::start() {
    for (std::size_t i = 0; i < count_; ++i) started_ns_[i] = thread_cpu_ns(tids_[i]);
}

ThreadClocks::Spent ThreadClocks::spent() const {
    Spent spent;
    for (std::size_t i = 0; i < count_; ++i) {
        const std::int64_t now = thread_cpu_ns(tids_[i]);
        const std::int64_t used = now < 0 || started_ns_[i] < 0 ? 0 : now - started_ns_[i];
        spent.sum_ns += used;
        spent.longest_ns = std::max(spent.longest_ns, used);
    }
    return spent;
}

Result<Steal> read_steal(const std::string& root) {
    const std::string place = root + "/proc/stat";
    const auto text = read_text(place);
    if (!text) return text.error();
    const double ms_per_tick = 1000.0 / static_cast<double>(sysconf(_SC_CLK_TCK));
    constexpr int steal_column = 7;  // user nice system idle iowait irq softirq steal
    Steal steal;
    bool found = false;
    std::string_view rest = *text;
    while (rest.starts_with("cpu")) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        const double ms = static_cast<double>(number_at(line, steal_column)) * ms_per_tick;
        if (line.starts_with("cpu ")) {
            steal.total_ms = ms;
            found = true;
            continue;
        }
        std::size_t cpu = 0;
        const auto [end, error] = std::from_chars(line.data() + 3, line.data() + line.size(), cpu);
        if (error != std::errc{} || cpu >= 65536) continue;
        if (steal.cpu_ms.size() <= cpu) steal.cpu_ms.resize(cpu + 1, 0.0);
        steal.cpu_ms[cpu] = ms;
    }
    if (!found) return Error{place, "The file has no line of CPU times", "Check that /proc is mounted", ErrorKind::damaged};
    return steal;
}

}  // namespace surefoot::rt
