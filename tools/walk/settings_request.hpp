// From settings to a request: the one place that knows both. `surefoot walk` and the daemon go through it.
#pragma once

#include "config/settings.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Everything that is a setting is put into `request`; files that it names already (from a command line) stay.
void apply_settings(const config::Configuration& configuration, WalkRequest& request);

}  // namespace surefoot::walk
