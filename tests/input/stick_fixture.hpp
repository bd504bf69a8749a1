// Devices made by hand for the tests of input/: controls, states and a walk driven in virtual time.
#pragma once

#include <string>
#include <vector>

#include "input/steering.hpp"

namespace surefoot::input::test {

constexpr std::int64_t tick_ns = 1'000'000;

inline ControlInfo axis(std::string name, std::uint16_t usage, std::int32_t min, std::int32_t max,
                        std::string collection = "Joystick", std::uint16_t page = 0x01) {
    ControlInfo c;
    c.name = std::move(name);
    c.collection = std::move(collection);
    c.usage_page = page;
    c.usage = usage;
    c.logical_min = min;
    c.logical_max = max;
    return c;
}
inline ControlInfo button(int number, std::string collection = "Joystick") {
    ControlInfo c =
        axis("button-" + std::to_string(number), static_cast<std::uint16_t>(number), 0, 1, std::move(collection), 0x09);
    c.kind = ControlKind::button;
    return c;
}
inline ControlInfo hat(std::string collection = "Joystick") {
    ControlInfo c = axis("hat", 0x39, 0, 7, std::move(collection));
    c.kind = ControlKind::hat;
    return c;
}

inline void set(DeviceState& state, std::size_t control, std::int32_t value) {
    state.value[control] = value;
    state.has_value.set(control);
}

/// x and y of 0..255 as one stick, and buttons; forward is up.
inline std::vector<ControlInfo> stick_controls() {
    return {axis("x", 0x30, 0, 255), axis("y", 0x31, 0, 255), button(1), button(2), button(3)};
}
inline DeviceMapping stick_mapping(const Shape& shape = {}) {
    DeviceMapping m;
    m.name = "stick";
    StickMapping s;
    s.controls = {ControlRef{"x", 0, 0, ""}, ControlRef{"y", 0, 0, ""}};
    s.actions = {Action::side, Action::forward};
    s.invert = {false, true};
    s.shape = shape;
    m.sticks.push_back(s);
    return m;
}

/// A walk with sticks that report every millisecond, in virtual time.
class Walk {
public:
    explicit Walk(const MotionLimits& motion = {}, const SafetyLimits& safety = {}) : steering(motion, safety) {}

    int plug(const DeviceMapping& mapping = stick_mapping(), Reporting reporting = Reporting::streaming, int again = -1) {
        const auto controls = stick_controls();
        auto compiled = compile(mapping, controls);
        steering.steers.plays();
        return steering.attach(std::move(*compiled), controls.size(), reporting, again);
    }
    void send(int device, std::int32_t x, std::int32_t y) {
        set(state, 0, x);
        set(state, 1, y);
        state.stamp_ns = now_ns;
        steering.steers.plays();
        steering.report(device, state, now_ns);
    }
    NavigationSample tick(std::int64_t step_ns = tick_ns) {
        steering.steers.plays();
        now_ns += step_ns;
        return last = steering.tick(lines, now_ns);
    }
    /// Sends and ticks for so long.
    NavigationSample hold(int device, std::int32_t x, std::int32_t y, int milliseconds) {
        for (int i = 0; i < milliseconds; ++i) {
            send(device, x, y);
            drained(device, 1);
            tick();
        }
        return last;
    }
    void drained(int device, std::uint32_t reports, bool lost = false) {
        steering.steers.plays();
        steering.drained(device, reports, lost);
    }
    void detach(int device) {
        steering.steers.plays();
        steering.detach(device);
    }
    [[nodiscard]] const SafetyState& safety() const {
        steering.steers.plays();
        return steering.safety();
    }
    [[nodiscard]] double speed() const { return glm::length(last.velocity_m_s); }

    Steering steering;
    Lines lines;
    DeviceState state;
    std::int64_t now_ns = 1'000'000'000;
    NavigationSample last;
};

}  // namespace surefoot::input::test
