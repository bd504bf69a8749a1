// surefoot devices list: what is plugged in, what it would steer with, and why it would not; and the
// group of commands `surefoot devices`.
#include <fmt/format.h>
#include <unistd.h>

#include "input/map/mapping.hpp"
#include "tools/cli/devices.hpp"
#include "tools/cli/live_devices.hpp"

namespace surefoot::cli {

namespace {

using nlohmann::ordered_json;

struct ListArguments {
    bool json = false, parent_json = false;
};

bool permitted(const input::PluggedDevice& d) { return access(d.node.c_str(), R_OK | W_OK) == 0; }

ordered_json control_names_json(const input::HidDevice& device) {
    ordered_json list = ordered_json::array();
    for (const auto& c : device.controls)
        list.push_back({{"name", c.name},
                        {"kind", input::kind_name(c.kind)},
                        {"collection", c.collection},
                        {"logical_min", c.logical_min},
                        {"logical_max", c.logical_max},
                        {"relative", c.relative}});
    return list;
}

std::string default_name(const input::PluggedDevice& d) {
    return input::default_mapping(d.device.controls, d.device.device_class).name;
}

ordered_json list_json(const std::vector<input::Discovery>& all) {
    ordered_json list = ordered_json::array();
    for (const auto& d : all) {
        ordered_json device = device_json(*d.plugged);
        const bool whole = d.kind != input::Discovery::Kind::refused;
        device["permitted"] = permitted(*d.plugged);
        device["steers"] = whole && input::steers_by_class(*d.plugged);
        if (whole) {
            device["mapping"] = default_name(*d.plugged);
            device["quirks"] = d.plugged->device.quirks;
            device["controls"] = control_names_json(d.plugged->device);
        } else {
            device["reason"] = d.why.text();
        }
        list.push_back(std::move(device));
    }
    return {{"devices", std::move(list)}};
}

void print_list(const std::vector<input::Discovery>& all) {
    if (all.empty()) fmt::print("No HID device is plugged in.\n");
    for (const auto& d : all) {
        const auto& device = *d.plugged;
        fmt::print("{}\n", device_line(device));
        if (d.kind == input::Discovery::Kind::refused) {
            fmt::print("    refused: {}\n", d.why.text());
            continue;
        }
        fmt::print("    {}: {}\n", input::class_name(device.device.device_class), device.device.reason);
        if (input::steers_by_class(device))
            fmt::print("    steers by \"{}\"{}\n", default_name(device),
                       permitted(device)
                           ? ""
                           : "; but this user cannot open it: see systemd/70-surefoot.rules and the group surefoot-input");
    }
}

int run_list(const ListArguments& a) {
    const auto all = plugged_devices();
    if (!all) return fail(all.error());
    if (a.json || a.parent_json)
        print_json(list_json(*all));
    else
        print_list(*all);
    return exit_success;
}

}  // namespace

void add_devices_list(CLI::App& devices, Context& context) {
    auto a = std::make_shared<ListArguments>();
    CLI::App* c = add_command(devices, "list", "List connected devices with their class and default mapping",
                              "surefoot devices list --json", a->json);
    c->callback([&context, a] { context.run = [a] { return run_list(*a); }; });
    devices.add_flag("--json", a->parent_json, "Print the list as one JSON object");
    devices.callback([&devices, &context, a] {
        if (devices.get_subcommands().empty()) context.run = [a] { return run_list(*a); };
    });
}

void add_device_choice(CLI::App& command, std::string& device) {
    command.add_option("device", device,
                       "Only this one: its node, its ids (046d:c626), or a part of its name; all that steer if left out");
}

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
