// Safety: passes each device's request, holds it at rest, or stops everything. It may only reduce motion.
//
//   DeviceOutput ─► at rest if gone, timed out, overflowed, or not yet seen neutral ─► bounded sum ─► slew ─► Command
//   lines (GPIO), buttons ─► emergency stop (latched), dead-man ─────────────────────────────────────► Order::stop
//
// A state machine with a pure step function: time and inputs are given, nothing allocates, locks or reads a clock.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "input/controls.hpp"
#include "input/map/mapper.hpp"
#include "input/safety/dead_man.hpp"
#include "input/safety/report_cadence.hpp"

namespace surefoot::input {

constexpr std::size_t max_devices = 16;

/// Limits of the safety stage.
struct SafetyLimits {
    std::int64_t age_limit_ns = 100'000'000;  ///< a deflection of a streaming device counts for so long after its report
    /// This many reports in one drain mean overflow: the kernel's ring was full and dropped the newest. hidraw's ring of 64 slots
    /// holds 63, so from 63 on reports may be missing.
    std::uint32_t full_drain = 63;
    double slew_per_s = 8;  ///< of a request, full deflections a second
    double brake_s = 0.03;  ///< time to rest after a device is lost; with one tick this stays below 50 ms
    DeadManSettings dead_man;
};

/// One device, as it is at this step.
struct Source {
    bool connected = false;
    std::uint32_t connection = 0;  ///< counts its connections: a replug between two steps is still seen
    std::uint64_t reports = 0;     ///< accepted since it was connected
    std::uint32_t drained = 0;     ///< most reports that one drain of this step read (every drain reads until nothing is left)
    bool equal_report = false;     ///< one of them was equal to the one before
    bool moved = false;            ///< one of them moved a control, or its noise cannot show (Mapper::still)
    bool lost = false;             ///< its reader knows that reports were lost (a ring of our own overflowed)
    bool seen_neutral = false;     ///< in some report of this step
    std::int64_t stamp_ns = 0;     ///< of the newest report
    Reporting reporting = Reporting::learn;
    DeviceOutput output;  ///< newest; its edges and stops of any report since the last step, dead_man of all
};

/// Switches that are wired, not plugged: from gpio/. If the chip or a wire is lost, stop is asserted and the dead-man not held.
struct Lines {
    bool stop = false;        ///< asserted now or at any moment since the last step
    bool stop_reset = false;  ///< held
    bool has_dead_man = false;
    bool dead_man = false;  ///< held, without a break since the last step
};

enum class Held : std::uint8_t { no, disconnected, not_neutral, timed_out, overflow };  ///< why a device is held at rest

/// State of the safety stage between two steps.
struct SafetyState {
    /// State of one device, by its number.
    struct Device {
        std::uint32_t connection = 0;
        bool connected = false, interlocked = true, overflow = false, had_stop = false, contributed = false;
        std::uint64_t reports = 0;
        ReportCadence cadence;
        Held held = Held::disconnected;
        MotionRequest passed;  ///< its contribution to the last step
    };
    std::array<Device, max_devices> devices{};
    MotionRequest slewed;
    DeadMan dead_man;
    bool latched = false;      ///< emergency stop; load it from the stop memory at the start
    bool asserted = false;     ///< now
    bool reset_down = true;    ///< a reset that is held from before does not count
    bool wants_press = false;  ///< the dead-man switch must be released and pressed again
    std::int64_t last_ns = -1, brake_until_ns = -1;
    std::int64_t stamp_ns = 0;
    std::uint64_t overflows = 0, timeouts = 0, losses = 0, stops = 0;  ///< counted events
};

/// One step. At most max_devices sources; a source keeps its index. If `now_ns` is before the last step's, time stands still.
Command step(SafetyState& state, const SafetyLimits& limits, std::span<const Source> sources, const Lines& lines,
             std::int64_t now_ns);

/// Combines two outputs of evaluate() within one step. Request: the newer one. Edges and angles of a pointer: of both. Stop: if
/// either has it. Dead-man: if both have it.
DeviceOutput combined(const DeviceOutput& older, const DeviceOutput& newer);

}  // namespace surefoot::input
