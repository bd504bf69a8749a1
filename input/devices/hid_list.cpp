// hidapi's list, and sysfs beside it: hidapi 0.13 (Debian 12) gives no report descriptor, and sysfs gives it without opening the
// device, so that keyboards and mice are left alone and a device without permission is still known.
#include "input/devices/hid_list.hpp"

#include <fmt/format.h>
#include <hidapi.h>
#include <libudev.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "rt/base/file.hpp"

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
    std::uint32_t value = 0;
    std::from_chars(text.data(), text.data() + end, value, 16);
    text.remove_prefix(std::min(end + 1, text.size()));
    return static_cast<std::uint16_t>(value);
}

}  // namespace

std::vector<ListedNode> list_nodes(udev* context) {
    std::vector<ListedNode> nodes;
    hid_device_info* list = hid_enumerate(0, 0);
    for (const hid_device_info* i = list; i != nullptr; i = i->next) {
        if (i->path == nullptr) continue;
        const std::string node = i->path;
        if (std::any_of(nodes.begin(), nodes.end(), [&](const ListedNode& n) { return n.node == node; })) continue;
        const std::string sysname = node.substr(node.rfind('/') + 1);
        const UdevDevice device(udev_device_new_from_subsystem_sysname(context, "hidraw", sysname.c_str()), udev_device_unref);
        if (device) nodes.push_back({node, text_or_empty(udev_device_get_syspath(device.get()))});
    }
    hid_free_enumeration(list);
    return nodes;
}

PluggedDevice read_node(udev* context, const ListedNode& node, std::optional<Error>& trouble) {
    PluggedDevice p;
    p.node = node.node;
    p.place = node.place;
    const UdevDevice device(udev_device_new_from_syspath(context, node.place.c_str()), udev_device_unref);
    udev_device* hid = device ? udev_device_get_parent_with_subsystem_devtype(device.get(), "hid", nullptr) : nullptr;
    if (hid != nullptr) {
        const std::string facts = text_or_empty(udev_device_get_sysattr_value(hid, "uevent"));
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
