// The steps of the walk.
#include "input/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "input/map/merge.hpp"

namespace surefoot::input {

namespace {

constexpr std::int64_t pointer_pause_ns = 250'000'000;  // a hand on a pointer that rests so long has ended its turn
constexpr double rounding_m = 1e-9;                     // of a step that was carried besides
constexpr double two_pi = 2 * std::numbers::pi, two_pi_low = 2.4492935982947064e-16;  // their sum is 2 pi to 32 digits

template <class V>
V towards(const V& from, const V& to, double max_step) {
    const V way = to - from;
    const double length = glm::length(way);
    return length <= max_step ? to : from + way * (max_step / length);
}

bool finite(const dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

dquat about_y(double angle) { return {std::cos(angle / 2), 0, std::sin(angle / 2), 0}; }
dquat about_x(double angle) { return {std::cos(angle / 2), std::sin(angle / 2), 0, 0}; }
dquat about_z(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

dquat walker_frame(const MotionState& state, bool level, double yaw, double pitch) {
    return level ? about_y(yaw) : glm::normalize(about_y(yaw) * about_x(pitch) * about_z(state.roll));
}

dvec3 wanted_velocity(const dvec3& walk, double speed, const MotionLimits& limits) {
    const double factor = std::pow(speed >= 0 ? limits.fastest : limits.slowest, std::abs(speed));
    const dvec3 velocity = walk * (limits.walk_m_s * factor);
    const double length = glm::length(velocity);
    return length > limits.max_m_s ? velocity * (limits.max_m_s / length) : velocity;
}

/// Where the ground lets the step end.
dvec3 allowed(MotionState& state, const Ground& ground, const dvec3& wanted, double dt_s) {
    if (ground.query == nullptr || (wanted == state.position && !ground.walks())) return wanted;
    const dvec3 answer = ground.query(ground.context, state.position, wanted, dt_s);
    if (!finite(answer)) {
        ++state.refused;
        return state.position;
    }
    return ground.walks() ? answer : towards(state.position, answer, glm::length(wanted - state.position));
}

/// Walks a level step, and takes from the velocity what walls took.
void walk(MotionState& state, const dquat& frame, const dvec3& velocity, double dt_s, const Ground& ground) {
    const dvec3 before = state.position, way = frame * dvec3(velocity.x, 0, velocity.z) * dt_s;
    const dvec3 wanted = before + dvec3(way.x, 0, way.z);
    state.position = allowed(state, ground, wanted, dt_s);
    state.rise_m_s = (state.position.y - before.y) / dt_s;
    state.velocity.y = 0;
    if (ground.carried != nullptr) state.carried = ground.carried(ground.context), state.carried_s = dt_s;
    if (state.position.x == wanted.x && state.position.z == wanted.z) return;
    const dvec3 gone = state.position - before - state.carried.way;
    if (state.carried.way != dvec3(0.0) && glm::length(dvec2(gone.x - way.x, gone.z - way.z)) < rounding_m) return;
    const dvec3 kept = glm::inverse(frame) * dvec3(gone.x / dt_s, 0, gone.z / dt_s);
    state.velocity = towards(dvec3(0.0), kept, glm::length(state.velocity));
}

void count(PressCounts& presses, const MotionRequest& request) {
    presses.next_viewpoint += request.next_viewpoint ? 1 : 0;
    presses.reset += request.reset ? 1 : 0;
    presses.tour += request.tour ? 1 : 0;
    presses.pause += request.pause ? 1 : 0;
    for (std::size_t i = 0; i < rt::switch_count; ++i) presses.light.*rt::light_switches[i].presses += request.switched >> i & 1U;
}

void follow(MotionState& state, const MotionLimits& limits, const MotionRequest& request, Order order, double dt_s) {
    const dvec3 walk{request.side, request.up, -request.forward};
    const dvec2 turning{request.turn, request.look};
    if (order == Order::brake) state.pointer.rest();
    if (order == Order::walk) {
        state.walk.step(limits.filter, walk, dt_s);
        state.turning.step(limits.filter, turning, dt_s);
    } else {
        state.walk.set(walk);
        state.turning.set(turning);
    }
    // The brake is strong enough to end any speed, also in the opposite direction, within brake_s.
    const double swing_rad_s = std::max(limits.turn_rad_s, limits.look_rad_s);
    const bool brake = order == Order::brake;
    const double accel = brake ? std::max(limits.accel_m_s2, limits.max_m_s / limits.brake_s) : limits.accel_m_s2;
    const double accel_turning = brake ? std::max(limits.accel_rad_s2, swing_rad_s / limits.brake_s) : limits.accel_rad_s2;
    state.velocity = towards(state.velocity, wanted_velocity(state.walk.value, request.speed, limits), accel * dt_s);
    // What is magnified is turned more slowly: the picture passes at the same pace.
    const dvec2 rates = state.turning.value * dvec2(limits.turn_rad_s, limits.look_rad_s) * std::exp(-state.zoom);
    state.rates = towards(state.rates, rates, accel_turning * dt_s);
}

void integrate(MotionState& state, const MotionLimits& limits, const dvec3& velocity, dvec2 rates, double dt_s,
               const Ground& ground) {
    const double yaw_before = state.yaw.value, pitch_before = state.pitch.value;
    if (std::abs(pitch_before + rates.y * dt_s) > limits.max_pitch_rad && pitch_before * rates.y > 0)
        rates.y = state.rates.y = state.pointer.rates.y = state.pointer.owed.y = 0;
    state.yaw.add(rates.x * dt_s);
    state.pitch.add(rates.y * dt_s);
    const dquat frame =
        walker_frame(state, limits.level || ground.walks(), yaw_before + rates.x * dt_s / 2, pitch_before + rates.y * dt_s / 2);
    state.rise_m_s = 0;
    state.carried = {};
    if (ground.walks()) {
        walk(state, frame, velocity, dt_s, ground);
        if (state.carried.turn_rad != 0) state.yaw.add(state.carried.turn_rad);
    } else if (velocity != dvec3(0.0)) {
        const dvec3 before = state.position, wanted = before + frame * velocity * dt_s;
        state.position = allowed(state, ground, wanted, dt_s);
        if (state.position != wanted) {  // the walker keeps the speed that the wall left
            const dvec3 kept = glm::inverse(frame) * ((state.position - before) / dt_s);
            state.velocity = towards(dvec3(0.0), kept, glm::length(state.velocity));
        }
    }
    state.yaw.wrap();
}

/// The field of view at a magnification, whose natural logarithm is given.
double zoomed(double fov_y_rad, double zoom) {
    return zoom == 0 ? fov_y_rad : 2 * std::atan(std::tan(fov_y_rad / 2) * std::exp(-zoom));
}

void follow_zoom(MotionState& state, const MotionLimits& limits, double request, Order order, double dt_s) {
    const double fastest = std::log(limits.zoom_per_s), before = state.zoom_rate;
    const double step = dt_s * (order == Order::brake ? std::max(zoom_accel_s2, fastest / limits.brake_s) : zoom_accel_s2);
    state.zoom_rate += std::clamp(request * fastest - before, -step, step);
    const double to = state.zoom + 0.5 * (before + state.zoom_rate) * dt_s;
    state.zoom = std::clamp(to, 0.0, std::log(limits.max_zoom));
    if (state.zoom != to) state.zoom_rate = 0;
}

/// What carries the eye goes on with it.
void add_carried(const MotionState& state, NavigationSample& sample) {
    const Carried& carried = state.carried;
    sample.max_carried_m_s = carried.max_m_s, sample.max_carried_rad_s = carried.max_rad_s;
    if (carried.way == dvec3(0.0) && carried.turn_rad == 0) return;
    // After a pause the way is that of all of it. The prediction goes by the limits.
    const double speed = glm::length(carried.way) / state.carried_s, turn = carried.turn_rad / state.carried_s;
    sample.carried_m_s = carried.way * (std::min(speed, carried.max_m_s) / std::max(speed, 1e-12) / state.carried_s);
    sample.carried_rad_s = std::clamp(turn, -carried.max_rad_s, carried.max_rad_s);
    sample.velocity_m_s += dvec3(sample.carried_m_s.x, 0, sample.carried_m_s.z);  // rise_m_s has the rest
    sample.angular_rad_s.y += sample.carried_rad_s;
}

}  // namespace

void Angle::add(double increment) {
    const double part = increment - carry, sum = value + part;
    carry = (sum - value) - part;
    value = sum;
}

void Angle::wrap() {
    if (value > std::numbers::pi) value -= two_pi, carry += two_pi_low;
    if (value < -std::numbers::pi) value += two_pi, carry -= two_pi_low;
}

bool place(MotionState& state, const Pose& pose, bool zooms) {
    const dquat q = pose.orientation;
    const double norm = glm::length(q);
    if (!finite(pose.position) || !std::isfinite(norm) || norm < 1e-9 || !std::isfinite(pose.fov_y_rad)) return false;
    const dquat unit = q / norm;
    const dvec3 ahead = unit * dvec3(0, 0, -1), up = unit * dvec3(0, 1, 0), right = unit * dvec3(1, 0, 0);
    const double level = std::hypot(ahead.x, ahead.z);
    state.position = pose.position;
    state.zoom = zooms ? std::max(0.0, std::log(std::tan(state.fov_y_rad / 2) / std::tan(pose.fov_y_rad / 2))) : 0;
    if (!zooms) state.fov_y_rad = pose.fov_y_rad;
    state.zoom_rate = 0;
    state.pitch.set(std::atan2(ahead.y, level));
    // Straight up or down the heading shows in the right hand only.
    state.yaw.set(level > 1e-9 ? std::atan2(-ahead.x, -ahead.z) : std::atan2(-right.z, right.x));
    const dquat unrolled = about_y(state.yaw.value) * about_x(state.pitch.value);
    const dvec3 over = glm::inverse(unrolled) * up;
    state.roll = level > 1e-9 ? std::atan2(-over.x, over.y) : 0;
    state.velocity = dvec3(0.0);
    state.rise_m_s = 0;
    state.carried = {};
    state.rates = dvec2(0.0);
    state.pointer.rest();
    state.walk.set(dvec3(0.0));
    state.turning.set(dvec2(0.0));
    return true;
}

Pose pose_of(const MotionState& state) {
    Pose pose;
    pose.position = state.position;
    pose.fov_y_rad = zoomed(state.fov_y_rad, state.zoom);
    pose.orientation = about_y(state.yaw.value) * about_x(state.pitch.value);
    if (state.roll != 0) pose.orientation = pose.orientation * about_z(state.roll);
    pose.orientation = glm::normalize(pose.orientation);
    return pose;
}

NavigationSample step(MotionState& state, const MotionLimits& limits, const Command& command, std::int64_t now_ns,
                      const Ground& ground) {
    MotionRequest request = command.request;
    if (!bound(request)) ++state.refused;
    if (state.last_ns >= 0 && now_ns < state.last_ns) ++state.clock_back;
    const std::int64_t passed = state.last_ns < 0 ? 0 : std::max<std::int64_t>(0, now_ns - state.last_ns);
    const double dt_s = std::min(static_cast<double>(passed) * 1e-9, longest_step_s);
    state.last_ns = std::max(state.last_ns, now_ns);
    const bool points = request.turn_by_rad != 0 || request.look_by_rad != 0;
    if (points) {
        state.pointed_ns = state.last_ns;
        state.pointer.add(dvec2(request.turn_by_rad, request.look_by_rad) * std::exp(-state.zoom));
    }
    if (command.order == Order::stop) {
        if (ground.halt != nullptr) ground.halt(ground.context);
        state.velocity = dvec3(0.0);
        state.rise_m_s = 0;
        state.carried.way = dvec3(0.0), state.carried.turn_rad = 0;
        state.rates = dvec2(0.0);
        state.zoom_rate = 0;
        state.pointer.rest();
        state.walk.set(dvec3(0.0));
        state.turning.set(dvec2(0.0));
    } else if (dt_s > 0) {
        const dvec3 velocity = state.velocity;
        const dvec2 rates = state.rates;
        follow(state, limits, request, command.order, dt_s);
        follow_zoom(state, limits, request.zoom, command.order, dt_s);
        const dvec2 turned = state.pointer.step(limits.pointer_rad_s, limits.pointer_rad_s2, dt_s);
        integrate(state, limits, 0.5 * (velocity + state.velocity), 0.5 * (rates + state.rates) + turned / dt_s, dt_s, ground);
    }
    count(state.presses, request);

    NavigationSample sample;
    sample.pose = pose_of(state);
    const dquat frame = walker_frame(state, limits.level || ground.walks(), state.yaw.value, state.pitch.value);
    sample.velocity_m_s = frame * state.velocity + dvec3(0, state.rise_m_s, 0);
    const dvec2 turning = state.rates + state.pointer.rates;
    sample.angular_rad_s = dvec3(0, turning.x, 0) + about_y(state.yaw.value) * dvec3(turning.y, 0, 0);
    add_carried(state, sample);
    sample.zoom_rate = state.zoom_rate;
    sample.pointed = state.pointer.moves() || (state.pointed_ns >= 0 && now_ns - state.pointed_ns < pointer_pause_ns);
    sample.stamp_ns = command.stamp_ns;
    sample.sequence = ++state.sequence;
    sample.next_viewpoint = request.next_viewpoint;
    sample.reset = request.reset;
    sample.tour = request.tour;
    sample.pause = request.pause;
    sample.stopped = command.order == Order::stop;
    sample.presses = state.presses;
    const Prediction ahead = predict(sample, limits, limits.frame_s, ground.walks() ? ground.rise_m_s2 : 0);
    sample.uncertainty_m = ahead.uncertainty_m;
    sample.uncertainty_rad = ahead.uncertainty_rad;
    return sample;
}

}  // namespace surefoot::input
