// surefoot devices: what controls there are; each job is a subcommand of its own, and without one they are listed.
#include "tools/cli/devices.hpp"

namespace surefoot::cli {

void add_devices(CLI::App& app, Context& context) {
    CLI::App* c = app.add_subcommand("devices", "List, watch, record and map joysticks, 3D mice, pedals and buttons");
    c->footer(
        "Without a subcommand, devices are listed.\n\nExample:\n  surefoot devices\n  surefoot devices watch\n  surefoot devices "
        "map -o "
        "steering.toml");
    c->require_subcommand(0, 1);
    add_devices_list(*c, context);
    add_devices_watch(*c, context);
    add_devices_record(*c, context);
    add_devices_map(*c, context);
    add_devices_describe(*c, context);
}

}  // namespace surefoot::cli
