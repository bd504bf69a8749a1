// Facts about the machine, and the kernel's counters while the soak ran. Kept with the figures, so that these can be judged
// later.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "tools/soak/summary.hpp"

namespace surefoot::soak {

/// Counters since boot.
struct MachineCounters {
    std::map<std::string, double> interrupts;   ///< by number or name, with the device's name behind it; all cores together
    std::map<std::string, double> pressure_us;  ///< "cpu some", "io full", ...
    double steal_ms = 0, context_switches = 0, processes = 0;
    double time_s = 0;  ///< monotonic
};
/// root: where /proc lies, for tests. Facts that the kernel does not give are left out.
MachineCounters read_counters(const std::string& root = "");

/// The machine and what it counted between the two. Interrupts: the busiest twenty, the rest as one.
SoakMachine machine_facts(const MachineCounters& before, const MachineCounters& after, const std::string& root = "");

/// This process's own command line, arguments apart by spaces; quoted where they hold any.
std::string own_command_line();

/// One figure of a /proc file: "NAME value" or "NAME: value" at the beginning of a line. 0 where there is no such line.
std::uint64_t proc_figure(std::string_view text, std::string_view name);
/// The same, of a file; 0 where it cannot be read, too.
std::uint64_t proc_figure_of(const std::string& file, std::string_view name);

}  // namespace surefoot::soak
