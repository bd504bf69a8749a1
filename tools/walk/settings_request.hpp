// From settings to a request: the one place that knows both. `surefoot walk` and the daemon go through it.
#pragma once

#include "config/settings.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// The schema with the names and help of every registry that a walk chooses from.
const config::Schema& settings_schema();

/// Everything that is a setting is put into `request`; files that it names already (from a command line) stay.
void apply_settings(const config::Configuration& configuration, WalkRequest& request);

/// Rules across what is asked for, each of them checked here alone: what contradicts, or says nothing without something else.
/// The places are those of a command line.
Result<void> check_request(const WalkRequest& request);

}  // namespace surefoot::walk
