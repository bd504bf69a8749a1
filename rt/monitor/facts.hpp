// Facts about a running walk: plain structs that the session fills, and that reports and monitor show.
#pragma once

#include <string>
#include <string_view>

namespace surefoot::rt {

/// The current source of steering.
struct InputState {
    bool live = false;            ///< devices steer; else a path or a recording
    int devices = 0;              ///< that steer
    bool emergency_stop = false;  ///< latched
    bool walking = false;         ///< on floors and around walls; else the visitor flies
    std::string_view barrier{};   ///< what stops the walker: "wall", "edge"...; empty: nothing. A constant's name.
    std::string_view barrier_help{};
    friend bool operator==(const InputState&, const InputState&) = default;
};

/// One device that steers, in words.
struct SteeringDevice {
    std::string name, device_class, mapping;
};

/// Real-time resources granted to a walk.
struct Granted {
    bool fifo = false, locked = false, isolated = false;
    int frame_core = -1;
};

}  // namespace surefoot::rt
