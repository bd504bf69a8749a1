// A recorded session of a gamepad that nobody built: its descriptor, and reports written as hid-recorder writes them.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "input/replay/recording.hpp"

namespace surefoot::input::test {

/// Two sticks of 0..255 (x y, z rz) and eight buttons, five bytes a report. By default: left stick walks, right stick turns and
/// looks; buttons next viewpoint, reset, tour, pause.
class GamepadSession {
public:
    enum Button : unsigned { next_viewpoint = 1, reset = 2, tour = 4, pause = 8, fifth = 16 };

    GamepadSession() {
        static constexpr unsigned char descriptor[] = {
            0x05, 0x01, 0x09, 0x05, 0xa1, 0x01,                          // Generic Desktop, Game Pad, application
            0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x04,        // four bytes, 0..255
            0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x09, 0x35, 0x81, 0x02,  // X, Y, Z, Rz
            0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02,  // eight buttons
            0xc0};
        for (const unsigned char byte : descriptor) recording_.descriptor.push_back(static_cast<std::byte>(byte));
        recording_.name = "session-pad";
        recording_.place = "test";
        recording_.bus = 3;
        recording_.vendor = 0x1d50;
        recording_.product = 0x9001;
    }

    /// Deflections -1..1: side and forward of the left stick, turn to the left and look up of the right one.
    struct Hand {
        double side = 0, forward = 0, turn = 0, look = 0;
        unsigned buttons = 0;
    };
    /// One report, `after_us` after the last one.
    GamepadSession& report(const Hand& hand, std::int64_t after_us = 0) {
        const auto counts = [](double deflection) { return static_cast<std::byte>(128 + static_cast<int>(127 * deflection)); };
        const std::byte bytes[] = {counts(hand.side), counts(-hand.forward), counts(-hand.turn), counts(-hand.look),
                                   static_cast<std::byte>(hand.buttons)};
        recording_.add(time_us_ += after_us, bytes);
        return *this;
    }
    /// The hand keeps still for so long while the pad reports on.
    GamepadSession& hold(const Hand& hand, double seconds, std::int64_t every_us = 4000) {
        const auto count = std::lround(seconds * 1e6 / static_cast<double>(every_us));
        for (long i = 0; i < count; ++i) report(hand, every_us);
        return *this;
    }
    /// A press and its release, 100 ms each.
    GamepadSession& press(unsigned button) { return hold({.buttons = button}, 0.1).hold({}, 0.1); }

    [[nodiscard]] const Recording& recording() const { return recording_; }
    [[nodiscard]] Recording& recording() { return recording_; }
    [[nodiscard]] std::string text() const { return write_recording(recording_); }

private:
    Recording recording_;
    std::int64_t time_us_ = 0;
};

/// Three seconds forward, a turn to the left by about a right angle, two seconds forward, rest.
inline GamepadSession walk_and_turn() {
    GamepadSession s;
    s.report({});
    s.hold({}, 0.3)
        .hold({.forward = 1}, 3)
        .hold({}, 0.5)
        .hold({.turn = 1}, 1.35)
        .hold({}, 0.5)
        .hold({.forward = 1}, 2)
        .hold({}, 0.5);
    return s;
}

/// Ten thousand reports at 1 kHz with every sort of movement in them, the first at rest.
inline GamepadSession ten_thousand_events() {
    GamepadSession session;
    session.report({});
    for (int i = 1; i < 10'000; ++i) {
        const double t = i * 1e-3;
        session.report(
            {.side = 0.5 * std::sin(3 * t), .forward = std::sin(t), .turn = std::sin(0.7 * t), .look = 0.2 * std::sin(2 * t)},
            1000);
    }
    return session;
}

}  // namespace surefoot::input::test
