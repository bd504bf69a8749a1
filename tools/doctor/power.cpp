// How fast the frame core runs and how deep it sleeps: governor, frequencies, turbo, C-states.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::int64_t deep_us = 50;  ///< leaving such a C-state is seen in the wake-up histogram

constexpr std::string_view in_guest =
    "nothing to do in a virtual machine, where the host decides; on real hardware: modprobe acpi_cpufreq";

std::string cpu_file(int core, std::string_view name) { return fmt::format("/sys/devices/system/cpu/cpu{}/{}", core, name); }

Finding governor(const Machine& m) {
    const auto core = m.frame_core();
    const auto name = core ? m.text(cpu_file(*core, "cpufreq/scaling_governor")) : std::nullopt;
    if (!name) return unknown("scaling_governor cannot be read", std::string(in_guest));
    if (*name == "performance") return pass(fmt::format("core {} uses the governor 'performance'", *core));
    return fail(fmt::format("core {} uses the governor '{}': it is slow when a frame starts", *core, *name),
                "for f in /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor; do echo performance > $f; done");
}

Finding spread(const Machine& m) {
    const auto core = m.frame_core();
    const auto low = core ? m.number(cpu_file(*core, "cpufreq/scaling_min_freq")) : std::nullopt;
    const auto high = core ? m.number(cpu_file(*core, "cpufreq/scaling_max_freq")) : std::nullopt;
    if (!low || !high || *high <= 0) return unknown("the frequency limits cannot be read", std::string(in_guest));
    std::string evidence = fmt::format("core {} runs at {:.1f} to {:.1f} GHz", *core, static_cast<double>(*low) / 1e6,
                                       static_cast<double>(*high) / 1e6);
    if (*low * 10 >= *high * 9) return pass(std::move(evidence));
    return fail(std::move(evidence) + ": a cost table is valid for one frequency only",
                fmt::format("echo {} > {}", *high, cpu_file(*core, "cpufreq/scaling_min_freq")));
}

Finding turbo(const Machine& m) {
    if (const auto off = m.number("/sys/devices/system/cpu/intel_pstate/no_turbo")) {
        if (*off == 1) return pass("turbo is off (intel_pstate/no_turbo is 1)");
        return fail("turbo is on: a core's speed depends on temperature and on the load of other cores",
                    "echo 1 > /sys/devices/system/cpu/intel_pstate/no_turbo; then surefoot calibrate");
    }
    if (const auto on = m.number("/sys/devices/system/cpu/cpufreq/boost")) {
        if (*on == 0) return pass("turbo is off (cpufreq/boost is 0)");
        return fail("turbo is on: a core's speed depends on temperature and on the load of other cores",
                    "echo 0 > /sys/devices/system/cpu/cpufreq/boost; then surefoot calibrate");
    }
    return unknown("neither intel_pstate/no_turbo nor cpufreq/boost can be read", std::string(in_guest));
}

Finding c_states(const Machine& m) {
    const auto core = m.frame_core();
    const auto driver = m.text("/sys/devices/system/cpu/cpuidle/current_driver");
    const std::string folder = core ? cpu_file(*core, "cpuidle") : std::string();
    const auto states = core ? m.names(folder) : std::nullopt;
    if (!states || states->empty()) {
        if (driver == "none") return pass("no driver uses C-states deeper than a halt");
        return unknown("the C-states cannot be read", "boot with idle=poll to be safe (uses more power)");
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
        return unknown("no latency of a C-state can be read in " + folder, "boot with idle=poll to be safe (uses more power)");
    if (deep.empty()) return pass(fmt::format("core {} wakes from its deepest C-state within {} us", *core, deepest));
    return fail(fmt::format("core {} may enter deep C-states: {}", *core, deep),
                off + "; or boot with processor.max_cstate=1 intel_idle.max_cstate=0");
}

Finding hold(const Machine& m) {
    const auto held = m.probed().holds_c_states;
    if (!held)
        return unknown("not tried: this needs the machine itself and /dev/cpu_dma_latency",
                       "run surefoot doctor there, as the service's user");
    if (*held) return pass("/dev/cpu_dma_latency can be opened: deep C-states can be disabled");
    return fail("/dev/cpu_dma_latency cannot be opened for writing",
                "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"surefoot-input\", MODE=\"0660\"' > "
                "/etc/udev/rules.d/71-surefoot-latency.rules; udevadm trigger");
}

constexpr std::array all_power_checks = {
    Check{"power.governor", "governor 'performance'", governor},
    Check{"power.frequency", "constant frequency", spread},
    Check{"power.turbo", "no turbo", turbo},
    Check{"power.c_states", "no deep C-states", c_states},
    Check{"power.cpu_dma_latency", "deep C-states can be disabled", hold},
};

}  // namespace

std::span<const Check> power_checks() { return all_power_checks; }

}  // namespace surefoot::doctor
