// Writes the recording that switches the light on a tour: a gamepad starts the tour, and then its other four buttons are pressed
// one after the other, one each 0.7 s. bench_switch_recording SECONDS -> the text of a recording, for walk --input.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "tests/input/gamepad_session.hpp"

int main(int argc, char** argv) {
    using Session = surefoot::input::test::GamepadSession;
    const double seconds = argc > 1 ? std::atof(argv[1]) : 10;
    Session session;
    session.report({}).hold({}, 0.3).press(Session::tour);
    constexpr double every_s = 0.7, held_s = 0.1;
    constexpr std::int64_t step_us = 20'000;
    for (double t = 0; t < seconds; t += every_s) {
        const auto button = static_cast<unsigned>(Session::fifth) << static_cast<unsigned>(std::lround(t / every_s) % 4);
        session.hold({.buttons = button}, held_s, step_us).hold({}, every_s - held_s, step_us);
    }
    fmt::print("{}", session.text());
    return 0;
}
