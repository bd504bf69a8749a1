// A stick of two bytes for the tests of live devices: what it declares, and what it reports.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "input/replay/recording.hpp"
#include "input/steering.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input::test {

/// x and y, -127..127, one signed byte each: "default: joystick" turns by x and walks by y.
inline Recording stick(std::uint16_t product = 0x8001) {
    Recording r;
    r.descriptor = hex("05 01 09 04 a1 01 15 81 25 7f 75 08 95 02 09 30 09 31 81 02 c0");
    r.name = "test stick";
    r.bus = 3;
    r.vendor = 0x1d50;
    r.product = product;
    return r;
}
inline std::vector<std::byte> at(int x, int y) { return {static_cast<std::byte>(x), static_cast<std::byte>(y)}; }

/// The steering's numbers that a device has, as of the last tick.
inline std::vector<int> connected_numbers(const Steering& steering) {
    steering.steers.plays();
    std::vector<int> numbers;
    for (std::size_t i = 0; i < max_devices; ++i)
        if (steering.safety().devices[i].connected) numbers.push_back(static_cast<int>(i));
    return numbers;
}

}  // namespace surefoot::input::test
