// Device nodes: controls, wired buttons, graphics; and whether the service's groups may open them.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::uint32_t group_read_write = 0060;
constexpr std::string_view install_rule =
    "groupadd -f --system surefoot-input && cp 70-surefoot.rules /etc/udev/rules.d/ && udevadm control --reload && udevadm "
    "trigger";

std::vector<std::string> nodes(const Machine& m, const std::string& folder, std::string_view prefix) {
    std::vector<std::string> found;
    for (const std::string& name : m.names(folder).value_or(std::vector<std::string>{})) {
        if (name.starts_with(prefix)) found.push_back(folder + "/" + name);
    }
    return found;
}

/// Nodes that a group of the service may open, by its number: all of them, or which not.
Finding opened_by(const Machine& m, const std::vector<std::string>& found, std::initializer_list<std::string_view> groups,
                  std::string_view remedy) {
    std::string refused, names;
    for (const std::string_view group : groups) names += (names.empty() ? "" : " or ") + std::string(group);
    for (const std::string& path : found) {
        const auto node = m.node(path);
        bool open = false;
        for (const std::string_view group : groups)
            open = open || (node && m.group(group) == node->group && (node->mode & group_read_write) == group_read_write);
        if (!open) refused += fmt::format("{}{} (mode {:04o})", refused.empty() ? "" : ", ", path, node ? node->mode : 0U);
    }
    if (refused.empty())
        return pass(fmt::format("{} node{}, which group {} can open", found.size(), found.size() == 1 ? "" : "s", names));
    return fail(fmt::format("group {} cannot open: {}", names, refused), std::string(remedy));
}

Finding controls(const Machine& m) {
    const auto found = nodes(m, "/dev", "hidraw");
    if (found.empty())
        return unknown("there is no /dev/hidraw*", "plug in a control; if there is still none: modprobe hid-generic");
    return opened_by(m, found, {"surefoot-input"}, install_rule);
}

Finding wires(const Machine& m) {
    const auto found = nodes(m, "/dev", "gpiochip");
    if (found.empty())
        return unknown("there is no /dev/gpiochip*",
                       "nothing to do without wired buttons; with them: modprobe the board's GPIO driver");
    return opened_by(m, found, {"surefoot-input", "gpio"},
                     "echo 'SUBSYSTEM==\"gpio\", KERNEL==\"gpiochip*\", GROUP=\"surefoot-input\", MODE=\"0660\"' > "
                     "/etc/udev/rules.d/71-surefoot-gpio.rules; udevadm trigger");
}

Finding graphics(const Machine& m) {
    const auto found = nodes(m, "/dev/dri", "renderD");
    if (found.empty())
        return unknown("there is no /dev/dri/renderD*",
                       "nothing to do with software GL; else: apt install the graphics card's driver");
    return opened_by(m, found, {"render", "video"},
                     "systemctl edit surefootd, and add: [Service] SupplementaryGroups=render video");
}

Finding group(const Machine& m) {
    if (!m.text("/etc/group")) return unknown("/etc/group cannot be read", "see getent group surefoot-input");
    if (const auto number = m.group("surefoot-input")) return pass(fmt::format("group surefoot-input is {}", *number));
    return fail("there is no group surefoot-input", "groupadd -f --system surefoot-input");
}

Finding rule(const Machine& m) {
    bool folder = false;
    for (const auto* place : {"/etc/udev/rules.d", "/usr/lib/udev/rules.d", "/lib/udev/rules.d"}) {
        folder = folder || m.exists(place);
        const std::string file = std::string(place) + "/70-surefoot.rules";
        if (m.exists(file)) return pass(file + " exists");
    }
    if (!folder) return unknown("there is no udev on this machine (no rules.d)", "apt install udev");
    return fail("70-surefoot.rules is not installed: the service cannot open controls", std::string(install_rule));
}

constexpr std::array all_device_checks = {
    Check{"devices.hidraw", "controls can be opened", controls},
    Check{"devices.gpio", "GPIO chips can be opened", wires},
    Check{"devices.dri", "the GPU can be opened", graphics},
    Check{"devices.group", "the group surefoot-input exists", group},
    Check{"devices.udev_rule", "the udev rule is installed", rule},
};

}  // namespace

std::span<const Check> device_checks() { return all_device_checks; }

}  // namespace surefoot::doctor
