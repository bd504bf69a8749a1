// The subcommands of `surefoot devices`: a file each; devices_list.cpp registers them.
#pragma once

#include "tools/cli/command.hpp"

namespace surefoot::cli {

/// The argument that names one device, for open_devices().
void add_device_choice(CLI::App& command, std::string& device);

/// devices_describe.cpp: a descriptor and recorded reports, without any device.
void add_devices_describe(CLI::App& devices, Context& context);
/// devices_list.cpp: what is plugged in. Also what `surefoot devices` does by itself, with --json of either.
void add_devices_list(CLI::App& devices, Context& context);
/// devices_watch.cpp: what the controls say, live.
void add_devices_watch(CLI::App& devices, Context& context);
/// devices_record.cpp: raw reports to a file.
void add_devices_record(CLI::App& devices, Context& context);
/// devices_map.cpp: a mapping by moving each control.
void add_devices_map(CLI::App& devices, Context& context);

}  // namespace surefoot::cli
