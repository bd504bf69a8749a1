// How fast the frame core runs and how deep it sleeps: governor, frequencies, turbo, C-states.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::int64_t deep_us = 50;  ///< leaving such a C-state is seen in the wake-up histogram

constexpr std::string_view in_guest = "nothing in a virtual machine, where the host decides; on metal: modprobe acpi_cpufreq";

std::string cpu_file(int core, std::string_view name) { return fmt::format("/sys/devices/system/cpu/cpu{}/{}", core, name); }

Finding governor(const Machine& m) {
    const auto core = m.frame_core();
    const auto name = core ? m.text(cpu_file(*core, "cpufreq/scaling_governor")) : std::nullopt;
    if (!name) return unknown("no scaling_governor is to be seen", std::string(in_guest));
    if (*name == "performance") return pass(fmt::format("core {} is governed for performance", *core));
    return fail(fmt::format("core {} is governed by '{}': it is slow when a frame begins", *core, *name),
                "for f in /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor; do echo performance > $f; done");
}

Finding spread(const Machine& m) {
    const auto core = m.frame_core();
    const auto low = core ? m.number(cpu_file(*core, "cpufreq/scaling_min_freq")) : std::nullopt;
    const auto high = core ? m.number(cpu_file(*core, "cpufreq/scaling_max_freq")) : std::nullopt;
    if (!low || !high || *high <= 0) return unknown("no frequency limits are to be seen", std::string(in_guest));
    std::string evidence = fmt::format("core {} runs at {:.1f} to {:.1f} GHz", *core, static_cast<double>(*low) / 1e6,
                                       static_cast<double>(*high) / 1e6);
    if (*low * 10 >= *high * 9) return pass(std::move(evidence));
    return fail(std::move(evidence) + ": a cost table holds for one speed",
                fmt::format("echo {} > {}", *high, cpu_file(*core, "cpufreq/scaling_min_freq")));
}

Finding turbo(const Machine& m) {
    if (const auto off = m.number("/sys/devices/system/cpu/intel_pstate/no_turbo")) {
        if (*off == 1) return pass("turbo is off (intel_pstate/no_turbo is 1)");
        return fail("turbo is on: a core's speed hangs on its neighbours' load and on heat",
                    "echo 1 > /sys/devices/system/cpu/intel_pstate/no_turbo; then surefoot calibrate");
    }
    if (const auto on = m.number("/sys/devices/system/cpu/cpufreq/boost")) {
        if (*on == 0) return pass("turbo is off (cpufreq/boost is 0)");
        return fail("turbo is on: a core's speed hangs on its neighbours' load and on heat",
                    "echo 0 > /sys/devices/system/cpu/cpufreq/boost; then surefoot calibrate");
    }
    return unknown("neither intel_pstate/no_turbo nor cpufreq/boost is to be seen", std::string(in_guest));
}

Finding c_states(const Machine& m) {
    const auto core = m.frame_core();
    const auto driver = m.text("/sys/devices/system/cpu/cpuidle/current_driver");
    const std::string folder = core ? cpu_file(*core, "cpuidle") : std::string();
    const auto states = core ? m.names(folder) : std::nullopt;
    if (!states || states->empty()) {
        if (driver == "none") return pass("no driver puts cores to sleep deeper than a halt");
        return unknown("no C-states are to be seen", "boot with idle=poll to be sure; costs power");
    }
    std::string deep, off;
    std::int64_t deepest = -1;
    for (const std::string& state : *states) {
        const auto latency = m.number(folder + "/" + state + "/latency");
        if (!latency) continue;
        deepest = std::max<std::int64_t>(deepest, 0);
        if (m.number(folder + "/" + state + "/disable").value_or(0) != 0) continue;
        deepest = std::max(deepest, *latency);
        if (*latency <= deep_us) continue;
        deep += fmt::format("{}{} ({} us)", deep.empty() ? "" : ", ", m.text(folder + "/" + state + "/name").value_or(state),
                            *latency);
        off += fmt::format("{}echo 1 > {}/{}/disable", off.empty() ? "" : "; ", folder, state);
    }
    if (deepest < 0)
        return unknown("no C-state's latency is to be seen in " + folder, "boot with idle=poll to be sure; costs power");
    if (deep.empty()) return pass(fmt::format("core {} wakes within {} us from its deepest state", *core, deepest));
    return fail(fmt::format("core {} may sleep deep: {}", *core, deep),
                off + "; or boot with processor.max_cstate=1 intel_idle.max_cstate=0");
}

Finding hold(const Machine& m) {
    const auto held = m.probed().holds_c_states;
    if (!held)
        return unknown("not tried: only on the machine itself, and where /dev/cpu_dma_latency is",
                       "run surefoot doctor there, as the service's user");
    if (*held) return pass("/dev/cpu_dma_latency may be opened: the cores can be kept awake");
    return fail("/dev/cpu_dma_latency may not be opened for writing",
                "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"surefoot-input\", MODE=\"0660\"' > "
                "/etc/udev/rules.d/71-surefoot-latency.rules; udevadm trigger");
}

constexpr std::array all_power_checks = {
    Check{"power.governor", "full speed, always", governor},
    Check{"power.frequency", "one speed", spread},
    Check{"power.turbo", "no turbo", turbo},
    Check{"power.c_states", "no deep sleep", c_states},
    Check{"power.cpu_dma_latency", "cores can be kept awake", hold},
};

}  // namespace

std::span<const Check> power_checks() { return all_power_checks; }

}  // namespace surefoot::doctor
