// A mapping compiled for one device: raw values in, requested motion out. After compile() nothing allocates.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "input/map/mapping.hpp"
#include "rt/base/result.hpp"

namespace surefoot::input {

/// The output of one device at one moment.
struct DeviceOutput {
    MotionRequest request;  ///< translation and rotation each at most of length 1; edges and angles of a pointer only in the call
                            ///< in which they came
    bool neutral = true;    ///< every control that moves is in its dead zone (those not yet seen do not count)
    bool has_stop = false, stop = false;  ///< bound at all; asserted now
    bool stop_reset = false;              ///< held now
    bool has_dead_man = false, dead_man = false;
};

/// One control or pair of controls with its state. Public so that tools can show it; use compile() and evaluate().
struct Binding {
    enum class Source : std::uint8_t { axis, stick, relative, pointer, hat, button };
    Source source = Source::axis;
    std::array<std::uint16_t, 2> control{};
    std::array<Action, 2> action{};
    std::array<double, 2> gain{};  ///< scale, with the inversion's sign
    Response response;
    double smoothing_s = 0;
    double counts_per_s = 1000;
    double rad_per_count = 0;  ///< pointer
    std::int64_t debounce_ns = 0;
    bool normally_closed = false;

    std::array<RestFinder, 2> rest;
    dvec2 held{0.0};       ///< deflection after play
    dvec2 still_at{0.0};   ///< `held` when it last moved by more than a quarter of the play: noise makes it creep
    dvec2 answer{0.0};     ///< response before smoothing
    dvec2 smoothed{0.0};   ///< what goes out
    double travelled = 0;  ///< relative: leaky sum, in seconds of full response
    std::array<std::int64_t, 2> reported_ns{-1, -1};  ///< when a report last carried the control
    /// This control waits until it was seen at rest; the other controls of its device do not wait for it. True for a control
    /// that rests at an end, and for those of an adapter for several pads.
    bool own_interlock = false;
    bool armed = false;  ///< seen at rest since the device came; until then it requests nothing
    bool pressed = false;
    std::int64_t open_since_ns = -1;  ///< of a pressed button whose contact has opened
};

/// The mapping of one device with its state. Made by compile(), then used by one thread.
struct Mapper {
    std::vector<Binding> bindings;
    bool flies = false;                 ///< DeviceMapping::flies
    bool adapter = false;               ///< of one for several pads: each reports in its own way and time
    std::vector<std::string> messages;  ///< named controls that cannot be bound, for the log
    std::int64_t last_ns = -1;
    std::uint64_t last_reports = 0;
    std::int64_t last_report_ns = -1;  ///< when evaluate() saw the newest one
    /// In the last evaluate(): something is deflected, nothing moved beyond its hysteresis band, and the deflected control is
    /// fine enough to show noise.
    bool still = false;
};

/// Binds by name, or by usage and collection. A missing control is an error with the nearest name.
Result<Mapper> compile(const DeviceMapping& mapping, std::span<const ControlInfo> controls);
/// The same, but leaves out controls that cannot be bound, with a message for each.
Mapper compile_what_fits(const DeviceMapping& mapping, std::span<const ControlInfo> controls);

/// Call it after each accepted report, and at least once a tick, because smoothing continues. If `now_ns` goes back, time stands
/// still. A control without a value (never seen, or a null state) is at rest; a value out of range is clamped.
/// age_limit_ns, if not 0: a control goes to rest if reports have not carried it for longer than this.
DeviceOutput evaluate(Mapper& mapper, const DeviceState& state, std::int64_t now_ns, std::int64_t age_limit_ns = 0);

/// The device was lost or comes again: all controls are at rest and unarmed. Learned rests are kept.
void forget(Mapper& mapper);

/// Longest lag that the mapping itself adds, seconds: its largest smoothing time constant. Play adds an error of at most its
/// half width and no lag in time.
double mapping_lag_s(const Mapper& mapper);

}  // namespace surefoot::input
