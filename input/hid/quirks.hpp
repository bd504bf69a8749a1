// Quirks: a table of devices whose descriptors are wrong or incomplete. Each row has a test.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace surefoot::input {

/// USB or Bluetooth ids, both 0 where unknown, and the product's name, empty where unknown.
struct DeviceId {
    std::uint16_t vendor = 0, product = 0;
    std::string_view name = {};
    [[nodiscard]] bool known() const { return vendor != 0; }
};

enum class QuirkEffect : std::uint8_t {
    deflections,  ///< axes of a multi-axis controller call themselves relative, but are deflections
    trackball,    ///< calls itself a mouse, but is a ball in a fixed housing
};

/// A correction for devices whose descriptor is wrong.
struct Quirk {
    std::uint16_t vendor = 0;
    std::uint16_t first_product = 0, last_product = 0xffff;
    QuirkEffect effect = QuirkEffect::deflections;
    std::string_view why;
};

std::span<const Quirk> quirk_table();
/// A pointing device that is named a trackball is one (systemd's 70-mouse.hwdb goes by the name as well).
bool named_trackball(std::string_view name);
/// The row for this device and effect, or null.
const Quirk* find_quirk(DeviceId id, QuirkEffect effect);

}  // namespace surefoot::input
