// Connects a monitor to the events of a walk, for `walk --monitor` and for the daemon.
#pragma once

#include "tools/monitor/monitor.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::monitor {

/// Adds the monitor to the observers of `watch`, after those it has. Monitor and request must outlive the walk.
void watch_with(Monitor& monitor, const walk::WalkRequest& request, walk::WalkWatch& watch);

}  // namespace surefoot::monitor
