// The keys of a window that may steer: X keysyms, and the usages that a HID keyboard would send for them.
// Source: "HID Usage Tables" 1.4, page 0x07; <X11/keysymdef.h>.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace surefoot::input {

/// One key. Its control's name is "key-" and this name.
struct WindowKey {
    std::string_view name;
    std::uint32_t symbol = 0;  ///< X keysym without modifiers
    std::uint16_t usage = 0;   ///< of page 0x07
};

/// All of them, at most 64: a report has a bit for each.
std::span<const WindowKey> window_keys();
/// Index of the key; -1: none of them.
int window_key_of(std::uint32_t symbol);

constexpr std::uint32_t symbol_escape = 0xff1b, symbol_f11 = 0xffc8;

}  // namespace surefoot::input
