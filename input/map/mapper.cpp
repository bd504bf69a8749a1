// What a device requests, from its newest raw values.
#include "input/map/mapper.hpp"

#include <algorithm>
#include <cmath>

#include "input/map/merge.hpp"

namespace surefoot::input {

namespace {

using From = Binding::Source;

constexpr double pace_window_s = 0.05;      // relative controls: displacement over this time makes the pace
constexpr double smooth_rest = 1.0 / 1024;  // a smoothed response this near to rest is at rest

/// Low pass that ends: exactly at rest when the target is, instead of creeping for ever.
void smooth(Binding& b, double dt_s) {
    if (b.smoothing_s <= 0) {
        b.smoothed = b.answer;
        return;
    }
    b.smoothed += (b.answer - b.smoothed) * (1 - std::exp(-dt_s / b.smoothing_s));
    if (b.answer == dvec2(0.0) && glm::length(b.smoothed) < smooth_rest) b.smoothed = dvec2(0.0);
}

void evaluate_axes(Binding& b, const DeviceState& state, std::int64_t now_ns, std::int64_t oldest_ns) {
    const std::size_t count = b.source == From::stick ? 2 : 1;
    dvec2 deflection{0.0};
    for (std::size_t i = 0; i < count; ++i) {
        const bool stale = b.reported_ns[i] >= 0 && b.reported_ns[i] < oldest_ns;
        if (stale || !state.has_value[b.control[i]]) {  // nothing known, or nothing meant: rest
            b.answer = b.held = dvec2(0.0);
            return;
        }
        deflection[static_cast<int>(i)] = b.rest[i].deflection(state.value[b.control[i]]);
    }
    if (count == 2) {
        b.held = with_play(b.held, deflection, b.response.play);
        b.answer = respond(b.response, b.held);
    } else {
        b.held.x = with_play(b.held.x, deflection.x, b.response.play);
        b.answer.x = respond(b.response, b.held.x);
    }
    const bool active = b.answer != dvec2(0.0);
    if (!active) b.armed = true;
    for (std::size_t i = 0; i < count; ++i) b.rest[i].learn(state.value[b.control[i]], active, now_ns);
    if (!b.armed) b.answer = dvec2(0.0);
}

/// Displacements become a pace: a leaky sum over a short window, so that a still device rests by itself.
void evaluate_relative(Binding& b, const DeviceState& state, bool fresh, double dt_s) {
    b.armed = true;
    b.travelled *= std::exp(-dt_s / pace_window_s);
    // Only once: reports of another id leave it standing.
    if (fresh && state.has_value[b.control[0]] && !state.carried_over[b.control[0]])
        b.travelled += state.value[b.control[0]] / b.counts_per_s;
    if (std::abs(b.travelled) < smooth_rest * pace_window_s) b.travelled = 0;
    // A heavy burst must not make a long tail.
    b.travelled = std::clamp(b.travelled, -2 * pace_window_s, 2 * pace_window_s);
    b.answer.x = respond(b.response, std::clamp(b.travelled / pace_window_s, -1.0, 1.0));
}

/// Displacements are angles: each turns the eye once.
void evaluate_pointer(Binding& b, DeviceOutput& output, const DeviceState& state, bool fresh) {
    b.armed = true;
    if (!fresh || !state.has_value[b.control[0]] || state.carried_over[b.control[0]]) return;
    const double angle_rad = b.gain[0] * b.rad_per_count * state.value[b.control[0]];
    (b.action[0] == Action::turn ? output.request.turn_by_rad : output.request.look_by_rad) += angle_rad;
}

/// A report has carried it: what another id's reports leave without a value is not at rest but unknown.
bool was_reported(const Binding& b) { return b.reported_ns[0] >= 0; }

void evaluate_hat(Binding& b, const DeviceState& state) {
    constexpr double s = 0.70710678118654752;  // diagonals are no faster
    constexpr std::array<std::array<double, 2>, 8> directions = {
        {{0, 1}, {s, s}, {1, 0}, {s, -s}, {0, -1}, {-s, -s}, {-1, 0}, {-s, s}}};
    const std::int32_t value = state.value[b.control[0]];
    b.answer = dvec2(0.0);
    const bool centre = !state.has_value[b.control[0]] || value < 0 || value > 7;
    if (centre) b.armed = b.armed || was_reported(b);
    if (centre || !b.armed) return;
    const auto& direction = directions[static_cast<std::size_t>(value)];
    b.answer = {direction[0], direction[1]};
}

/// True in the call in which the button goes down. Down at once, up once the contact stayed open for the debounce time.
bool press(Binding& b, const DeviceState& state, std::int64_t now_ns) {
    const bool known = state.has_value[b.control[0]];
    const bool contact = known && state.value[b.control[0]] != 0;
    const bool asserted = b.normally_closed ? !contact : contact;
    const bool before = b.pressed;
    if (asserted) {
        b.pressed = true;
        b.open_since_ns = -1;
    } else if (b.pressed) {
        if (b.open_since_ns < 0) b.open_since_ns = now_ns;
        if (now_ns - b.open_since_ns >= b.debounce_ns) b.pressed = false;
    }
    if (!asserted && was_reported(b)) b.armed = true;
    return b.pressed && !before && b.armed;
}

double* member(MotionRequest& request, Action action) {
    switch (action) {
        case Action::forward:
            return &request.forward;
        case Action::side:
            return &request.side;
        case Action::up:
            return &request.up;
        case Action::turn:
            return &request.turn;
        case Action::look:
            return &request.look;
        case Action::speed:
            return &request.speed;
        case Action::zoom:
            return &request.zoom;
        default:
            return nullptr;
    }
}

void evaluate_button(Binding& b, DeviceOutput& output, const DeviceState& state, std::int64_t now_ns) {
    const bool edge = press(b, state, now_ns);
    const bool held = b.pressed && b.armed;  // held when it came: not meant for us
    b.answer = dvec2(held && has_size(b.action[0]) ? 1.0 : 0.0, 0.0);
    switch (b.action[0]) {
        case Action::next_viewpoint:
            output.request.next_viewpoint |= edge;
            break;
        case Action::reset:
            output.request.reset |= edge;
            break;
        case Action::tour:
            output.request.tour |= edge;
            break;
        case Action::pause:
            output.request.pause |= edge;
            break;
        case Action::sunlight:
        case Action::shadows:
        case Action::lamps:
        case Action::fog:
            output.request.switched |= edge ? 1U << switch_of(b.action[0]) : 0U;
            break;
        case Action::dead_man:
            output.has_dead_man = true;
            // Raw: its release is never delayed (safety/ debounces the press).
            output.dead_man |= held && b.open_since_ns < 0;
            break;
        case Action::stop:
            output.has_stop = true;
            output.stop |= b.pressed;
            break;
        case Action::stop_reset:
            output.stop_reset |= held;
            break;
        default:
            break;
    }
}

}  // namespace

/// Records when a report carried the binding's controls.
void mark_reported(Binding& b, const DeviceState& state, std::int64_t now_ns) {
    for (std::size_t i = 0; i < 2; ++i)
        if (!state.carried_over[b.control[i]]) b.reported_ns[i] = now_ns;
}

/// What evaluate() finds out about all bindings together for Mapper::still.
struct Stillness {
    static constexpr double fine_counts = 512;  ///< of half the travel: ten bits
    bool deflected = false, moved = false, fine = true;
    void look(Binding& b, bool pressed_before) {
        const bool creeps = glm::length(b.held - b.still_at) <= b.response.play / 4;
        if (!creeps) b.still_at = b.held;
        moved |= !creeps || b.pressed != pressed_before;
        if (b.source == From::button || b.answer == dvec2(0.0)) return;
        deflected = true;
        fine = fine && (b.source == From::axis || b.source == From::stick) && b.rest[0].half_travel_counts() >= fine_counts;
    }
};

DeviceOutput evaluate(Mapper& mapper, const DeviceState& state, std::int64_t now_ns, std::int64_t age_limit_ns) {
    DeviceOutput output;
    const std::int64_t passed = mapper.last_ns < 0 ? 0 : std::max<std::int64_t>(0, now_ns - mapper.last_ns);
    const double dt_s = static_cast<double>(passed) * 1e-9;
    const bool fresh = state.reports != mapper.last_reports;
    mapper.last_ns = std::max(mapper.last_ns, now_ns);
    mapper.last_reports = state.reports;
    if (fresh) mapper.last_report_ns = now_ns;
    // Against the newest report: where none comes at all, safety/ brakes.
    const std::int64_t oldest_ns = age_limit_ns > 0 ? mapper.last_report_ns - age_limit_ns : -1;
    Stillness stillness;
    for (Binding& b : mapper.bindings) {
        const bool pressed = b.pressed;
        if (fresh) mark_reported(b, state, now_ns);
        switch (b.source) {
            case From::axis:
            case From::stick:
                evaluate_axes(b, state, now_ns, oldest_ns);
                break;
            case From::relative:
                evaluate_relative(b, state, fresh, dt_s);
                break;
            case From::pointer:
                evaluate_pointer(b, output, state, fresh);
                break;
            case From::hat:
                evaluate_hat(b, state);
                break;
            case From::button:
                evaluate_button(b, output, state, now_ns);
                break;
        }
        smooth(b, dt_s);
        stillness.look(b, pressed);
        for (std::size_t i = 0; i < 2; ++i) {
            const double size = b.smoothed[static_cast<int>(i)];
            if (double* sum = member(output.request, b.action[i])) *sum += b.gain[i] * size;
            const bool waits = !b.armed && !b.own_interlock;
            const bool deflected = b.source == From::button ? b.pressed : b.answer[static_cast<int>(i)] != 0 || waits;
            const bool seen = b.armed || state.has_value[b.control[i]];
            if (moves(b.action[i]) && seen && deflected) output.neutral = false;
        }
    }
    mapper.still = stillness.deflected && stillness.fine && !stillness.moved;
    bound(output.request);
    return output;
}

void forget(Mapper& mapper) {
    for (Binding& b : mapper.bindings) {
        b.held = b.answer = b.smoothed = dvec2(0.0);
        b.travelled = 0;
        b.armed = b.pressed = false;
        b.reported_ns = {-1, -1};
        b.open_since_ns = -1;
    }
    mapper.still = false;
    mapper.last_ns = -1;
    mapper.last_reports = 0;
    mapper.last_report_ns = -1;
}

double mapping_lag_s(const Mapper& mapper) {
    double lag = 0;
    for (const Binding& b : mapper.bindings) lag = std::max(lag, b.smoothing_s);
    return lag;
}

}  // namespace surefoot::input
