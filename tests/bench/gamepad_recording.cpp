// Writes the recording that latency is measured with: ten seconds of a gamepad at 1 kHz, all sticks moving.
// bench_gamepad_recording -> the text of a recording, for walk --input.
#include <fmt/format.h>

#include "tests/input/gamepad_session.hpp"

int main() {
    fmt::print("{}", surefoot::input::test::ten_thousand_events().text());
    return 0;
}
