// A walk that can be looked at: the monitor of `walk --monitor`, wired to what the walk tells.
#pragma once

#include <memory>
#include <string>

#include "rt/base/result.hpp"
#include "tools/app/walk.hpp"
#include "tools/console/monitor.hpp"

namespace surefoot::cli {

struct WatchRequest {
    std::string address;        ///< empty: nobody can look
    std::string incidents_dir;  ///< empty: none are written
};

/// Null where nothing is asked for. Errors: as Monitor::open().
Result<std::unique_ptr<console::Monitor>> open_monitor(const WatchRequest& request);

/// What the walk of `request` tells the monitor; both must outlive the walk.
app::WalkWatch watch_of(console::Monitor& monitor, const app::WalkRequest& request);

}  // namespace surefoot::cli
