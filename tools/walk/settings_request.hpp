// From settings to a request: the one place that knows both. `surefoot walk` and the daemon go through it.
#pragma once

#include <string>

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

/// What walks take from the process, settled by the first: the rasteriser threads of a software driver. Call it before any
/// other thread exists.
void prepare_process(const WalkRequest& first);
/// A later walk in a process that was prepared for `first` keeps the process's number of rasterisers. Returns what is to be said
/// of that where it asks for another, else nothing.
std::string keep_process(const WalkRequest& first, WalkRequest& request);

}  // namespace surefoot::walk
