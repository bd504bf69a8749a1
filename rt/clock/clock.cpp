// CLOCK_MONOTONIC with absolute sleeps: a late wake-up does not shift the next one.
#include "rt/clock/clock.hpp"

#include <cerrno>
#include <ctime>

namespace surefoot::rt {

namespace {
constexpr std::int64_t ns_per_s = 1'000'000'000;
}

std::int64_t RealClock::now_ns() const {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * ns_per_s + t.tv_nsec;
}

void RealClock::sleep_until_ns(std::int64_t due_ns) {
    timespec t{};
    t.tv_sec = due_ns / ns_per_s;
    t.tv_nsec = due_ns % ns_per_s;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

}  // namespace surefoot::rt
