// What this process is granted: real-time priority, its time limit, locked memory; by the limits' numbers and by trying.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr int cap_ipc_lock = 14, cap_sys_nice = 23;
constexpr std::int64_t lock_enough_bytes = 1LL << 30;
constexpr std::int64_t rttime_enough_us = 200'000;

/// The hard limit, which the service raises its own to; -1: unlimited.
std::optional<std::int64_t> hard_limit(const Machine& m, std::string_view name) {
    const auto limits = m.text("/proc/self/limits");
    if (!limits) return std::nullopt;
    for (const std::string_view line : split(*limits, "\n")) {
        if (!line.starts_with(name)) continue;
        const auto fields = split(line.substr(name.size()), " ");
        if (fields.size() < 2) return std::nullopt;
        return fields[1] == "unlimited" ? std::optional<std::int64_t>(-1) : number_in(fields[1]);
    }
    return std::nullopt;
}

Finding no_limits() { return unknown("/proc/self/limits cannot be read", "mount -t proc proc /proc"); }

std::string grant(std::string_view unit_line, std::string_view limits_line) {
    return fmt::format("{} in the unit; or '{}' in /etc/security/limits.d/surefoot.conf", unit_line, limits_line);
}

Finding priority(const Machine& m) {
    const auto limit = hard_limit(m, "Max realtime priority");
    if (!limit) return no_limits();
    const int wanted = m.wanted().frame_priority;
    if (*limit < 0) return pass("RLIMIT_RTPRIO is unlimited");
    if (*limit >= wanted) return pass(fmt::format("RLIMIT_RTPRIO is {}, {} is needed", *limit, wanted));
    if (m.has_capability(cap_sys_nice) == true)
        return pass(fmt::format("RLIMIT_RTPRIO is {}, but this process has CAP_SYS_NICE", *limit));
    return fail(fmt::format("RLIMIT_RTPRIO is {}, {} is needed", *limit, wanted),
                grant(fmt::format("LimitRTPRIO={}", wanted), fmt::format("@surefoot - rtprio {}", wanted)));
}

Finding time(const Machine& m) {
    const auto limit = hard_limit(m, "Max realtime timeout");
    if (!limit) return no_limits();
    if (*limit < 0) return pass("RLIMIT_RTTIME is unlimited: the service sets its own");
    std::string evidence = fmt::format("RLIMIT_RTTIME is {} us", *limit);
    if (*limit >= rttime_enough_us) return pass(std::move(evidence));
    return fail(std::move(evidence) + ": the kernel ends a busy frame thread",
                grant("LimitRTTIME=infinity", "@surefoot - rttime unlimited"));
}

Finding lock(const Machine& m) {
    const auto limit = hard_limit(m, "Max locked memory");
    if (!limit) return no_limits();
    if (*limit < 0) return pass("RLIMIT_MEMLOCK is unlimited");
    std::string evidence = fmt::format("RLIMIT_MEMLOCK is {} MiB", *limit >> 20);
    if (*limit >= lock_enough_bytes) return pass(std::move(evidence));
    if (m.has_capability(cap_ipc_lock) == true) return pass(std::move(evidence) + ", but this process has CAP_IPC_LOCK");
    return fail(std::move(evidence) + ", 1024 are needed", grant("LimitMEMLOCK=infinity", "@surefoot - memlock unlimited"));
}

std::string as_service() { return "run surefoot doctor on the machine itself, as the service's user"; }

Finding fifo(const Machine& m) {
    const auto granted = m.probed().fifo_priority;
    if (!granted) return unknown("not tried", as_service());
    const int wanted = m.wanted().frame_priority;
    if (*granted >= wanted) return pass(fmt::format("SCHED_FIFO {} was granted to a test thread", wanted));
    return fail(*granted == 0 ? "SCHED_FIFO was refused"
                              : fmt::format("SCHED_FIFO was granted only up to {}, {} is needed", *granted, wanted),
                grant(fmt::format("LimitRTPRIO={}", wanted), fmt::format("@surefoot - rtprio {}", wanted)) +
                    "; as root: see the check kernel.rt_group_sched");
}

Finding locking(const Machine& m) {
    const auto granted = m.probed().locks_memory;
    if (!granted) return unknown("not tried", as_service());
    if (*granted) return pass("1 GiB of memory can be locked");
    return fail("1 GiB of memory cannot be locked", grant("LimitMEMLOCK=infinity", "@surefoot - memlock unlimited"));
}

constexpr std::array all_limit_checks = {
    Check{"limits.rtprio", "limit of real-time priority", priority},
    Check{"limits.rttime", "no limit of real-time CPU time", time},
    Check{"limits.memlock", "limit of locked memory", lock},
    Check{"limits.fifo_tried", "SCHED_FIFO is granted", fifo},
    Check{"limits.lock_tried", "memory can be locked", locking},
};

}  // namespace

std::span<const Check> limit_checks() { return all_limit_checks; }

}  // namespace surefoot::doctor
