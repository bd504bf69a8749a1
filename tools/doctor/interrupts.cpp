// What interrupts the frame core: device interrupts, who moves them, and the kernel's deferred work.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

/// The name that /proc/interrupts gives an interrupt, and how often it came to `core`; columns are online cores in order.
struct Line {
    std::string name;
    std::int64_t on_core = 0;
};
Line line_of(std::string_view interrupts, std::string_view number, int core) {
    Line line;
    const auto rows = split(interrupts, "\n");
    if (rows.empty()) return line;
    const auto header = split(rows[0], " ");
    const std::string column = fmt::format("CPU{}", core), label = fmt::format("{}:", number);
    for (const std::string_view row : rows) {
        const auto fields = split(row, " ");
        if (fields.empty() || fields[0] != label) continue;
        for (std::size_t i = 0; i < header.size() && i + 1 < fields.size(); ++i) {
            if (header[i] == column) line.on_core = number_in(fields[i + 1]).value_or(0);
        }
        line.name = std::string(fields.back());
    }
    return line;
}

/// Every core that is on but the frame's, as a list; "0" where that is not to be seen.
std::string other_cores(const Machine& m, int core) {
    rt::CpuMask others;
    for (const int cpu : m.cpus("/sys/devices/system/cpu/online").value_or(rt::CpuMask{0}).cpus()) {
        if (cpu != core) others.add(cpu);
    }
    return others.empty() ? "0" : others.text();
}

Finding device_affinity(const Machine& m) {
    const auto core = m.frame_core();
    const auto numbers = m.names("/proc/irq");
    if (!core || !numbers) return unknown("/proc/irq or the frame core cannot be read", "mount -t proc proc /proc");
    const std::string interrupts = m.text("/proc/interrupts").value_or("");
    std::string there, move;
    int read = 0, on_core = 0;
    for (const std::string& number : *numbers) {
        if (!number_in(number)) continue;
        const std::string folder = "/proc/irq/" + number;
        auto cpus = m.cpus(folder + "/effective_affinity_list");
        if (!cpus || cpus->empty()) cpus = m.cpus(folder + "/smp_affinity_list");
        if (!cpus || cpus->empty()) continue;
        ++read;
        if (!cpus->has(*core)) continue;
        ++on_core;
        const Line line = line_of(interrupts, number, *core);
        if (on_core <= 6) there += fmt::format("{}{} {} ({} so far)", on_core == 1 ? "" : ", ", number, line.name, line.on_core);
        move += (move.empty() ? "" : " ") + number;
    }
    if (read == 0) return unknown("no affinity of an interrupt can be read in /proc/irq", "run as root");
    if (on_core == 0) return pass(fmt::format("none of {} interrupts goes to core {}", read, *core));
    if (on_core > 6) there += fmt::format(", and {} more", on_core - 6);
    return fail(fmt::format("{} go to core {}: {}", on_core, *core, there),
                fmt::format("for i in {0}; do echo {1} > /proc/irq/$i/smp_affinity_list; done; at boot: irqaffinity={1}", move,
                            other_cores(m, *core)));
}

Finding fresh(const Machine& m) {
    const auto core = m.frame_core();
    const auto mask = m.text("/proc/irq/default_smp_affinity");
    const auto has = core && mask ? in_hex_mask(*mask, *core) : std::nullopt;
    if (!has) return unknown("/proc/irq/default_smp_affinity cannot be read", "mount -t proc proc /proc");
    if (!*has) return pass(fmt::format("new devices' interrupts do not go to core {} (default_smp_affinity {})", *core, *mask));
    return fail(fmt::format("new devices' interrupts may go to core {} (default_smp_affinity {})", *core, *mask),
                fmt::format("echo {} > /proc/irq/default_smp_affinity; at boot: irqaffinity={}", without_bit(*mask, *core),
                            other_cores(m, *core)));
}

Finding balancer(const Machine& m) {
    const auto processes = m.names("/proc");
    const auto core = m.frame_core();
    if (!core || !processes || !m.exists("/proc/1"))
        return unknown("the processes of this machine cannot be read", "mount -t proc proc /proc");
    bool running = false;
    for (const std::string& process : *processes)
        running = running || (number_in(process) && m.text("/proc/" + process + "/comm") == "irqbalance");
    if (!running) return pass("irqbalance does not run");
    if (m.isolated().has(*core))
        return pass(fmt::format("irqbalance runs, and does not use isolated cores (core {} is isolated)", *core));
    const auto settings = m.text("/etc/default/irqbalance").value_or("");
    const std::string key = "IRQBALANCE_BANNED_CPULIST=";
    for (const std::string_view line : split(settings, "\n")) {
        if (!line.starts_with(key)) continue;
        const auto banned =
            rt::CpuMask::parse(split(line.substr(key.size()), "\" ").empty() ? "" : split(line.substr(key.size()), "\" ")[0]);
        if (banned && banned->has(*core))
            return pass(fmt::format("irqbalance may not use core {} (/etc/default/irqbalance)", *core));
    }
    return fail(fmt::format("irqbalance runs, and may move interrupts to core {}", *core),
                fmt::format("echo '{}{}' >> /etc/default/irqbalance; systemctl restart irqbalance", key, *core));
}

Finding kernel_work(const Machine& m) {
    const auto core = m.frame_core();
    constexpr std::string_view file = "/sys/devices/virtual/workqueue/cpumask";
    const auto mask = m.text(file);
    const auto has = core && mask ? in_hex_mask(*mask, *core) : std::nullopt;
    if (!has) return unknown(fmt::format("{} cannot be read", file), "mount -t sysfs sysfs /sys");
    if (!*has) return pass(fmt::format("the kernel's unbound work does not run on core {} (mask {})", *core, *mask));
    return fail(fmt::format("the kernel's unbound work may run on core {} (mask {})", *core, *mask),
                fmt::format("echo {} > {}", without_bit(*mask, *core), file));
}

constexpr std::array all_interrupt_checks = {
    Check{"interrupts.affinity", "interrupts go to other cores", device_affinity},
    Check{"interrupts.new_devices", "those of new devices, too", fresh},
    Check{"interrupts.irqbalance", "irqbalance avoids the frame core", balancer},
    Check{"interrupts.kernel_work", "deferred work on other cores", kernel_work},
};

}  // namespace

std::span<const Check> interrupt_checks() { return all_interrupt_checks; }

}  // namespace surefoot::doctor
