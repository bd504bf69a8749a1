// Threads put in their places through the kernel's thread ids, so that the driver's threads can be placed like our own.
#include "rt/threads/placement.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot::rt {

namespace {

constexpr std::size_t longest_name = 15;  // the kernel's TASK_COMM_LEN less the final zero

int native(Policy policy) {
    switch (policy) {
        case Policy::fifo:
            return SCHED_FIFO;
        case Policy::round_robin:
            return SCHED_RR;
        case Policy::batch:
            return SCHED_BATCH;
        case Policy::idle:
            return SCHED_IDLE;
        case Policy::deadline:
        case Policy::other:
            break;
    }
    return SCHED_OTHER;
}

Policy policy_of(int number) {
    switch (number) {
        case SCHED_FIFO:
            return Policy::fifo;
        case SCHED_RR:
            return Policy::round_robin;
        case SCHED_BATCH:
            return Policy::batch;
        case SCHED_IDLE:
            return Policy::idle;
        case 6:
            return Policy::deadline;  // SCHED_DEADLINE
        default:
            return Policy::other;
    }
}

std::string place_of(pid_t tid) { return fmt::format("thread {}", tid); }

Error refused(pid_t tid, const std::string& what, int error, const std::string& remedy, ErrorKind kind) {
    return {place_of(tid), fmt::format("{}: {}", what, std::strerror(error)), remedy, kind};  // NOLINT(concurrency-mt-unsafe)
}

std::string comm_file(pid_t tid) { return fmt::format("/proc/self/task/{}/comm", tid); }

Result<void> name_thread(pid_t tid, const std::string& name) {
    // Not through write_text(), which replaces files: this one belongs to the kernel.
    const int file = ::open(comm_file(tid).c_str(), O_WRONLY | O_CLOEXEC);
    const std::string kept = name.substr(0, longest_name);
    const bool written = file >= 0 && ::write(file, kept.data(), kept.size()) == static_cast<ssize_t>(kept.size());
    const int error = errno;
    if (file >= 0) ::close(file);
    if (!written)
        return refused(tid, fmt::format("The thread cannot be named '{}'", kept), error,
                       "Check that this process may write to /proc", ErrorKind::failed);
    return {};
}

Result<void> set_cores(pid_t tid, const CpuMask& cpus) {
    if (sched_setaffinity(tid, sizeof(cpu_set_t), &cpus.native()) == 0) return {};
    return refused(tid, fmt::format("The thread cannot run on cores {}", cpus.text()), errno,
                   fmt::format("Choose among the cores of this process: {}", allowed_cpus().text()), ErrorKind::no_real_time);
}

Result<void> set_policy(pid_t tid, Policy policy, int priority, bool reset_on_fork) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    if (sched_setscheduler(tid, native(policy) | (reset_on_fork ? SCHED_RESET_ON_FORK : 0), &parameters) == 0) return {};
    // Without privilege the flag cannot be taken away again, but the rest can change.
    if (!reset_on_fork && errno == EPERM && sched_setscheduler(tid, native(policy) | SCHED_RESET_ON_FORK, &parameters) == 0)
        return {};
    return refused(tid, fmt::format("{} priority {} is refused", policy_name(policy), priority), errno,
                   fmt::format("Grant CAP_SYS_NICE, or RLIMIT_RTPRIO of at least {} (LimitRTPRIO= in the unit)", priority),
                   ErrorKind::no_real_time);
}

}  // namespace

std::string_view policy_name(Policy policy) {
    switch (policy) {
        case Policy::fifo:
            return "SCHED_FIFO";
        case Policy::round_robin:
            return "SCHED_RR";
        case Policy::batch:
            return "SCHED_BATCH";
        case Policy::idle:
            return "SCHED_IDLE";
        case Policy::deadline:
            return "SCHED_DEADLINE";
        case Policy::other:
            break;
    }
    return "SCHED_OTHER";
}

Result<CpuMask> CpuMask::parse(std::string_view text) {
    CpuMask mask;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    while (!text.empty()) {
        const std::string_view part = text.substr(0, text.find(','));
        int first = 0;
        const char* const end = part.data() + part.size();
        auto read = std::from_chars(part.data(), end, first);
        int last = first;
        if (read.ec == std::errc{} && read.ptr != end && *read.ptr == '-') read = std::from_chars(read.ptr + 1, end, last);
        if (read.ec != std::errc{} || read.ptr != end || first < 0 || last < first || last >= CPU_SETSIZE)
            return Error{"list of cores", fmt::format("The part '{}' is not understood", part), "Write a list such as 0-2,5",
                         ErrorKind::misuse};
        for (int cpu = first; cpu <= last; ++cpu) mask.add(cpu);
        text.remove_prefix(std::min(part.size() + 1, text.size()));
    }
    return mask;
}

std::vector<int> CpuMask::cpus() const {
    std::vector<int> list;
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (has(cpu)) list.push_back(cpu);
    }
    return list;
}

std::string CpuMask::text() const {
    std::string text;
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (!has(cpu)) continue;
        int last = cpu;
        while (has(last + 1)) ++last;
        if (!text.empty()) text += ',';
        text += last == cpu ? fmt::format("{}", cpu) : fmt::format("{}-{}", cpu, last);
        cpu = last;
    }
    return text;
}

CpuMask allowed_cpus() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(getpid(), sizeof(set), &set) != 0) return {};
    return CpuMask(set);
}

pid_t own_tid() { return static_cast<pid_t>(syscall(SYS_gettid)); }

Result<void> place_thread(pid_t tid, const Placement& placement) {
    if (tid == 0) tid = own_tid();
    const bool real_time = placement.policy == Policy::fifo || placement.policy == Policy::round_robin;
    if (placement.policy == Policy::deadline || (real_time && (placement.priority < 1 || placement.priority > 99)) ||
        (!real_time && placement.priority != 0))
        return Error{place_of(tid),
                     fmt::format("{} priority {} does not exist", policy_name(placement.policy), placement.priority),
                     "Use 1 to 99 for SCHED_FIFO and SCHED_RR, else 0", ErrorKind::misuse};
    if (!placement.cpus.empty()) {
        if (auto set = set_cores(tid, placement.cpus); !set) return set;
    }
    if (auto set = set_policy(tid, placement.policy, placement.priority, placement.reset_on_fork); !set) return set;
    return placement.name.empty() ? Result<void>{} : name_thread(tid, placement.name);
}

Result<ThreadInfo> read_thread(pid_t tid) {
    if (tid == 0) tid = own_tid();
    ThreadInfo info;
    info.tid = tid;
    auto name = read_text(comm_file(tid), 64);
    if (!name) return name.error();
    info.name = *name;
    if (!info.name.empty() && info.name.back() == '\n') info.name.pop_back();
    const int policy = sched_getscheduler(tid);
    sched_param parameters{};
    cpu_set_t set;
    CPU_ZERO(&set);
    if (policy < 0 || sched_getparam(tid, &parameters) != 0 || sched_getaffinity(tid, sizeof(set), &set) != 0)
        return refused(tid, "The thread cannot be examined", errno, "Check the system-call filter of this process",
                       ErrorKind::failed);
    info.policy = policy_of(policy & ~SCHED_RESET_ON_FORK);
    info.reset_on_fork = (policy & SCHED_RESET_ON_FORK) != 0;
    info.priority = parameters.sched_priority;
    info.cpus = CpuMask(set);
    return info;
}

Result<std::vector<ThreadInfo>> read_threads() {
    struct Close {
        void operator()(DIR* dir) const { ::closedir(dir); }
    };
    const std::unique_ptr<DIR, Close> tasks(::opendir("/proc/self/task"));
    if (!tasks)
        return Error{"/proc/self/task",
                     fmt::format("The folder cannot be read: {}", std::strerror(errno)),  // NOLINT(concurrency-mt-unsafe)
                     "Check that /proc is mounted", ErrorKind::unreadable};
    std::vector<ThreadInfo> threads;
    while (const dirent* entry = ::readdir(tasks.get())) {  // NOLINT(concurrency-mt-unsafe): this stream is ours alone
        const std::string_view name = entry->d_name;
        const auto tid = number_in<pid_t>(name);
        if (!tid) continue;
        if (auto info = read_thread(*tid)) threads.push_back(std::move(*info));
    }
    std::ranges::sort(threads, {}, &ThreadInfo::tid);
    return threads;
}

Result<std::vector<pid_t>> spread_by_prefix(std::string_view prefix, const Placement& placement, std::span<const int> cores) {
    const auto threads = read_threads();
    if (!threads) return threads.error();
    std::vector<pid_t> placed;
    for (const ThreadInfo& thread : *threads) {
        if (!thread.name.starts_with(prefix)) continue;
        Placement own = placement;
        if (!cores.empty()) own.cpus = CpuMask{cores[placed.size() % cores.size()]};
        if (auto done = place_thread(thread.tid, own); !done) return done.error();
        placed.push_back(thread.tid);
    }
    return placed;
}

Result<std::vector<pid_t>> place_by_prefix(std::string_view prefix, const Placement& placement) {
    return spread_by_prefix(prefix, placement, {});
}

Result<void> restore_thread(const ThreadInfo& before) {
    if (auto done = set_policy(before.tid, before.policy, before.priority, before.reset_on_fork); !done) return done;
    if (auto done = set_cores(before.tid, before.cpus); !done) return done;
    return name_thread(before.tid, before.name);
}

PlacementScope::PlacementScope() : before_(read_thread(0)) {}

PlacementScope::~PlacementScope() {
    if (before_) (void)restore_thread(*before_);
}

}  // namespace surefoot::rt
