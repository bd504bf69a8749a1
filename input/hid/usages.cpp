// Tables of usages: roles and names.
#include "input/hid/usages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace surefoot::input {

namespace {

struct Named {
    std::uint32_t usage;
    std::string_view control;  ///< name of the control; empty: a collection only
    std::string_view title;    ///< name in a collection's path
};

constexpr Named named[] = {
    {0x00010001, "", "Pointer"},
    {0x00010002, "", "Mouse"},
    {0x00010004, "", "Joystick"},
    {0x00010005, "", "Game Pad"},
    {0x00010006, "", "Keyboard"},
    {0x00010007, "", "Keypad"},
    {0x00010008, "", "Multi-axis Controller"},
    {0x00010009, "", "Tablet PC System Controls"},
    {0x0001000d, "", "Portable Device Control"},
    {0x0001000e, "", "Interactive Control"},
    {0x00010080, "", "System Control"},
    {0x0001003a, "", "Counted Buffer"},
    {0x00010030, "x", "X"},
    {0x00010031, "y", "Y"},
    {0x00010032, "z", "Z"},
    {0x00010033, "rx", "Rx"},
    {0x00010034, "ry", "Ry"},
    {0x00010035, "rz", "Rz"},
    {0x00010036, "slider", "Slider"},
    {0x00010037, "dial", "Dial"},
    {0x00010038, "wheel", "Wheel"},
    {0x00010039, "hat", "Hat Switch"},
    {0x0001003d, "start", "Start"},
    {0x0001003e, "select", "Select"},
    {0x00010040, "vx", "Vx"},
    {0x00010041, "vy", "Vy"},
    {0x00010042, "vz", "Vz"},
    {0x00010043, "vbrx", "Vbrx"},
    {0x00010044, "vbry", "Vbry"},
    {0x00010045, "vbrz", "Vbrz"},
    {0x00010046, "vno", "Vno"},
    {0x00010090, "dpad-up", "D-pad Up"},
    {0x00010091, "dpad-down", "D-pad Down"},
    {0x00010092, "dpad-right", "D-pad Right"},
    {0x00010093, "dpad-left", "D-pad Left"},
    {0x00020001, "", "Flight Simulation Device"},
    {0x00020002, "", "Automobile Simulation Device"},
    {0x00020003, "", "Tank Simulation Device"},
    {0x00020004, "", "Spaceship Simulation Device"},
    {0x00020005, "", "Submarine Simulation Device"},
    {0x00020006, "", "Sailing Simulation Device"},
    {0x00020007, "", "Motorcycle Simulation Device"},
    {0x00020008, "", "Sports Simulation Device"},
    {0x00020009, "", "Airplane Simulation Device"},
    {0x0002000a, "", "Helicopter Simulation Device"},
    {0x0002000b, "", "Magic Carpet Simulation Device"},
    {0x0002000c, "", "Bicycle Simulation Device"},
    {0x00020020, "", "Flight Control Stick"},
    {0x00020021, "", "Flight Stick"},
    {0x00020022, "", "Cyclic Control"},
    {0x00020023, "", "Cyclic Trim"},
    {0x00020024, "", "Flight Yoke"},
    {0x00020025, "", "Track Control"},
    {0x000200b0, "aileron", "Aileron"},
    {0x000200b1, "aileron-trim", "Aileron Trim"},
    {0x000200b2, "anti-torque", "Anti-Torque Control"},
    {0x000200b3, "autopilot", "Autopilot Enable"},
    {0x000200b4, "chaff", "Chaff Release"},
    {0x000200b5, "collective", "Collective Control"},
    {0x000200b6, "dive-brake", "Dive Brake"},
    {0x000200b7, "countermeasures", "Electronic Countermeasures"},
    {0x000200b8, "elevator", "Elevator"},
    {0x000200b9, "elevator-trim", "Elevator Trim"},
    {0x000200ba, "rudder", "Rudder"},
    {0x000200bb, "throttle", "Throttle"},
    {0x000200bc, "flight-communications", "Flight Communications"},
    {0x000200bd, "flare", "Flare Release"},
    {0x000200be, "landing-gear", "Landing Gear"},
    {0x000200bf, "toe-brake", "Toe Brake"},
    {0x000200c0, "trigger", "Trigger"},
    {0x000200c1, "weapons-arm", "Weapons Arm"},
    {0x000200c2, "weapons-select", "Weapons Select"},
    {0x000200c3, "wing-flaps", "Wing Flaps"},
    {0x000200c4, "accelerator", "Accelerator"},
    {0x000200c5, "brake", "Brake"},
    {0x000200c6, "clutch", "Clutch"},
    {0x000200c7, "shifter", "Shifter"},
    {0x000200c8, "steering", "Steering"},
    {0x000200c9, "turret", "Turret Direction"},
    {0x000200ca, "barrel", "Barrel Elevation"},
    {0x000200cb, "dive-plane", "Dive Plane"},
    {0x000200cc, "ballast", "Ballast"},
    {0x000200cd, "bicycle-crank", "Bicycle Crank"},
    {0x000200ce, "handle-bars", "Handle Bars"},
    {0x000200cf, "front-brake", "Front Brake"},
    {0x000200d0, "rear-brake", "Rear Brake"},
    {0x00050001, "", "3D Game Controller"},
    {0x00050002, "", "Pinball Device"},
    {0x00050003, "", "Gun Device"},
    {0x00050020, "", "Point of View"},
    {0x00050021, "turn", "Turn Right/Left"},
    {0x00050022, "pitch", "Pitch Forward/Backward"},
    {0x00050023, "roll", "Roll Right/Left"},
    {0x00050024, "move-side", "Move Right/Left"},
    {0x00050025, "move-forward", "Move Forward/Backward"},
    {0x00050026, "move-up", "Move Up/Down"},
    {0x00050027, "lean-side", "Lean Right/Left"},
    {0x00050028, "lean-forward", "Lean Forward/Backward"},
    {0x00050029, "view-height", "Height of POV"},
    {0x000c0001, "", "Consumer Control"},
    {0x000c0238, "pan", "AC Pan"},
    {0x000b0005, "", "Headset"},
    {0x000d0001, "", "Digitizer"},
    {0x000d0002, "", "Pen"},
    {0x000d0004, "", "Touch Screen"},
    {0x000d0005, "", "Touch Pad"},
    {0x000d000e, "", "Device Configuration"},
    {0x000d0020, "", "Stylus"},
    {0x000d0022, "", "Finger"},
    {0x00200001, "", "Sensor"},
};

const Named* find_named(std::uint32_t usage) {
    const auto* found = std::find_if(std::begin(named), std::end(named), [&](const Named& n) { return n.usage == usage; });
    return found == std::end(named) ? nullptr : found;
}

}  // namespace

Application application_of(std::uint32_t usage) {
    const std::uint32_t p = usage >> 16U, u = usage & 0xffffU;
    switch (p) {
        case 0:
            return Application::none;
        case page::generic_desktop:
            if (u == 0) return Application::none;  // "Undefined" in the tables
            if (u == 0x04 || u == 0x05 || u == 0x08) return Application::steering;
            if (u == 0x01 || u == 0x02) return Application::mouse;
            if (u == 0x06 || u == 0x07) return Application::keyboard;
            if (u == 0x80 || u == 0x09) return Application::system;
            return Application::other;
        case page::simulation:
        case page::game:
            return Application::steering;
        case page::vr:
            return Application::head_tracker;
        case page::keyboard:
            return Application::keyboard;
        case page::telephony:
            return Application::telephony;
        case page::consumer:
            return Application::consumer;
        case page::digitizer:
            return Application::digitizer;
        case page::sensor:
            return Application::sensor;
        case 0x84:
        case 0x85:
            return Application::power;
        default:
            return p >= page::vendor_first ? Application::vendor : Application::other;
    }
}

std::optional<ControlKind> role_of(std::uint32_t usage, std::int64_t range) {
    const std::uint32_t p = usage >> 16U, u = usage & 0xffffU;
    switch (p) {
        case page::generic_desktop:
            if ((u >= 0x30 && u <= 0x38) || (u >= 0x40 && u <= 0x46)) return ControlKind::axis;
            if (u == 0x39) return ControlKind::hat;
            if ((u >= 0x90 && u <= 0x93) || u == 0x3d || u == 0x3e || (u >= 0x81 && u <= 0x8f)) return ControlKind::button;
            return std::nullopt;
        case page::simulation:
            if (u < 0xb0 || u > 0xd0) return std::nullopt;
            return range > 1 ? ControlKind::axis : ControlKind::button;
        case page::game:
            if (u < 0x21 || u > 0x39) return std::nullopt;
            return range > 1 && u <= 0x29 ? ControlKind::axis : ControlKind::button;
        case page::button:
            return u == 0 ? std::nullopt : std::optional(ControlKind::button);
        case page::keyboard:
            return u < 4 ? std::nullopt : std::optional(ControlKind::button);
        case page::consumer:
            if (u == 0x238 && range > 1) return ControlKind::axis;
            return u == 0 || range > 1 ? std::nullopt : std::optional(ControlKind::button);
        case page::telephony:
            return u == 0 || range > 1 ? std::nullopt : std::optional(ControlKind::button);
        default:
            return std::nullopt;
    }
}

bool button_in_array(std::uint32_t usage) { return role_of(usage, 1) == ControlKind::button; }

std::string control_name(std::uint32_t usage) {
    if (const Named* n = find_named(usage); n != nullptr && !n->control.empty()) return std::string(n->control);
    const std::uint32_t p = usage >> 16U, u = usage & 0xffffU;
    switch (p) {
        case page::button:
            return fmt::format("button-{}", u);
        case page::keyboard:
            return fmt::format("key-{:02x}", u);
        case page::consumer:
            return fmt::format("consumer-{:x}", u);
        case page::telephony:
            return fmt::format("phone-{:x}", u);
        case page::generic_desktop:
            return fmt::format("system-{:x}", u);
        case page::simulation:
            return fmt::format("simulation-{:x}", u);
        case page::game:
            return fmt::format("game-{:x}", u);
        default:
            return fmt::format("usage-{:x}-{:x}", p, u);
    }
}

std::string usage_name(std::uint32_t usage) {
    const Named* n = find_named(usage);
    return n == nullptr ? std::string() : std::string(n->title);
}

std::string usage_text(std::uint32_t usage) {
    if (auto name = usage_name(usage); !name.empty()) return name;
    switch (usage >> 16U) {
        case page::button:
            return fmt::format("Button {}", usage & 0xffffU);
        case page::keyboard:
            return fmt::format("Key {:02x}", usage & 0xffffU);
        case page::consumer:
            return fmt::format("Consumer {:x}", usage & 0xffffU);
        default:
            return fmt::format("usage {:04x}:{:04x}", usage >> 16U, usage & 0xffffU);
    }
}

std::string unit_name(std::uint32_t unit) {
    const std::uint32_t system = unit & 0xfU;
    if (system == 0 || system > 4) return unit == 0 ? "" : fmt::format("unit {:x}", unit);
    static constexpr std::array<std::string_view, 4> length{"cm", "rad", "in", "deg"};
    static constexpr std::array<std::string_view, 4> mass{"g", "g", "slug", "slug"};
    static constexpr std::array<std::string_view, 4> temperature{"K", "K", "F", "F"};
    const std::array<std::string_view, 6> bases{length[system - 1], mass[system - 1], "s", temperature[system - 1], "A", "cd"};
    std::string text;
    for (unsigned i = 0; i < bases.size(); ++i) {
        const auto nibble = static_cast<int>((unit >> (4U * (i + 1))) & 0xfU);
        const int power = nibble >= 8 ? nibble - 16 : nibble;
        if (power == 0) continue;
        if (!text.empty()) text += "·";
        text += bases[i];
        if (power != 1) text += fmt::format("^{}", power);
    }
    return text;
}

}  // namespace surefoot::input
