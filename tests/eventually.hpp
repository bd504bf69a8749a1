// Waiting for a condition that nobody announces: the other side is another process, the kernel, or a thread that counts silently.
// This is the one place where tests look again and again. Where the other side tells, wait for what it tells.
#pragma once

#include <time.h>

#include <cstdint>

#include "rt/clock/clock.hpp"

namespace surefoot::test {

/// Whether the condition holds at some moment within `seconds`. Looks every 5 ms.
template <class Condition>
bool eventually(double seconds, const Condition& condition) {
    constexpr timespec pause{0, 5'000'000};
    const std::int64_t until_ns = rt::monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
    while (!condition()) {
        if (rt::monotonic_ns() >= until_ns) return false;
        (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
    }
    return true;
}

}  // namespace surefoot::test
