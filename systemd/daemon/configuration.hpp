// Reads and checks the settings file for the daemon, and reports every error in it.
#pragma once

#include <string>
#include <vector>

#include "config/settings.hpp"
#include "rt/base/result.hpp"
#include "systemd/daemon/options.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::daemon {

/// A configuration as it was read.
struct Loaded {
    config::Configuration configuration{walk::settings_schema()};
    std::vector<Error> problems;  ///< empty: it can be used
    bool misuse = false;          ///< the command line is wrong, not the file
};

/// File, profile, then --set; the schema's rules and the daemon's own. Opens nothing but the settings file.
Loaded load(const Options& options);

/// The walk that the configuration describes: without end.
walk::WalkRequest request_of(const config::Configuration& configuration, const std::string& config_file);

/// "60 Hz, 1280x720, osmesa".
std::string in_short(const config::Settings& settings);

}  // namespace surefoot::daemon
