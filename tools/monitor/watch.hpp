// A monitor wired to what a walk tells: for `walk --monitor` and for the daemon.
#pragma once

#include "tools/monitor/monitor.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::monitor {

/// From now on `watch` tells the monitor too, after whomever it told before. Monitor and request must outlive the walk.
void watch_with(Monitor& monitor, const walk::WalkRequest& request, walk::WalkWatch& watch);

}  // namespace surefoot::monitor
