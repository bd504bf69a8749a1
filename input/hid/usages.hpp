// The usages this project steers by: their roles, the names of their controls, and HID's units in words.
// Source: "HID Usage Tables" 1.4: pages 0x01, 0x02, 0x05, 0x07, 0x09, 0x0B, 0x0C; HID 1.11, 6.2.2.7 (units).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "input/controls.hpp"

namespace surefoot::input {

namespace page {
constexpr std::uint32_t generic_desktop = 0x01, simulation = 0x02, vr = 0x03, game = 0x05, keyboard = 0x07, button = 0x09,
                        telephony = 0x0b, consumer = 0x0c, digitizer = 0x0d, sensor = 0x20, vendor_first = 0xff00;
}

/// Kind of device that an application collection declares.
enum class Application : std::uint8_t {
    none,
    steering,
    mouse,
    keyboard,
    digitizer,
    consumer,
    system,
    telephony,
    sensor,
    head_tracker,
    power,
    vendor,
    other
};
Application application_of(std::uint32_t usage);

/// Kind of control for a data element with this usage; nothing for usages that do not steer (vendor bytes, batteries, motion
/// sensors, page 0). `range` is logical maximum minus minimum.
std::optional<ControlKind> role_of(std::uint32_t usage, std::int64_t range);
/// The same for a usage of an array: a button or nothing.
bool button_in_array(std::uint32_t usage);

/// "x", "hat", "button-3", "key-2c", "accelerator".
std::string control_name(std::uint32_t usage);
/// "Joystick", "Game Pad"; empty where the tables have no name here.
std::string usage_name(std::uint32_t usage);
/// "Joystick" or "usage ff00:0001".
std::string usage_text(std::uint32_t usage);
/// "deg", "cm", "rad", "cm·s^-1"; empty for none.
std::string unit_name(std::uint32_t unit);

/// ErrorRollOver: the keyboard cannot say which keys are down; the field's last state stands.
constexpr std::uint32_t usage_roll_over = 0x00070001;

}  // namespace surefoot::input
