// From settings to a request: the one place that knows both. `surefoot walk` and the daemon go through it.
#pragma once

#include <string>

#include "config/settings.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// The schema with the names and help of every registry that a walk chooses from.
const config::Schema& settings_schema();

/// Copies all settings into `request`. File names that it already has (from a command line) stay.
void apply_settings(const config::Configuration& configuration, WalkRequest& request);

/// The rules across options, each checked only here: contradictions, and options that need another one. The places of errors
/// are options of the command line.
Result<void> check_request(const WalkRequest& request);

/// Whether keyboard and mouse of a window steer where the request lets them, alone or beside devices. Without an input the path
/// is followed until they do. Not on the virtual clock, nor with a control.
bool window_steers(const WalkRequest& request);
/// Whether somebody steers by hand: not a path, nor a recording.
inline bool is_steered_live(const WalkRequest& request) { return request.input_file == live_input || window_steers(request); }

/// Sets what all walks of the process share: the rasteriser threads of a software driver. Call it before any other thread
/// exists.
void prepare_process(const WalkRequest& first);
/// A later walk in a process that was prepared for `first` keeps the process's number of rasterisers. Returns a
/// message if it requests another number, else nothing.
std::string keep_process(const WalkRequest& first, WalkRequest& request);

}  // namespace surefoot::walk
