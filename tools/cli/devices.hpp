// The subcommands of `surefoot devices`: a file each, registered here.
#pragma once

#include "tools/cli/command.hpp"

namespace surefoot::cli {

/// devices_describe.cpp: a descriptor and recorded reports, without any device.
void add_devices_describe(CLI::App& devices, Context& context);

}  // namespace surefoot::cli
