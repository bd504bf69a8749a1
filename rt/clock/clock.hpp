// The injected clock of the frame loop: the machine's monotonic clock, or a virtual one that only its owner moves.
#pragma once

#include <cstdint>

#include "rt/threads/usage.hpp"

namespace surefoot::rt {

/// Integer nanoseconds. No call allocates, locks or throws.
class Clock {
public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual std::int64_t now_ns() const = 0;
    /// Returns at or after `time_ns`, at once if it has passed.
    virtual void sleep_until_ns(std::int64_t time_ns) = 0;
    /// Resources used by the calling thread so far.
    [[nodiscard]] virtual ThreadUsage usage() const = 0;
    /// Spends CPU time of the calling thread (the control's bare work).
    virtual void burn_ns(std::int64_t cpu_ns) = 0;
};

/// CLOCK_MONOTONIC; absolute sleep, restarted after signals. A step of the wall clock has no effect.
class RealClock final : public Clock {
public:
    [[nodiscard]] std::int64_t now_ns() const override;
    void sleep_until_ns(std::int64_t time_ns) override;
    [[nodiscard]] ThreadUsage usage() const override;
    void burn_ns(std::int64_t cpu_ns) override;
};

/// CLOCK_MONOTONIC, for code without an injected clock.
std::int64_t monotonic_ns();

/// A clock that only its owner moves, for tests and virtual costs. For one thread.
class VirtualClock final : public Clock {
public:
    explicit VirtualClock(std::int64_t start_ns = 0) : now_ns_(start_ns) {}

    [[nodiscard]] std::int64_t now_ns() const override { return now_ns_; }
    void sleep_until_ns(std::int64_t time_ns) override;
    [[nodiscard]] ThreadUsage usage() const override { return usage_; }
    void burn_ns(std::int64_t cpu_ns) override { advance(cpu_ns); }

    /// Work: time passes and CPU time is used. Negative durations count as 0, here and below.
    void advance(std::int64_t ns);
    /// Time passes without CPU time: the host took the core.
    void steal(std::int64_t ns);
    /// Time passes without CPU time, and with an involuntary switch: another thread took the core.
    void preempt(std::int64_t ns);
    /// Time passes without CPU time, because the thread waits (for a fence).
    void wait(std::int64_t ns);
    void fault(std::uint64_t minor, std::uint64_t major);
    /// Every sleep from now on ends this much late.
    void set_wake_lateness(std::int64_t ns) { wake_lateness_ns_ = ns; }

private:
    std::int64_t now_ns_;
    std::int64_t wake_lateness_ns_ = 0;
    ThreadUsage usage_;
};

}  // namespace surefoot::rt
