// A monitor wired to what a walk tells: for `walk --monitor` and for the daemon.
#pragma once

#include "tools/app/walk.hpp"
#include "tools/monitor/monitor.hpp"

namespace surefoot::monitor {

/// From now on `watch` tells the monitor too, after whomever it told before. Monitor and request must outlive the walk.
void watch_with(Monitor& monitor, const app::WalkRequest& request, app::WalkWatch& watch);

}  // namespace surefoot::monitor
