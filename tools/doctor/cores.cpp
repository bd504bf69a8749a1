// The frame core and its neighbours: how many there are, which one is kept free, and who else may run on it.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::string_view name_it = "name the core: --frame-core N";

Finding no_core() { return unknown("the frame core is not known", std::string(name_it)); }

Finding count(const Machine& m) {
    const auto online = m.cpus("/sys/devices/system/cpu/online");
    if (!online) return unknown("/sys/devices/system/cpu/online cannot be read", "mount -t sysfs sysfs /sys");
    std::string evidence = fmt::format("{} online ({})", online->count(), online->text());
    if (online->count() >= 2) return pass(std::move(evidence));
    return fail(std::move(evidence),
                "enable more: echo 1 > /sys/devices/system/cpu/cpu1/online; or give the machine a second core");
}

Finding isolated(const Machine& m) {
    const auto core = m.frame_core();
    if (!core) return no_core();
    const auto list = m.cpus("/sys/devices/system/cpu/isolated");
    if (!list) return unknown("/sys/devices/system/cpu/isolated cannot be read", "mount -t sysfs sysfs /sys");
    if (list->has(*core)) return pass(fmt::format("core {} is isolated (isolated: {})", *core, list->text()));
    return fail(fmt::format("core {} is not isolated (isolated: {})", *core, list->empty() ? "none" : list->text()),
                fmt::format("add isolcpus=managed_irq,domain,{0} nohz_full={0} rcu_nocbs={0} to GRUB_CMDLINE_LINUX in "
                            "/etc/default/grub; update-grub; reboot",
                            *core));
}

Finding tickless(const Machine& m) {
    const auto core = m.frame_core();
    if (!core) return no_core();
    const auto list = m.cpus("/sys/devices/system/cpu/nohz_full");
    if (!list && m.build_option("CONFIG_NO_HZ_FULL") == "n")
        return fail("this kernel is built without CONFIG_NO_HZ_FULL: the tick interrupts every frame",
                    "apt install linux-image-amd64 (Debian's has it), and boot with nohz_full=" + std::to_string(*core));
    if (!list) return unknown("/sys/devices/system/cpu/nohz_full cannot be read", fmt::format("boot with nohz_full={}", *core));
    if (list->has(*core)) return pass(fmt::format("core {} runs without a timer tick (nohz_full: {})", *core, list->text()));
    return fail(
        fmt::format("core {} runs with a timer tick (nohz_full: {})", *core, list->empty() ? "none" : list->text()),
        fmt::format("add nohz_full={0} rcu_nocbs={0} to GRUB_CMDLINE_LINUX in /etc/default/grub; update-grub; reboot", *core));
}

/// cgroup 2 first, then 1: the nearest group above this process that says what is effective.
struct Cpuset {
    rt::CpuMask cpus;
    std::string file;
};
std::optional<Cpuset> effective_cpuset(const Machine& m) {
    const auto lines = m.text("/proc/self/cgroup");
    if (!lines) return std::nullopt;
    const auto nearest = [&](const std::string& top, std::string_view group, std::string_view name) -> std::optional<Cpuset> {
        std::string path(group == "/" ? "" : group);
        while (true) {
            const std::string file = top + path + "/" + std::string(name);
            if (const auto cpus = m.cpus(file); cpus && !cpus->empty()) return Cpuset{*cpus, file};
            if (path.empty()) return std::nullopt;
            path.resize(path.rfind('/') == std::string::npos ? 0 : path.rfind('/'));
        }
    };
    for (const std::string_view line : split(*lines, "\n")) {
        const auto group = line.substr(std::min(line.find('/'), line.size()));
        if (line.starts_with("0::")) {
            if (auto found = nearest("/sys/fs/cgroup", group, "cpuset.cpus.effective")) return found;
        } else if (line.find(":cpuset:") != std::string_view::npos) {
            for (const auto* name : {"cpuset.effective_cpus", "cpuset.cpus"}) {
                if (auto found = nearest("/sys/fs/cgroup/cpuset", group, name)) return found;
            }
        }
    }
    return std::nullopt;
}

Finding cpuset(const Machine& m) {
    const auto core = m.frame_core();
    if (!core) return no_core();
    const auto set = effective_cpuset(m);
    if (!set) return unknown("the cpuset of this process cannot be read", "mount -t cgroup2 none /sys/fs/cgroup");
    std::string evidence = fmt::format("cores {} ({})", set->cpus.text(), set->file);
    if (set->cpus.has(*core) && set->cpus.count() >= 2) return pass(std::move(evidence));
    return fail(
        std::move(evidence),
        fmt::format(
            "systemctl set-property surefootd.service AllowedCPUs= with the frame core {} and at least one more; the same for "
            "its parent slice",
            *core));
}

Finding own_affinity(const Machine& m) {
    const auto core = m.frame_core();
    const auto list = m.own_status("Cpus_allowed_list");
    if (!core || !list) return unknown("the cores of this process cannot be read", "mount -t proc proc /proc");
    const auto allowed = rt::CpuMask::parse(*list);
    if (!allowed) return unknown("Cpus_allowed_list is '" + *list + "'", std::string(name_it));
    std::string evidence = fmt::format("this process may use cores {}; the frame core is {}", allowed->text(), *core);
    if (allowed->has(*core) && allowed->count() >= 2) return pass(std::move(evidence));
    return fail(
        std::move(evidence),
        fmt::format("remove CPUAffinity= from /etc/systemd/system.conf and the unit, or let it contain {} and one more core",
                    *core));
}

Finding sibling(const Machine& m) {
    const auto core = m.frame_core();
    if (!core) return no_core();
    const std::string file = fmt::format("/sys/devices/system/cpu/cpu{}/topology/thread_siblings_list", *core);
    const auto siblings = m.cpus(file);
    if (!siblings || !siblings->has(*core)) return unknown(file + " cannot be read", "mount -t sysfs sysfs /sys");
    if (siblings->count() <= 1) return pass(fmt::format("core {} shares its hardware with no other core", *core));
    std::string off;
    for (const int cpu : siblings->cpus()) {
        if (cpu != *core) off += fmt::format("echo 0 > /sys/devices/system/cpu/cpu{}/online; ", cpu);
    }
    return fail(fmt::format("cores {} are threads of one physical core: load on one slows the other", siblings->text()),
                off + "or boot with nosmt");
}

/// Of /proc/PID/task/TID/stat (proc_pid_stat(5)).
struct Thread {
    std::string name;
    bool kernel = false;
    std::int64_t priority = 0, policy = 0;
};
std::optional<Thread> thread_of(std::string_view stat) {
    const auto open = stat.find('('), close = stat.rfind(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return std::nullopt;
    const auto fields = split(stat.substr(close + 1), " ");  // from the third on
    if (fields.size() < 39) return std::nullopt;
    constexpr std::int64_t kernel_thread = 0x00200000;
    const auto flags = number_in(fields[6]), priority = number_in(fields[37]), policy = number_in(fields[38]);
    if (!flags || !priority || !policy) return std::nullopt;
    return Thread{std::string(stat.substr(open + 1, close - open - 1)), (*flags & kernel_thread) != 0, *priority, *policy};
}

/// Real-time threads of others that could run before the frame thread on its core. The kernel's own belong there.
Finding rivals(const Machine& m) {
    const auto core = m.frame_core();
    const auto processes = m.names("/proc");
    if (!core || !processes) return unknown("the threads of this machine cannot be read", "mount -t proc proc /proc");
    std::string found;
    int seen = 0;
    for (const std::string& process : *processes) {
        if (!number_in(process)) continue;
        for (const std::string& task : m.names("/proc/" + process + "/task").value_or(std::vector<std::string>{})) {
            const std::string folder = fmt::format("/proc/{}/task/{}", process, task);
            const auto stat = m.text(folder + "/stat");
            const auto thread = stat ? thread_of(*stat) : std::nullopt;
            if (!thread) continue;
            ++seen;
            const bool real_time = thread->policy == 1 || thread->policy == 2;
            if (thread->kernel || !real_time || thread->priority < m.wanted().frame_priority) continue;
            const auto status = m.text(folder + "/status");
            const auto at = status ? status->find("Cpus_allowed_list:") : std::string::npos;
            const auto cpus =
                at == std::string::npos
                    ? Result<rt::CpuMask>(Error{})
                    : rt::CpuMask::parse(trimmed(std::string_view(*status).substr(at + 18, status->find('\n', at) - at - 18)));
            if (cpus && !cpus->has(*core)) continue;
            found += fmt::format("{}{} (tid {}, priority {})", found.empty() ? "" : ", ", thread->name, task, thread->priority);
        }
    }
    if (seen == 0) return unknown("no thread can be read in /proc", "run as root, or mount /proc without hidepid");
    if (found.empty())
        return pass(
            fmt::format("none of {} threads has a higher priority than {} on core {}", seen, m.wanted().frame_priority, *core));
    return fail("threads may preempt the frame thread: " + found, "chrt --other --pid 0 TID; or taskset -p it to other cores");
}

constexpr std::array all_core_checks = {
    Check{"cores.count", "at least two cores", count},
    Check{"cores.isolated", "the frame core is isolated", isolated},
    Check{"cores.tickless", "no timer tick on the frame core", tickless},
    Check{"cores.cpuset", "the cpuset contains the frame core", cpuset},
    Check{"cores.affinity", "the affinity allows the frame core", own_affinity},
    Check{"cores.smt_sibling", "no SMT sibling", sibling},
    Check{"cores.rivals", "no higher priority on the frame core", rivals},
};

}  // namespace

std::span<const Check> core_checks() { return all_core_checks; }

}  // namespace surefoot::doctor
