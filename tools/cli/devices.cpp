// surefoot devices: what controls there are; each job is a subcommand of its own.
#include "tools/cli/devices.hpp"

namespace surefoot::cli {

void add_devices(CLI::App& app, Context& context) {
    CLI::App* c = app.add_subcommand("devices", "Joysticks, 3D mice, pedals and buttons: what they are and what they say");
    c->footer("Example:\n  surefoot devices describe /sys/class/hidraw/hidraw0/device/report_descriptor");
    c->require_subcommand(1);
    add_devices_describe(*c, context);
}

}  // namespace surefoot::cli
