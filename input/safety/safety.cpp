// The safety state machine.
#include "input/safety/safety.hpp"

#include <algorithm>
#include <cmath>

#include "input/map/merge.hpp"

namespace surefoot::input {

namespace {

constexpr double longest_slew_s = 0.05;               // after a stall the slew does not leap
constexpr std::int64_t brake_window_ns = 50'000'000;  // for so long after a loss the motion brakes

bool requests_motion(const MotionRequest& w) {
    return w.forward != 0 || w.side != 0 || w.up != 0 || w.turn != 0 || w.look != 0 || w.turn_by_rad != 0 || w.look_by_rad != 0;
}

MotionRequest without_edges(MotionRequest request) {
    request.next_viewpoint = request.reset = request.tour = request.pause = false;
    request.switched = 0;
    request.turn_by_rad = request.look_by_rad = 0;
    return request;
}

/// Both vectors move along the straight way, so what is bounded stays bounded.
void slew(MotionRequest& at, const MotionRequest& to, double max_step) {
    const auto part = [&](dvec3 from, const dvec3& target) {
        const dvec3 way = target - from;
        const double length = glm::length(way);
        return length <= max_step ? target : from + way * (max_step / length);
    };
    const dvec3 walk = part({at.forward, at.side, at.up}, {to.forward, to.side, to.up});
    const dvec3 turning = part({at.turn, at.look, 0}, {to.turn, to.look, 0});
    at = to;  // edges and angles of a pointer pass
    at.forward = walk.x, at.side = walk.y, at.up = walk.z;
    at.turn = turning.x, at.look = turning.y;
}

/// Why the device is held at rest now.
Held hold_reason(SafetyState& state, SafetyState::Device& device, const SafetyLimits& limits, const Source& source,
                 std::int64_t now_ns) {
    const bool replugged = source.connected && (!device.connected || source.connection != device.connection);
    if (replugged) {
        const bool had_stop = device.had_stop;
        device = {};
        device.had_stop = had_stop;
        device.connection = source.connection;
    }
    device.connected = source.connected;
    if (!source.connected) return Held::disconnected;
    const bool fresh = source.reports != device.reports;
    device.reports = source.reports;
    // What was read in an overflowing drain is old; the first report that comes after it is new again.
    if (source.drained >= limits.full_drain || source.lost) {
        if (!device.overflow) ++state.overflows;
        device.overflow = true;
    } else if (fresh) {
        device.overflow = false;
    }
    const ReportActivity activity{fresh, source.equal_report, !source.moved, !source.output.neutral, source.stamp_ns};
    const bool quiet = timed_out(device.cadence, source.reporting, activity, now_ns, limits.age_limit_ns);
    if (!device.overflow && source.reports > 0 && (source.seen_neutral || source.output.neutral)) device.interlocked = false;
    if (device.overflow) return Held::overflow;
    if (device.interlocked) return Held::not_neutral;
    return quiet ? Held::timed_out : Held::no;
}

/// Latched at the first sign; taken off by a reset pressed anew while nothing is asserted.
void emergency_stop(SafetyState& state, std::span<const Source> sources, const Lines& lines) {
    bool reset = lines.stop_reset;
    state.asserted = lines.stop;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        auto& device = state.devices[i];
        device.had_stop = device.had_stop || sources[i].output.has_stop;
        // A pulled cable is a broken wire.
        state.asserted |= device.had_stop && (!sources[i].connected || sources[i].output.stop);
        reset |= sources[i].connected && sources[i].output.stop_reset;
    }
    if (state.asserted) {
        if (!state.latched) ++state.stops;
        state.latched = true;
    } else if (state.latched && reset && !state.reset_down) {
        state.latched = false;
        for (auto& device : state.devices) device.interlocked = true;  // nobody walks off by a stick still pushed
    }
    // A reset that was already down when the stop came, or went, does not count.
    state.reset_down = reset;
}

}  // namespace

DeviceOutput combined(const DeviceOutput& older, const DeviceOutput& newer) {
    DeviceOutput both = newer;
    both.request.next_viewpoint |= older.request.next_viewpoint;
    both.request.reset |= older.request.reset;
    both.request.tour |= older.request.tour;
    both.request.pause |= older.request.pause;
    both.request.switched |= older.request.switched;
    both.request.turn_by_rad += older.request.turn_by_rad;
    both.request.look_by_rad += older.request.look_by_rad;
    both.has_stop |= older.has_stop;
    both.stop |= older.stop;
    both.has_dead_man |= older.has_dead_man;
    both.dead_man = newer.dead_man && (older.dead_man || !older.has_dead_man);
    return both;
}

Command step(SafetyState& state, const SafetyLimits& limits, std::span<const Source> all, const Lines& lines,
             std::int64_t now_ns) {
    const auto sources = all.first(std::min(all.size(), max_devices));
    const std::int64_t passed = state.last_ns < 0 ? 0 : std::max<std::int64_t>(0, now_ns - state.last_ns);
    const double dt_s = std::min(static_cast<double>(passed) * 1e-9, longest_slew_s);
    const std::int64_t now = state.last_ns = std::max(state.last_ns, now_ns);

    std::array<MotionRequest, max_devices> passing{};
    bool has_dead_man = lines.has_dead_man, dead_man = !lines.has_dead_man || lines.dead_man, walking = false;
    emergency_stop(state, sources, lines);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        auto& device = state.devices[i];
        const Source& source = sources[i];
        const bool contributed = device.contributed;
        const Held before = device.held;
        device.held = hold_reason(state, device, limits, source, now);
        if (device.held == Held::no) passing[i] = source.output.request;
        device.contributed = requests_motion(passing[i]);
        if (device.held != Held::no && (contributed || before == Held::no)) state.brake_until_ns = now + brake_window_ns;
        if (device.held == Held::timed_out && before != Held::timed_out) ++state.timeouts;
        if (device.held == Held::disconnected && before != Held::disconnected) ++state.losses;
        device.passed = passing[i];
        if (source.connected) state.stamp_ns = std::max(state.stamp_ns, source.stamp_ns);
        // A switch in a device that is gone is not held.
        if (source.output.has_dead_man) {
            has_dead_man = true;
            dead_man = dead_man && source.connected && source.output.dead_man;
        }
        walking = walking || device.contributed;
    }
    MotionRequest wanted = merge(std::span(passing).first(sources.size()));
    const bool held = step(state.dead_man, limits.dead_man, has_dead_man && dead_man, walking, now);
    state.wants_press = state.dead_man.must_release;

    Command command;
    command.stamp_ns = state.stamp_ns;
    if (state.latched || (has_dead_man && !held)) {
        // Only pause still passes: nothing else should move the picture.
        command.request.pause = wanted.pause;
        command.order = Order::stop;
        state.slewed = {};
        return command;
    }
    const bool brake = now < state.brake_until_ns;
    slew(state.slewed, wanted, (brake ? std::max(limits.slew_per_s, 1 / limits.brake_s) : limits.slew_per_s) * dt_s);
    command.request = state.slewed;
    command.order = brake ? Order::brake : Order::walk;
    state.slewed = without_edges(state.slewed);
    return command;
}

}  // namespace surefoot::input
