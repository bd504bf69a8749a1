// The interface of report sources: a recording, or live devices. The input thread feeds their reports to Steering.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "input/safety/safety.hpp"
#include "input/steering.hpp"
#include "rt/clock/clock.hpp"
#include "rt/monitor/facts.hpp"

namespace surefoot::input {

constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

/// The stamp of every accepted report, in order of reading, for latencies by report. Memory is reserved before the thread starts;
/// further reports are only counted.
class StampLog {
public:
    void reserve(std::size_t reports) { stamps_.reserve(reports); }
    void add(std::int64_t stamp_ns) {
        ++count_;
        if (stamps_.size() < stamps_.capacity()) stamps_.push_back(stamp_ns);
    }
    [[nodiscard]] std::span<const std::int64_t> stamps() const { return stamps_; }
    [[nodiscard]] std::uint64_t count() const { return count_; }

private:
    std::vector<std::int64_t> stamps_;
    std::uint64_t count_ = 0;
};

/// One thread calls all members except begin(). drain() and wait() neither allocate nor lock while no device comes or goes.
/// A source with hot-plug opens and describes devices on its own thread, and hands them over complete.
class ReportSource {
public:
    virtual ~ReportSource() = default;

    /// The walk's time begins. Attaches the devices that are there. Before the input thread starts; may allocate.
    virtual void begin(Steering& steering, std::int64_t start_ns) REQUIRES(steering.steers) = 0;
    /// When the next report comes, where that is known beforehand (a recording); else never_ns.
    [[nodiscard]] virtual std::int64_t next_ns() const = 0;
    /// Sleeps until something can be read, or until `until_ns`, whichever is first.
    virtual void wait(rt::Clock& clock, std::int64_t until_ns) = 0;
    /// Reads until nothing is left: Steering::report() for each, then drained(); attach() and detach() for what came and went.
    /// Returns the wired switches as they are.
    virtual Lines drain(Steering& steering, std::int64_t now_ns) REQUIRES(steering.steers) = 0;

    [[nodiscard]] virtual const StampLog& log() const = 0;
    /// Short, long and undeclared reports: they changed nothing.
    [[nodiscard]] virtual std::uint64_t refused() const = 0;
    /// Of wired encoders: missed steps, whose direction is unknown.
    [[nodiscard]] virtual std::uint64_t illegal_encoder_steps() const { return 0; }
    /// Devices that were there at any time.
    [[nodiscard]] virtual std::vector<rt::SteeringDevice> devices() const = 0;
};

}  // namespace surefoot::input
