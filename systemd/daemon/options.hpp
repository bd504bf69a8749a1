// surefootd's command line.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace surefoot::daemon {

/// The command line of surefootd.
struct Options {
    std::string config_file = "/etc/surefoot/surefoot.toml";
    std::string profile;
    std::vector<std::string> set;  ///< KEY=VALUE each, over the file; kept through reloads
    bool check = false;            ///< the configuration only
};

/// Reads the command line. Nothing, with the exit code in `code`, after --help, --version or wrong use.
std::optional<Options> read_options(int argc, char** argv, int& code);

}  // namespace surefoot::daemon
