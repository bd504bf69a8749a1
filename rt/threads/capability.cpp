// What the machine grants, found by trying where trying is harmless, and by reading limits, /proc and /sys elsewhere.
#include "rt/threads/capability.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "rt/threads/memory.hpp"

namespace surefoot::rt {

namespace {

constexpr std::int64_t lock_enough_bytes = 1LL << 30;

std::string first_line(const std::string& file) {
    auto text = read_text(file, 1U << 20U);
    return text ? text->substr(0, text->find('\n')) : std::string{};
}

std::int64_t number_of(const std::string& file, std::int64_t otherwise) { return leading_number(first_line(file), otherwise); }

/// On a thread of its own, so that the caller's placing is not touched.
bool fifo_granted(int priority) {
    bool granted = false;
    std::thread([&] {
        granted = place_thread(0, {.policy = Policy::fifo, .priority = priority, .cpus = {}, .name = {}}).ok();
    }).join();
    return granted;
}

/// isolcpus= takes its cores from the first process's mask, and so from everybody's, yet every thread may ask for one.
bool core_granted(int cpu) {
    bool granted = false;
    std::thread([&] {
        granted = place_thread(0, {.policy = Policy::other, .priority = 0, .cpus = CpuMask{cpu}, .name = {}}).ok();
    }).join();
    return granted;
}

int highest_fifo(int wanted) {
    if (fifo_granted(wanted)) return wanted;
    rlimit limit{};
    getrlimit(RLIMIT_RTPRIO, &limit);
    const int allowed = static_cast<int>(std::min<rlim_t>(limit.rlim_cur, 99));
    return allowed >= 1 && allowed < wanted && fifo_granted(allowed) ? allowed : 0;
}

std::int64_t soft_limit(__rlimit_resource_t resource) {
    rlimit limit{};
    getrlimit(resource, &limit);
    return limit.rlim_cur == RLIM_INFINITY ? -1 : static_cast<std::int64_t>(limit.rlim_cur);
}

std::string fifo_remedy(int wanted) {
    return fmt::format(
        "Grant CAP_SYS_NICE, or RLIMIT_RTPRIO of at least {} (LimitRTPRIO={} in the unit). "
        "As root, check that the cgroup's cpu.rt_runtime_us is not 0",
        wanted, wanted);
}

void raise(__rlimit_resource_t resource, rlim_t wanted) {
    rlimit limit{};
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur >= wanted) return;
    const rlimit privileged{wanted, std::max(limit.rlim_max, wanted)};
    if (setrlimit(resource, &privileged) == 0) return;
    limit.rlim_cur = std::min(limit.rlim_max, wanted);
    setrlimit(resource, &limit);
}

}  // namespace

CpuMask isolated_cpus(const CpuMask& allowed, const std::string& root) {
    CpuMask isolated;
    if (auto listed = CpuMask::parse(first_line(root + "/sys/devices/system/cpu/isolated"))) {
        for (const int cpu : listed->cpus()) {
            if (allowed.has(cpu) || core_granted(cpu)) isolated.add(cpu);
        }
    }
    return isolated;
}

int default_frame_core(const CpuMask& allowed, const CpuMask& isolated) {
    const std::vector<int> all = allowed.cpus(), kept_free = isolated.cpus();
    if (!kept_free.empty()) return kept_free.back();
    return all.empty() ? -1 : all.back();
}

Capabilities probe_capabilities(int wanted_priority, const std::string& root) {
    Capabilities c;
    c.fifo_priority = highest_fifo(wanted_priority);
    c.memlock_bytes = lock_unlimited() ? -1 : soft_limit(RLIMIT_MEMLOCK);
    c.can_lock = c.memlock_bytes < 0 || c.memlock_bytes >= lock_enough_bytes;
    c.rttime_us = soft_limit(RLIMIT_RTTIME);
    c.allowed = allowed_cpus();
    c.isolated = isolated_cpus(c.allowed, root);
    c.rt_runtime_us = number_of(root + "/proc/sys/kernel/sched_rt_runtime_us", -1);
    c.rt_period_us = number_of(root + "/proc/sys/kernel/sched_rt_period_us", 1'000'000);
    c.preempt_rt = number_of(root + "/sys/kernel/realtime", 0) == 1;
    const auto processor = read_text(root + "/proc/cpuinfo", 1U << 24U);
    c.virtual_machine = processor && processor->find(" hypervisor") != std::string::npos;
    c.lacking = find_lacking(c, wanted_priority);
    return c;
}

std::vector<Lack> find_lacking(const Capabilities& c, int wanted_priority) {
    std::vector<Lack> lacking;
    if (c.fifo_priority == 0) {
        lacking.push_back({LackKind::fifo, "SCHED_FIFO is refused", fifo_remedy(wanted_priority)});
    } else if (c.fifo_priority < wanted_priority) {
        lacking.push_back(
            {LackKind::fifo,
             fmt::format("SCHED_FIFO is granted only up to priority {}; {} is wanted", c.fifo_priority, wanted_priority),
             fifo_remedy(wanted_priority)});
    }
    if (!c.can_lock) {
        lacking.push_back({LackKind::memory_lock, fmt::format("Memory cannot be locked beyond {} MiB", c.memlock_bytes >> 20),
                           "Grant CAP_IPC_LOCK, or RLIMIT_MEMLOCK unlimited (LimitMEMLOCK=infinity in the unit)"});
    }
    if (c.isolated.empty()) {
        lacking.push_back(
            {LackKind::isolated_core, "No core is isolated among " + c.allowed.text(),
             c.allowed.count() < 2
                 ? "Give this process a second core, and isolate one of them"
                 : fmt::format("Boot with isolcpus=managed_irq,domain,{0} nohz_full={0}, or make a cpuset partition",
                               c.allowed.cpus().back())});
    }
    // All FIFO work together leaves a tenth of each core (the rule of the session): throttling at 95 % never bites, below 90 % it
    // does.
    if (c.rt_runtime_us >= 0 && c.rt_runtime_us * 10 < c.rt_period_us * 9) {
        lacking.push_back({LackKind::throttled,
                           fmt::format("Real-time threads are throttled to {} of {} us", c.rt_runtime_us, c.rt_period_us),
                           "Run `sysctl kernel.sched_rt_runtime_us=950000`"});
    }
    return lacking;
}

SavedLimits raise_limits(int wanted_priority) {
    rlimit rtprio{}, rttime{}, memlock{};
    getrlimit(RLIMIT_RTPRIO, &rtprio);
    getrlimit(RLIMIT_RTTIME, &rttime);
    getrlimit(RLIMIT_MEMLOCK, &memlock);
    raise(RLIMIT_RTPRIO, static_cast<rlim_t>(std::clamp(wanted_priority, 0, 99)));
    raise(RLIMIT_RTTIME, RLIM_INFINITY);
    raise(RLIMIT_MEMLOCK, RLIM_INFINITY);
    return {rtprio.rlim_cur, rtprio.rlim_max, rttime.rlim_cur, rttime.rlim_max, memlock.rlim_cur, memlock.rlim_max};
}

void restore_limits(const SavedLimits& limits) {
    const auto put_back = [](__rlimit_resource_t resource, rlim_t soft, rlim_t hard) {
        const rlimit limit{soft, hard};
        setrlimit(resource, &limit);
    };
    put_back(RLIMIT_RTPRIO, limits.rtprio_soft, limits.rtprio_hard);
    put_back(RLIMIT_RTTIME, limits.rttime_soft, limits.rttime_hard);
    put_back(RLIMIT_MEMLOCK, limits.memlock_soft, limits.memlock_hard);
}

}  // namespace surefoot::rt
