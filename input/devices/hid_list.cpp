// udev's list of hidraw nodes, and sysfs beside it. Not hid_enumerate(): hidapi 0.13 (Debian 12) takes the length of no text
// where a device goes while the list is made (corrected in 0.14, libusb/hidapi#580), so that a pulled cable would end the walk;
// and it gives no report descriptor, which sysfs gives without opening the device: keyboards and mice are left alone, and a
// device without permission is still known.
#include "input/devices/hid_list.hpp"

#include <fmt/format.h>
#include <libudev.h>
#include <linux/input.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

using UdevDevice = std::unique_ptr<udev_device, udev_device* (*)(udev_device*)>;

std::string text_or_empty(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// The value behind `key=` in lines of text.
std::string_view value_of(std::string_view lines, std::string_view key) {
    while (!lines.empty()) {
        const auto end = std::min(lines.find('\n'), lines.size());
        const std::string_view line = lines.substr(0, end);
        if (line.size() > key.size() && line.starts_with(key) && line[key.size()] == '=') return line.substr(key.size() + 1);
        lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    return {};
}

std::uint16_t hex_part(std::string_view& text) {
    const auto end = std::min(text.find(':'), text.size());
    const auto value = leading_number<std::uint32_t>(text.substr(0, end), 0, 16);
    text.remove_prefix(std::min(end + 1, text.size()));
    return static_cast<std::uint16_t>(value);
}

/// Lines "KEY=value" of the HID device above a node; empty where it is gone.
std::string hid_facts(udev_device* node) {
    udev_device* hid = udev_device_get_parent_with_subsystem_devtype(node, "hid", nullptr);
    return hid == nullptr ? std::string() : text_or_empty(udev_device_get_sysattr_value(hid, "uevent"));
}

/// On a bus that hidapi opens.
bool is_real(std::string_view facts) {
    std::string_view id = value_of(facts, "HID_ID");
    const std::uint16_t bus = hex_part(id);
    return bus == BUS_USB || bus == BUS_BLUETOOTH || bus == BUS_I2C || bus == BUS_SPI;
}

}  // namespace

std::vector<ListedNode> list_nodes(udev* context) {
    std::vector<ListedNode> nodes;
    const std::unique_ptr<udev_enumerate, udev_enumerate* (*)(udev_enumerate*)> all(udev_enumerate_new(context),
                                                                                    udev_enumerate_unref);
    if (!all || udev_enumerate_add_match_subsystem(all.get(), "hidraw") < 0 || udev_enumerate_scan_devices(all.get()) < 0)
        return nodes;
    udev_list_entry* entry = nullptr;
    udev_list_entry_foreach(entry, udev_enumerate_get_list_entry(all.get())) {
        const char* place = udev_list_entry_get_name(entry);
        if (place == nullptr) continue;
        const UdevDevice device(udev_device_new_from_syspath(context, place), udev_device_unref);
        if (!device) continue;  // gone meanwhile
        const std::string node = text_or_empty(udev_device_get_devnode(device.get()));
        if (!node.empty() && is_real(hid_facts(device.get()))) nodes.push_back({node, place});
    }
    return nodes;
}

PluggedDevice read_node(udev* context, const ListedNode& node, std::optional<Error>& trouble) {
    PluggedDevice p;
    p.node = node.node;
    p.place = node.place;
    const UdevDevice device(udev_device_new_from_syspath(context, node.place.c_str()), udev_device_unref);
    if (device) {
        const std::string facts = hid_facts(device.get());
        p.name = value_of(facts, "HID_NAME");
        p.socket = value_of(facts, "HID_PHYS");
        p.serial = value_of(facts, "HID_UNIQ");
        std::string_view id = value_of(facts, "HID_ID");
        p.bus = hex_part(id);
        p.vendor = hex_part(id);
        p.product = hex_part(id);
    }
    const std::string file = node.place + "/device/report_descriptor";
    auto bytes = read_file(file, 2 * max_descriptor_bytes);
    if (!bytes) {
        trouble = bytes.error();
        return p;
    }
    p.descriptor = std::move(*bytes);
    auto layout = read_descriptor(p.descriptor, fmt::format("{} ({})", p.node, p.name));
    if (!layout)
        trouble = layout.error();
    else
        p.device = describe_device(std::move(*layout), {p.vendor, p.product, p.name});
    return p;
}

}  // namespace surefoot::input
