// How the kernel schedules: preemption, throttling, the fair server, real-time groups, what scans and migrates behind our back.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::string_view mount_debugfs = "mount -t debugfs none /sys/kernel/debug   (as root), then run again";

Finding dynamic_mode(std::string_view mode, std::string_view where) {
    std::string evidence = fmt::format("PREEMPT_DYNAMIC in mode '{}' ({})", mode, where);
    if (mode == "full") return pass(std::move(evidence));
    return fail(std::move(evidence), "apt install linux-image-rt-amd64; or boot with preempt=full");
}

Finding preemption(const Machine& m) {
    if (m.number("/sys/kernel/realtime") == 1) return pass("PREEMPT_RT (/sys/kernel/realtime is 1)");
    const auto version = m.text("/proc/version");
    if (!version) return unknown("/proc/version cannot be read", "mount -t proc proc /proc");
    if (version->find("PREEMPT_RT") != std::string::npos) return pass("PREEMPT_RT (/proc/version)");
    if (version->find("PREEMPT_DYNAMIC") == std::string::npos) {
        if (version->find("PREEMPT") != std::string::npos) return pass("full preemption, built in (/proc/version)");
        return fail("no preemption inside the kernel (/proc/version)", "apt install linux-image-rt-amd64");
    }
    if (const auto modes = m.text("/sys/kernel/debug/sched/preempt")) {
        if (const auto mode = marked_word(*modes, '(', ')'); !mode.empty())
            return dynamic_mode(mode, "/sys/kernel/debug/sched/preempt");
    }
    if (const auto mode = m.boot_word("preempt")) return dynamic_mode(*mode, "/proc/cmdline");
    if (const auto full = m.build_option("CONFIG_PREEMPT")) {
        if (*full == "y") return dynamic_mode("full", "CONFIG_PREEMPT of the kernel");
        for (const auto& [key, mode] : {std::pair{"CONFIG_PREEMPT_VOLUNTARY", "voluntary"},
                                        std::pair{"CONFIG_PREEMPT_NONE", "none"}, std::pair{"CONFIG_PREEMPT_LAZY", "lazy"}}) {
            if (m.build_option(key) == "y") return dynamic_mode(mode, fmt::format("{} of the kernel", key));
        }
    }
    return unknown("PREEMPT_DYNAMIC, its mode cannot be read", std::string(mount_debugfs));
}

Finding version(const Machine& m) {
    const auto kernel = m.kernel();
    if (!kernel) return unknown("/proc/sys/kernel/osrelease cannot be read", "mount -t proc proc /proc");
    const std::string name = fmt::format("Linux {}.{}", kernel->major, kernel->minor);
    if (kernel->before(5, 4))
        return fail(name + " is older than every kernel that Surefoot is tested on",
                    "apt install linux-image-amd64 (5.4 or newer)");
    const auto controllers = m.text("/sys/fs/cgroup/cgroup.controllers");
    const bool cpusets = controllers && controllers->find("cpuset") != std::string::npos;
    if (kernel->before(6, 2) && cpusets)
        return fail(name + " moves threads back to all cores when a parent cpuset changes (fixed in 6.2)",
                    "apt install -t bookworm-backports linux-image-amd64; or use isolcpus= instead of AllowedCPUs= in units");
    return pass(name);
}

Finding throttling(const Machine& m) {
    const auto runtime = m.number("/proc/sys/kernel/sched_rt_runtime_us");
    if (!runtime) return unknown("/proc/sys/kernel/sched_rt_runtime_us cannot be read", "mount -t proc proc /proc");
    if (*runtime < 0) return pass("no throttling of real-time threads (sched_rt_runtime_us is -1)");
    const std::int64_t period = m.number("/proc/sys/kernel/sched_rt_period_us").value_or(1'000'000);
    std::string evidence = fmt::format("real-time threads get {} of {} us (sched_rt_runtime_us)", *runtime, period);
    // All FIFO work together leaves a tenth of each core: a limit of 95 % never bites, one below 90 % does.
    if (*runtime * 10 >= period * 9) return pass(std::move(evidence));
    return fail(
        std::move(evidence),
        fmt::format("sysctl -w kernel.sched_rt_runtime_us={}; to keep it: /etc/sysctl.d/70-surefoot.conf", period / 100 * 95));
}

/// From 6.12 a deadline server gives ordinary threads their share of a core that real-time threads fill.
Finding fair_server(const Machine& m) {
    const auto kernel = m.kernel();
    if (!kernel) return unknown("the kernel's version cannot be read", "mount -t proc proc /proc");
    if (kernel->before(6, 12))
        return pass(fmt::format("Linux {}.{} has no fair server (added in 6.12)", kernel->major, kernel->minor));
    const auto core = m.frame_core();
    if (!core) return unknown("the frame core is not known", "name the core: --frame-core N");
    const std::string folder = fmt::format("/sys/kernel/debug/sched/fair_server/cpu{}", *core);
    const auto runtime = m.number(folder + "/runtime"), period = m.number(folder + "/period");
    if (!runtime || !period || *period <= 0) return unknown(folder + " cannot be read", std::string(mount_debugfs));
    std::string evidence = fmt::format("ordinary threads are guaranteed {} of {} ns on core {}", *runtime, *period, *core);
    if (*runtime * 10 <= *period) return pass(std::move(evidence));
    return fail(std::move(evidence), fmt::format("echo {} > {}/runtime", *period / 20, folder));
}

/// The path of this process in a cgroup hierarchy; controller "" is the unified one.
std::optional<std::string> own_cgroup(const Machine& m, std::string_view controller) {
    const auto lines = m.text("/proc/self/cgroup");
    if (!lines) return std::nullopt;
    for (const std::string_view line : split(*lines, "\n")) {
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string_view::npos || second == std::string_view::npos) continue;
        const std::string_view names = line.substr(first + 1, second - first - 1);
        const auto list = split(names, ",");
        const bool found = controller.empty() ? names.empty() : std::find(list.begin(), list.end(), controller) != list.end();
        if (found) return std::string(line.substr(second + 1));
    }
    return std::nullopt;
}

Finding group_scheduling(const Machine& m) {
    const auto built = m.build_option("CONFIG_RT_GROUP_SCHED");
    if (!built)
        return unknown("the kernel's configuration cannot be read",
                       "apt install linux-image-amd64 (which has /boot/config-…), or modprobe configs");
    if (*built != "y") return pass("CONFIG_RT_GROUP_SCHED is not set");
    if (m.boot_word("rt_group_sched") == "0") return pass("disabled at boot (rt_group_sched=0)");
    if (const auto group = own_cgroup(m, "cpu")) {
        const std::string file = "/sys/fs/cgroup/cpu" + (*group == "/" ? "" : *group) + "/cpu.rt_runtime_us";
        const auto runtime = m.number(file);
        if (!runtime)
            return unknown("CONFIG_RT_GROUP_SCHED is set, and " + file + " cannot be read", "boot with rt_group_sched=0");
        if (*runtime != 0) return pass(fmt::format("CONFIG_RT_GROUP_SCHED is set; this group has {} us ({})", *runtime, file));
        return fail("CONFIG_RT_GROUP_SCHED is set, and this group has no real-time budget (" + file + " is 0)",
                    "echo 900000 > " + file + "; or boot with rt_group_sched=0");
    }
    if (own_cgroup(m, "") == "/")
        return pass("CONFIG_RT_GROUP_SCHED is set; this process is in the root group, which has no limit");
    return fail("CONFIG_RT_GROUP_SCHED is set: a service's group has no real-time budget, and FIFO is refused even to root",
                "boot with rt_group_sched=0, or install a kernel without it");
}

/// A switch that should be 0.
Finding should_be_off(const Machine& m, std::string_view file, std::string_view key, std::string_view harm) {
    const auto value = m.number(file);
    if (!value)
        return unknown(fmt::format("{} cannot be read", file),
                       fmt::format("nothing to do if this kernel is built without it; else: sysctl -w {}=0", key));
    if (*value == 0) return pass(fmt::format("{} is 0", key));
    return fail(fmt::format("{} is {}: {}", key, *value, harm),
                fmt::format("sysctl -w {0}=0; to keep it: echo '{0} = 0' >> /etc/sysctl.d/70-surefoot.conf", key));
}

Finding timer_migration(const Machine& m) {
    return should_be_off(m, "/proc/sys/kernel/timer_migration", "kernel.timer_migration",
                         "a timer may fire on another core, which must then wake this one");
}

Finding numa_balancing(const Machine& m) {
    if (!m.exists("/proc/sys/kernel/numa_balancing")) {
        if (const auto nodes = m.cpus("/sys/devices/system/node/online"); nodes && nodes->count() == 1)
            return pass("one memory node (/sys/devices/system/node/online)");
    }
    return should_be_off(m, "/proc/sys/kernel/numa_balancing", "kernel.numa_balancing",
                         "the kernel unmaps pages to see who uses them, which causes page faults in the frame");
}

Finding watchdog(const Machine& m) {
    return should_be_off(m, "/proc/sys/kernel/nmi_watchdog", "kernel.nmi_watchdog",
                         "every core gets interrupts that cannot be masked");
}

constexpr std::array all_kernel_checks = {
    Check{"kernel.version", "a kernel without known faults", version},
    Check{"kernel.preemption", "full preemption", preemption},
    Check{"kernel.rt_throttling", "FIFO may use 90 % of a core", throttling},
    Check{"kernel.fair_server", "fair server at most 10 %", fair_server},
    Check{"kernel.rt_group_sched", "FIFO in cgroups", group_scheduling},
    Check{"kernel.timer_migration", "timers stay on their core", timer_migration},
    Check{"kernel.numa_balancing", "no NUMA page scanning", numa_balancing},
    Check{"kernel.nmi_watchdog", "no NMI watchdog", watchdog},
};

}  // namespace

std::span<const Check> kernel_checks() { return all_kernel_checks; }

}  // namespace surefoot::doctor
