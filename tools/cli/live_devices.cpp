// Shared by the commands on live devices.
#include "tools/cli/live_devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "rt/clock/clock.hpp"

namespace surefoot::cli {

namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string ids(const input::PluggedDevice& d) { return fmt::format("{:04x}:{:04x}", d.vendor, d.product); }

const char* bus_name(std::uint16_t bus) {
    switch (bus) {
        case 3:
            return "usb";
        case 5:
            return "bluetooth";
        case 0x18:
            return "i2c";
        case 0x1c:
            return "spi";
        default:
            return "other";
    }
}

}  // namespace

bool means(const std::string& text, const input::PluggedDevice& d) {
    if (text == d.node || "/dev/" + text == d.node || lower(text) == ids(d)) return true;
    return text.size() >= 3 && !text.starts_with("/dev/") && !text.starts_with("hidraw") &&
           lower(d.name).find(lower(text)) != std::string::npos;
}

std::string device_line(const input::PluggedDevice& d) { return fmt::format("{:<14} {}  {}", d.node, ids(d), d.name); }

nlohmann::ordered_json device_json(const input::PluggedDevice& d) {
    return {{"node", d.node},
            {"name", d.name},
            {"vid_pid", ids(d)},
            {"bus", bus_name(d.bus)},
            {"serial", d.serial},
            {"socket", d.socket},
            {"identity", d.identity()},
            {"class", input::class_name(d.device.device_class)},
            {"reason", d.device.reason},
            {"controls", d.device.controls.size()}};
}

Result<std::vector<input::Discovery>> plugged_devices() {
    input::FinderOptions options;
    options.open = false;
    options.wanted = [](const input::PluggedDevice&) { return true; };
    auto finder = input::Finder::create(std::move(options));
    if (!finder) return finder.error();
    auto all = finder->look(rt::monotonic_ns());
    std::sort(all.begin(), all.end(), [](const input::Discovery& a, const input::Discovery& b) {
        const std::string &x = a.plugged->node, &y = b.plugged->node;
        return x.size() != y.size() ? x.size() < y.size() : x < y;  // hidraw9 before hidraw10
    });
    return all;
}

Result<DevicePointer> one_device(const std::string& text) {
    auto all = plugged_devices();
    if (!all) return all.error();
    std::vector<const input::Discovery*> meant;
    std::string there;
    for (const input::Discovery& d : *all) {
        if (means(text, *d.plugged)) meant.push_back(&d);
        there += (there.empty() ? "" : "; ") + fmt::format("{} {} {}", d.plugged->node, ids(*d.plugged), d.plugged->name);
    }
    if (meant.empty()) {
        return Error{text, "No such device is plugged in",
                     there.empty() ? "Plug one in: there is no HID device at all" : "Name one of: " + there,
                     ErrorKind::not_found};
    }
    if (meant.size() > 1)
        return Error{text, fmt::format("The name fits {} devices", meant.size()), "Name one by its node: " + there,
                     ErrorKind::misuse};
    if (meant.front()->kind == input::Discovery::Kind::refused) return meant.front()->why;
    return meant.front()->plugged;
}

Result<std::unique_ptr<input::LiveDevices>> open_devices(const std::string& text) {
    input::FinderOptions options;
    if (!text.empty()) options.wanted = [text](const input::PluggedDevice& d) { return means(text, d); };
    return input::open_live(std::move(options));
}

LiveStates::Device* LiveStates::take(const input::DeviceEvent& e) {
    if (e.kind == input::DeviceEvent::Kind::added) {
        devices_[e.device] = std::make_unique<Device>(e.plugged);
        devices_[e.device]->first_ns = e.stamp_ns;
    }
    const auto found = devices_.find(e.device);
    if (found == devices_.end()) return nullptr;
    if (e.kind == input::DeviceEvent::Kind::removed) {
        devices_.erase(found);
        return nullptr;
    }
    Device& d = *found->second;
    if (e.kind == input::DeviceEvent::Kind::report &&
        d.decoder.decode(e.bytes, e.stamp_ns, d.state) == input::ReportFate::accepted) {
        d.changed = true;
    }
    return &d;
}

std::int64_t end_after(double seconds) {
    return seconds > 0 ? rt::monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9) : std::numeric_limits<std::int64_t>::max();
}

}  // namespace surefoot::cli
