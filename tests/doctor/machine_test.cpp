// Machines for the checks of power, time, limits and memory.
#include "tests/doctor/cases.hpp"

namespace surefoot::doctor {

namespace {

FakeFile limits(const std::string& hard_priority, const std::string& hard_time, const std::string& hard_lock) {
    return {"/proc/self/limits",
            "Limit                     Soft Limit           Hard Limit           Units     \n"
            "Max locked memory         8388608              " +
                hard_lock +
                "              bytes     \n"
                "Max realtime priority     0                    " +
                hard_priority +
                "                    \n"
                "Max realtime timeout      unlimited            " +
                hard_time + "            us        \n"};
}
FakeFile capabilities(const std::string& effective) { return {"/proc/self/status", "Name:\tx\nCapEff:\t" + effective + "\n"}; }
FakeFile flags(const std::string& words) { return {"/proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu " + words + "\n"}; }
FakeFile clock(const std::string& name) {
    return {"/sys/devices/system/clocksource/clocksource0/current_clocksource", name + "\n"};
}

}  // namespace

std::vector<Case> machine_cases() {
    const std::string cpu = "/sys/devices/system/cpu/", cpu1 = cpu + "cpu1/", vm = "/proc/sys/vm/";
    const std::string swaps = "Filename\t\t\t\tType\t\tSize\t\tUsed\t\tPriority\n";
    const auto idle = [&](const std::string& disabled) {
        return FakeFiles{{cpu1 + "cpuidle/state0/latency", "1\n"},
                         {cpu1 + "cpuidle/state0/name", "C1\n"},
                         {cpu1 + "cpuidle/state1/latency", "133\n"},
                         {cpu1 + "cpuidle/state1/name", "C6\n"},
                         {cpu1 + "cpuidle/state1/disable", disabled + "\n"}};
    };
    const auto nothing = [](Probed&) {};
    return {
        {"power.governor", true, "performance", {{cpu1 + "cpufreq/scaling_governor", "performance\n"}}, {}},
        {"power.governor", false, "'powersave'", {{cpu1 + "cpufreq/scaling_governor", "powersave\n"}}, {}},
        {"power.frequency",
         true,
         "3.4 to 3.5 GHz",
         {{cpu1 + "cpufreq/scaling_min_freq", "3400000\n"}, {cpu1 + "cpufreq/scaling_max_freq", "3500000\n"}},
         {}},
        {"power.frequency",
         false,
         "0.8 to 3.5 GHz",
         {{cpu1 + "cpufreq/scaling_min_freq", "800000\n"}, {cpu1 + "cpufreq/scaling_max_freq", "3500000\n"}},
         {}},
        {"power.turbo", true, "no_turbo", {{cpu + "intel_pstate/no_turbo", "1\n"}}, {}},
        {"power.turbo", true, "boost", {{cpu + "cpufreq/boost", "0\n"}}, {}},
        {"power.turbo", false, "turbo is on", {{cpu + "intel_pstate/no_turbo", "0\n"}}, {}},
        {"power.turbo", false, "turbo is on", {{cpu + "cpufreq/boost", "1\n"}}, {}},
        {"power.c_states", true, "within 1 us", idle("1"), nothing},
        {"power.c_states", true, "no driver", {{cpu + "cpuidle/current_driver", "none\n"}}, {}},
        {"power.c_states", false, "C6 (133 us)", idle("0"), nothing},
        {"power.cpu_dma_latency", true, "can be disabled", {}, [](Probed& p) { p.holds_c_states = true; }},
        {"power.cpu_dma_latency", false, "cannot be opened", {}, [](Probed& p) { p.holds_c_states = false; }},

        {"time.clock_source", true, "tsc", {clock("tsc")}, {}},
        {"time.clock_source", false, "hpet", {clock("hpet")}, {}},
        {"time.tsc", true, "nonstop_tsc", {flags("constant_tsc nonstop_tsc")}, {}},
        {"time.tsc", true, "architecture", {clock("arch_sys_counter"), {"/proc/cpuinfo", "Features : fp\n"}}, {}},
        {"time.tsc", false, "no nonstop_tsc", {flags("constant_tsc")}, {}},
        {"time.tsc", false, "no constant_tsc", {flags("tsc")}, {}},
        {"time.hypervisor", true, "no hypervisor", {flags("vmx")}, {}},
        {"time.hypervisor", false, "virtual machine", {flags("vmx hypervisor")}, {}},
        {"time.steal",
         true,
         "0.000 %",
         {{"/proc/stat", "cpu  1 2 3\ncpu0 5 0 5 900 0 0 0 90\ncpu1 500 0 500 9000 0 0 0 0 0 0\n"}},
         {}},
        {"time.steal", false, "1.000 %", {{"/proc/stat", "cpu1 500 0 400 9000 0 0 0 100 0 0\n"}}, {}},

        {"limits.rtprio", true, "is 99", {limits("99", "unlimited", "unlimited")}, {}},
        {"limits.rtprio", true, "unlimited", {limits("unlimited", "unlimited", "unlimited")}, {}},
        {"limits.rtprio", true, "CAP_SYS_NICE", {limits("0", "unlimited", "unlimited"), capabilities("0000000000800000")}, {}},
        {"limits.rtprio",
         false,
         "is 40, 80 is needed",
         {limits("40", "unlimited", "unlimited"), capabilities("0000000000000000")},
         {}},
        {"limits.rttime", true, "unlimited", {limits("0", "unlimited", "0")}, {}},
        {"limits.rttime", true, "200000 us", {limits("0", "200000", "0")}, {}},
        {"limits.rttime", false, "1000 us", {limits("0", "1000", "0")}, {}},
        {"limits.memlock", true, "unlimited", {limits("0", "unlimited", "unlimited")}, {}},
        {"limits.memlock", true, "CAP_IPC_LOCK", {limits("0", "unlimited", "8388608"), capabilities("0000000000004000")}, {}},
        {"limits.memlock", false, "8 MiB, 1024", {limits("0", "unlimited", "8388608")}, {}},
        {"limits.fifo_tried", true, "80 was granted", {}, [](Probed& p) { p.fifo_priority = 80; }},
        {"limits.fifo_tried", false, "only up to 20", {}, [](Probed& p) { p.fifo_priority = 20; }},
        {"limits.fifo_tried", false, "was refused", {}, [](Probed& p) { p.fifo_priority = 0; }},
        {"limits.lock_tried", true, "can be locked", {}, [](Probed& p) { p.locks_memory = true; }},
        {"limits.lock_tried", false, "cannot be locked", {}, [](Probed& p) { p.locks_memory = false; }},

        {"memory.available", true, "4096 MiB", {{"/proc/meminfo", "MemTotal: 9000000 kB\nMemAvailable:    4194304 kB\n"}}, {}},
        {"memory.available", false, "100 MiB", {{"/proc/meminfo", "MemAvailable:    102400 kB\n"}}, {}},
        {"memory.huge_pages", true, "madvise", {{"/sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never\n"}}, {}},
        {"memory.huge_pages", false, "always", {{"/sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never\n"}}, {}},
        {"memory.swap", true, "no swap", {{"/proc/swaps", swaps}}, {}},
        {"memory.swap",
         true,
         "swappiness is 1",
         {{"/proc/swaps", swaps + "/dev/sda2 partition 1 0 -2\n"}, {vm + "swappiness", "1\n"}},
         {}},
        {"memory.swap",
         false,
         "/dev/sda2 is on",
         {{"/proc/swaps", swaps + "/dev/sda2 partition 1 0 -2\n"}, {vm + "swappiness", "60\n"}},
         {}},
        {"memory.compaction", true, "does not move locked pages", {{vm + "compact_unevictable_allowed", "0\n"}}, {}},
        {"memory.compaction", false, "moves locked pages", {{vm + "compact_unevictable_allowed", "1\n"}}, {}},
        {"memory.merging", true, "not merged", {{"/sys/kernel/mm/ksm/run", "0\n"}}, {}},
        {"memory.merging", false, "merges equal pages", {{"/sys/kernel/mm/ksm/run", "1\n"}}, {}},
    };
}

}  // namespace surefoot::doctor
