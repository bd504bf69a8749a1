// The same wake-up run by cyclictest (Debian's rt-tests), read into our own histogram.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/doctor/wake_up.hpp"

namespace surefoot::doctor {

/// Where a program is on $PATH.
std::optional<std::string> find_program(const std::string& name);

/// What `cyclictest -q -h N` of one thread prints: "latency count" lines in microseconds, then '#' lines. What lay beyond its
/// last bin is counted at its maximum, so that no cycle is lost here too.
Result<WakeFigures> read_cyclictest(std::string_view printed);

/// Runs it as `program`; the machine is left as it is (--default-system), as it is for our own run.
Result<WakeFigures> run_cyclictest(const std::string& program, const WakeOptions& options, const Progress& progress);

}  // namespace surefoot::doctor
