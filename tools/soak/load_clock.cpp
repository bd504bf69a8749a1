// Steps of the time of day, there and back: a walk runs on CLOCK_MONOTONIC and must not notice. Whatever ends this process but
// SIGKILL, the last step is undone first.
#include <time.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "tools/soak/load_board.hpp"

namespace surefoot::soak {

namespace {

volatile std::sig_atomic_t stop_requested = 0;

std::int64_t ns_of(const timespec& t) { return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec; }

std::int64_t read_ns(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return ns_of(now);
}

/// How far the time of day lies before the monotonic clock; read between two readings of that.
std::int64_t offset_ns() {
    const std::int64_t before = read_ns(CLOCK_MONOTONIC), day = read_ns(CLOCK_REALTIME), after = read_ns(CLOCK_MONOTONIC);
    return day - (before + (after - before) / 2);
}

bool set_offset(std::int64_t offset) {
    const std::int64_t day = read_ns(CLOCK_MONOTONIC) + offset;
    const timespec time{static_cast<time_t>(day / 1'000'000'000), static_cast<long>(day % 1'000'000'000)};
    return clock_settime(CLOCK_REALTIME, &time) == 0;
}

void sleep_until_stopped(std::int64_t ms, const std::atomic<bool>& stop) {
    for (std::int64_t i = 0; i < ms / 10 && stop_requested == 0 && !stop.load(); ++i) {
        const timespec time{0, 10'000'000};
        nanosleep(&time, nullptr);
    }
}

}  // namespace

void run_clock_steps(LoadBoard& board, const LoadSettings& settings) {
    LoadCounters& c = board.of(LoadKind::clock);
    struct sigaction end {};
    end.sa_handler = [](int) { stop_requested = 1; };
    for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGALRM}) sigaction(signal, &end, nullptr);
    const auto step_ns = static_cast<std::int64_t>(settings.clock_step_s * 1e9);
    std::int64_t sign = 1;
    while (stop_requested == 0 && !board.stop.load()) {
        const std::int64_t right = offset_ns();
        if (!set_offset(right + sign * step_ns)) {
            c.refused = errno;
            return;
        }
        const std::int64_t stepped = offset_ns() - right;
        if (std::llabs(stepped - sign * step_ns) > 50'000'000) ++c.failures;
        sleep_until_stopped(300, board.stop);
        if (!set_offset(right)) ++c.failures;
        const auto off_us = static_cast<std::uint64_t>(std::llabs(offset_ns() - right) / 1000);
        if (off_us > c.evidence.load()) c.evidence = off_us;
        ++c.amount;
        sign = -sign;
        sleep_until_stopped(1200, board.stop);
    }
}

}  // namespace surefoot::soak
