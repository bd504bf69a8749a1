// The charts of a soak's page. For this room only.
#pragma once

#include <string>

#include "tools/soak/summary.hpp"

namespace surefoot::soak {

/// Frame times over the whole soak with every miss marked, and under it, on the same axis, what loaded the machine when.
std::string soak_time_chart(const SoakSummary& summary);
/// Memory over time with its trend; descriptors and threads below it.
std::string soak_memory_chart(const SoakSummary& summary);
std::string soak_count_chart(const SoakSummary& summary);
/// Worst accuracy of each column.
std::string soak_accuracy_chart(const SoakSummary& summary);
/// Misses a thousand frames while each kind of load was on.
std::string soak_load_chart(const SoakSummary& summary);

}  // namespace surefoot::soak
