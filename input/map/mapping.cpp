// Names of actions, and which mapping fits a device.
#include "input/map/mapping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace surefoot::input {

namespace {

constexpr std::array<std::string_view, action_count> names_of_actions = {
    "none", "forward", "side",     "up",      "turn",  "look", "speed",    "zoom", "next_viewpoint", "reset",
    "tour", "pause",   "sunlight", "shadows", "lamps", "fog",  "dead_man", "stop", "stop_reset"};

bool contains_letters(std::string_view text, std::string_view part) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end() || part.empty();
}

}  // namespace

std::span<const std::string_view> action_names() { return names_of_actions; }
std::string_view name_of(Action action) { return names_of_actions[static_cast<std::size_t>(action)]; }

std::string ControlRef::text() const {
    const std::string what = name.empty() ? fmt::format("0x{:02x}:0x{:02x}", usage_page, usage) : fmt::format("'{}'", name);
    return collection.empty() ? what : fmt::format("{} in '{}'", what, collection);
}

bool matches(const DeviceMatch& match, const DeviceIdentity& identity) {
    return match.vendor.value_or(identity.vendor) == identity.vendor &&
           match.product.value_or(identity.product) == identity.product &&
           match.device_class.value_or(identity.device_class) == identity.device_class &&
           contains_letters(identity.product_name, match.product_name);
}

const DeviceMapping* find_mapping(std::span<const DeviceMapping> mappings, const DeviceIdentity& identity) {
    const auto found =
        std::find_if(mappings.begin(), mappings.end(), [&](const DeviceMapping& m) { return matches(m.match, identity); });
    return found == mappings.end() ? nullptr : &*found;
}

}  // namespace surefoot::input
