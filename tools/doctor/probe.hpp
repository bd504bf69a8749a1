// Tries what files cannot show: FIFO, locking, the renderer, the cost table, disk space.
#pragma once

#include "tools/doctor/machine.hpp"

namespace surefoot::doctor {

/// Everything but the wake-up run. Leaves limits, threads and files as they were; opens GL once (a few tenths of a second).
Probed probe_machine(const Wanted& wanted);

}  // namespace surefoot::doctor
