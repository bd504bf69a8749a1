// Time and the host: the clock that frames are counted by, and whether somebody else takes the cores away.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

Finding clock_source(const Machine& m) {
    constexpr std::string_view file = "/sys/devices/system/clocksource/clocksource0/current_clocksource";
    const auto name = m.text(file);
    if (!name || name->empty()) return unknown(fmt::format("{} cannot be read", file), "mount -t sysfs sysfs /sys");
    for (const auto* good : {"tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page"}) {
        if (*name == good) return pass(*name + ": it is read without a system call");
    }
    return fail(*name + ": every reading is a slow system call",
                fmt::format("echo tsc > {}; or boot with clocksource=tsc tsc=reliable", file));
}

Finding tsc(const Machine& m) {
    const auto constant = m.processor_flag("constant_tsc"), nonstop = m.processor_flag("nonstop_tsc");
    if (!constant || !nonstop) {
        if (m.text("/sys/devices/system/clocksource/clocksource0/current_clocksource") == "arch_sys_counter")
            return pass("the system counter of this processor has a constant rate by its architecture");
        return unknown("/proc/cpuinfo lists no flags", "mount -t proc proc /proc");
    }
    if (*constant && *nonstop) return pass("constant_tsc and nonstop_tsc");
    return fail(fmt::format("the time stamp counter {}",
                            !*constant ? "changes its rate (no constant_tsc)" : "stops in deep sleep (no nonstop_tsc)"),
                "in a virtual machine: pass invtsc from the host (-cpu host,+invtsc); on real hardware: boot with "
                "processor.max_cstate=1");
}

Finding hypervisor(const Machine& m) {
    const auto guest = m.processor_flag("hypervisor");
    if (!guest) return unknown("/proc/cpuinfo lists no flags", "see systemd-detect-virt");
    if (!*guest) return pass("no hypervisor (/proc/cpuinfo)");
    return fail("this is a virtual machine: the host may take CPU time at any moment, and the guest cannot prevent it",
                "run on real hardware; or, on the host, pin every virtual core to its own physical core (virsh vcpupin), with "
                "nohz_full there");
}

/// Shares of /proc/stat since boot: user nice system idle iowait irq softirq steal.
Finding steal(const Machine& m) {
    const auto stat = m.text("/proc/stat");
    const auto core = m.frame_core();
    if (!stat || !core) return unknown("/proc/stat or the frame core cannot be read", "mount -t proc proc /proc");
    const std::string label = fmt::format("cpu{}", *core);
    for (const std::string_view line : split(*stat, "\n")) {
        const auto fields = split(line, " ");
        if (fields.empty() || fields[0] != label) continue;
        if (fields.size() < 9) break;
        double all = 0;
        for (std::size_t i = 1; i <= 8; ++i) all += static_cast<double>(number_in(fields[i]).value_or(0));
        if (all < 100) break;
        const double share = static_cast<double>(number_in(fields[8]).value_or(0)) / all;
        std::string evidence = fmt::format("the host took {:.3f} % of core {} since boot (/proc/stat)", 100 * share, *core);
        if (share <= 1e-4) return pass(std::move(evidence));
        return fail(std::move(evidence),
                    "on the host: pin this machine to its own cores (virsh vcpupin), and keep other load off them");
    }
    return unknown(label + " is not in /proc/stat, or has run for less than a second", "run again later");
}

constexpr std::array all_time_checks = {
    Check{"time.clock_source", "a fast clock source", clock_source},
    Check{"time.tsc", "a constant, nonstop TSC", tsc},
    Check{"time.hypervisor", "no hypervisor", hypervisor},
    Check{"time.steal", "no stolen time on the frame core", steal},
};

}  // namespace

std::span<const Check> time_checks() { return all_time_checks; }

}  // namespace surefoot::doctor
