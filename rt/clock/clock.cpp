// Reads time and waits for it: by the machine's clock, and by a clock that only the program moves.
#include "rt/clock/clock.hpp"

#include <time.h>

#include <algorithm>
#include <cerrno>

namespace surefoot::rt {

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;

}  // namespace

std::int64_t monotonic_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * ns_per_s + t.tv_nsec;
}

std::int64_t RealClock::now_ns() const { return monotonic_ns(); }

void RealClock::sleep_until_ns(std::int64_t time_ns) {
    if (time_ns <= now_ns()) return;
    const timespec until{time_ns / ns_per_s, time_ns % ns_per_s};
    // Absolute, so that going on after a signal loses nothing.
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

ThreadUsage RealClock::usage() const { return read_own_usage(); }

void RealClock::burn_ns(std::int64_t cpu_ns) {
    const std::int64_t end = own_cpu_ns() + cpu_ns;
    while (own_cpu_ns() < end) {
    }
}

void VirtualClock::sleep_until_ns(std::int64_t time_ns) {
    if (time_ns <= now_ns_) return;
    ++usage_.voluntary;
    now_ns_ = time_ns + wake_lateness_ns_;
}

void VirtualClock::advance(std::int64_t ns) {
    ns = std::max<std::int64_t>(ns, 0);
    now_ns_ += ns;
    usage_.cpu_ns += ns;
}

void VirtualClock::steal(std::int64_t ns) { now_ns_ += std::max<std::int64_t>(ns, 0); }

void VirtualClock::preempt(std::int64_t ns) {
    steal(ns);
    ++usage_.involuntary;
}

void VirtualClock::wait(std::int64_t ns) {
    steal(ns);
    ++usage_.voluntary;
}

void VirtualClock::fault(std::uint64_t minor, std::uint64_t major) {
    usage_.minor_faults += minor;
    usage_.major_faults += major;
}

}  // namespace surefoot::rt
