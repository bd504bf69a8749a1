// The light of a frame: which parts of it are drawn, and the hour of the day. The table names what a visitor may switch.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace surefoot::rt {

/// Which parts of the light are drawn, where the model has them.
struct Switches {
    bool sunlight = true, shadows = true, lamps = true, fog = true;
    bool operator==(const Switches&) const = default;
};

/// So often each was switched since the walk began. The numbers wrap.
struct SwitchPresses {
    std::uint32_t sunlight = 0, shadows = 0, lamps = 0, fog = 0;
};

/// One switch. Its name is that of the action, of the setting and of the ledger's column.
struct Switch {
    std::string_view name;
    bool Switches::*on;
    std::uint32_t SwitchPresses::*presses;
};

/// All of them. To add one: its members above, its row here, and what it hides in tools/walk/light.cpp.
constexpr std::array<Switch, 4> light_switches = {{
    {"sunlight", &Switches::sunlight, &SwitchPresses::sunlight},
    {"shadows", &Switches::shadows, &SwitchPresses::shadows},
    {"lamps", &Switches::lamps, &SwitchPresses::lamps},
    {"fog", &Switches::fog, &SwitchPresses::fog},
}};
constexpr std::size_t switch_count = light_switches.size();

/// A switch's part of the light, where frames buy it.
struct DroppedPart {
    bool dropped = false;  ///< it would show something, and there was no time for it
    bool fell = false;     ///< in this frame
    float fell_at = 0;     ///< of a dropped one: its value per us, in pixels, when it fell
};

/// ShownLight::hour where the model's own light is shown.
constexpr float no_hour = std::numeric_limits<float>::quiet_NaN();

/// The light of one frame.
struct ShownLight {
    Switches on;
    float hour = no_hour;  ///< of the day, from 0 to below 24
};

inline bool has_hour(const ShownLight& light) { return !std::isnan(light.hour); }

/// What is left on of it.
constexpr Switches parts_left(Switches on, const std::array<DroppedPart, switch_count>& parts) {
    for (std::size_t i = 0; i < switch_count; ++i)
        if (parts[i].dropped) on.*light_switches[i].on = false;
    return on;
}

/// What is drawn after so many presses. `at_first`: before the first.
constexpr Switches switched(const Switches& at_first, const SwitchPresses& presses) {
    Switches on;
    for (const Switch& one : light_switches) on.*one.on = at_first.*one.on == (presses.*one.presses % 2 == 0);
    return on;
}

}  // namespace surefoot::rt
