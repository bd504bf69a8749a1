// What is known of a running walk beside its figures: plain structs that the session fills, and reports and monitor show.
#pragma once

#include <string>

namespace surefoot::rt {

/// What steers now.
struct InputState {
    bool live = false;            ///< devices steer; else a path or a recording
    int devices = 0;              ///< that steer
    bool emergency_stop = false;  ///< latched
    friend bool operator==(const InputState&, const InputState&) = default;
};

/// One device that steers, in words.
struct SteeringDevice {
    std::string name, device_class, mapping;
};

/// What the machine has granted to a walk.
struct Granted {
    bool fifo = false, locked = false, isolated = false;
    int frame_core = -1;
};

}  // namespace surefoot::rt
