// The questions and how their answers are recognised.
#include "input/map/teach.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::input {

namespace {

constexpr double shown_from = 0.1, back_below = 0.25;

double range_of(const ControlInfo& c) { return std::max(1.0, static_cast<double>(c.logical_max) - c.logical_min); }

/// Rest is at an end if it is within an eighth of the range of it.
Rest rest_kind(const ControlInfo& c, double rest) {
    const double at = (rest - c.logical_min) / range_of(c);
    return at < 0.125 ? Rest::min : at > 0.875 ? Rest::max : Rest::centre;
}

/// A control that is first heard of when it moves: its rest is the likely place next to where it was first seen.
double likely_rest(const ControlInfo& c, double first) {
    if (c.kind != ControlKind::axis) return c.logical_min;
    const double centre = 0.5 * (static_cast<double>(c.logical_min) + c.logical_max);
    for (const double place : {centre, static_cast<double>(c.logical_min), static_cast<double>(c.logical_max)})
        if (std::abs(first - place) <= 0.2 * range_of(c)) return place;
    return first;
}

}  // namespace

Teach::Teach(const TeachLimits& limits) : limits_(limits) {
    for (const Action a : {Action::forward, Action::side, Action::up, Action::turn, Action::look, Action::speed,
                           Action::next_viewpoint, Action::reset, Action::tour, Action::pause})
        steps_.push_back({a, 1});
}

int Teach::add_device(DeviceIdentity identity, std::vector<ControlInfo> controls) {
    Device d;
    d.identity = std::move(identity);
    d.controls.resize(controls.size());
    d.infos = std::move(controls);
    devices_.push_back(std::move(d));
    return static_cast<int>(devices_.size()) - 1;
}

const ControlInfo& Teach::control(int device, std::size_t control) const {
    return devices_[static_cast<std::size_t>(device)].infos[control];
}

/// Signed, of the travel: from rest to the further end, or to a full movement of a ball.
double Teach::deflection(const ControlInfo& info, const Control& c, const TeachLimits& limits) {
    if (info.relative) return c.value / limits.relative_counts;
    if (info.kind == ControlKind::button) return c.value != c.rest ? 1 : 0;
    if (!c.known) return 0;
    const double travel = std::max(c.rest - info.logical_min, info.logical_max - c.rest);
    return std::clamp((c.value - c.rest) / std::max(1.0, travel), -1.0, 1.0);
}

void Teach::observe(int device, const DeviceState& state, std::int64_t now_ns) {
    if (phase_ == Phase::done) return;
    if (since_ns_ < 0) since_ns_ = still_since_ns_ = now_ns;
    Device& d = devices_[static_cast<std::size_t>(device)];
    for (std::size_t i = 0; i < d.infos.size() && i < max_controls; ++i) see(d, i, state, now_ns);
    tick(now_ns);
}

void Teach::see(Device& d, std::size_t i, const DeviceState& state, std::int64_t now_ns) {
    const ControlInfo& info = d.infos[i];
    Control& c = d.controls[i];
    if (info.kind == ControlKind::hat) {
        static constexpr std::array<std::int8_t, 8> right = {0, 1, 1, 1, 0, -1, -1, -1}, up = {1, 1, 0, -1, -1, -1, 0, 1};
        const bool pressed = state.has_value.test(i) && state.value[i] >= 0 && state.value[i] < 8;
        const auto at = pressed ? static_cast<std::size_t>(state.value[i]) : 0;
        const std::int8_t now[2] = {pressed ? right[at] : std::int8_t{0}, pressed ? up[at] : std::int8_t{0}};
        c.value = pressed ? 1 : 0;
        if (phase_ == Phase::rest && pressed) still_since_ns_ = now_ns;
        // Straight directions only: a diagonal says nothing of which one was meant.
        if (phase_ == Phase::question && pressed && (now[0] == 0) != (now[1] == 0)) {
            c.hat[0] = now[0];
            c.hat[1] = now[1];
            c.moved = 1;
        }
        return;
    }
    if (!state.has_value.test(i)) return;
    const auto value = static_cast<double>(state.value[i]);
    if (info.relative) {
        c.value += value;
        if (phase_ == Phase::rest && value != 0) still_since_ns_ = now_ns;
    } else {
        c.value = value;
        if (!c.known) {
            c.known = true;
            c.rest = phase_ == Phase::rest && info.kind == ControlKind::axis ? value : likely_rest(info, value);
            c.low = c.high = value;
        }
    }
    if (phase_ == Phase::rest && !info.relative) {
        c.low = std::min(c.low, value);
        c.high = std::max(c.high, value);
        if (c.high - c.low > limits_.tremor * range_of(info) || (info.kind == ControlKind::button && value != c.rest)) {
            c.low = c.high = value;
            still_since_ns_ = now_ns;
        }
    }
    if (phase_ == Phase::question) {
        const double moved = deflection(info, c, limits_);
        if (std::abs(moved) > std::abs(c.moved)) c.moved = moved;
    }
}

void Teach::wait_for_rest(std::int64_t now_ns) {
    if (now_ns - still_since_ns_ < limits_.still_ns && now_ns - since_ns_ < limits_.max_rest_wait_ns) return;
    begin_question(now_ns);
}

void Teach::begin_question(std::int64_t now_ns) {
    for (Device& d : devices_)
        for (std::size_t i = 0; i < d.controls.size(); ++i) {
            Control& c = d.controls[i];
            if (d.infos[i].relative)
                c.value = 0;
            else if (c.known && d.infos[i].kind == ControlKind::axis)
                c.rest = c.value;
            c.moved = 0;
            c.hat[0] = c.hat[1] = 0;
        }
    phase_ = Phase::question;
    since_ns_ = now_ns;
    moved_since_ns_ = -1;
}

bool Teach::used(int device, std::size_t control, std::uint8_t hat_axis) const {
    return std::any_of(learned_.begin(), learned_.end(), [&](const Learned& l) {
        return l.device == device && l.control == control &&
               (this->control(device, control).kind != ControlKind::hat || l.hat_axis == hat_axis);
    });
}

/// What has a size is shown by any control, the others by a button.
bool Teach::eligible(const Device& d, std::size_t i) const {
    const ControlInfo& info = d.infos[i];
    if (info.kind != ControlKind::button && info.kind != ControlKind::hat && info.logical_min >= info.logical_max) return false;
    return has_size(action()) || info.kind == ControlKind::button;
}

std::optional<Teach::Leader> Teach::leader() const {
    if (phase_ != Phase::question) return std::nullopt;
    std::optional<Leader> best;
    // A trigger is an axis and often a button as well: the axis is the better answer.
    const auto rank = [&](const Leader& l) {
        const ControlKind kind = control(l.device, l.control).kind;
        const bool meant = std::abs(l.moved) >= limits_.moved;
        return (meant ? 10.0 : 0.0) + (meant && kind == ControlKind::axis ? 5.0 : 0.0) + std::abs(l.moved);
    };
    for (std::size_t d = 0; d < devices_.size(); ++d)
        for (std::size_t i = 0; i < devices_[d].controls.size(); ++i) {
            const Control& c = devices_[d].controls[i];
            const Leader l{static_cast<int>(d), i, c.moved};
            if (std::abs(c.moved) < shown_from || !eligible(devices_[d], i)) continue;
            if (used(l.device, i, c.hat[0] != 0 ? 0 : 1)) continue;
            if (!best || rank(l) > rank(*best)) best = l;
        }
    return best;
}

void Teach::tick(std::int64_t now_ns) {
    if (phase_ == Phase::done) return;
    if (since_ns_ < 0) since_ns_ = still_since_ns_ = now_ns;
    if (phase_ == Phase::rest) return wait_for_rest(now_ns);
    const auto best = leader();
    if (best && std::abs(best->moved) >= limits_.moved) {
        if (moved_since_ns_ < 0) moved_since_ns_ = now_ns;
        const Device& d = devices_[static_cast<std::size_t>(best->device)];
        const Control& c = d.controls[best->control];
        const ControlInfo& info = d.infos[best->control];
        const bool back = !info.relative &&
                          (info.kind == ControlKind::hat ? c.value == 0 : std::abs(deflection(info, c, limits_)) < back_below);
        if (back || now_ns - moved_since_ns_ >= limits_.stays_ns) return answer(*best, now_ns);
    } else if (now_ns - since_ns_ >= limits_.answer_limit_ns) {
        next(now_ns);
    }
}

void Teach::answer(const Leader& l, std::int64_t now_ns) {
    const Device& d = devices_[static_cast<std::size_t>(l.device)];
    const Control& c = d.controls[l.control];
    const ControlInfo& info = d.infos[l.control];
    const Step step = steps_.front();
    Learned learned{step.action, step.sign, l.device, l.control, Rest::centre, l.moved > 0, 0};
    if (info.kind == ControlKind::hat) {
        learned.hat_axis = c.hat[0] != 0 ? 0 : 1;
        learned.positive = c.hat[learned.hat_axis] > 0;
    } else if (info.kind == ControlKind::axis && !info.relative && step.action != Action::speed) {
        learned.rest = rest_kind(info, c.rest);  // a lever for the speed stays anywhere: its middle is the middle speed
    }
    learned_.push_back(learned);
    // What only moves one way shows half of the action: the other half may be on another control.
    const bool one_way = info.kind == ControlKind::button || learned.rest != Rest::centre;
    if (has_size(step.action) && one_way && step.sign > 0) steps_.insert(steps_.begin() + 1, {step.action, -1});
    next(now_ns);
}

void Teach::next(std::int64_t now_ns) {
    if (!steps_.empty()) steps_.pop_front();
    phase_ = steps_.empty() ? Phase::done : Phase::rest;
    since_ns_ = still_since_ns_ = now_ns;
    for (Device& d : devices_)
        for (Control& c : d.controls) c.low = c.high = c.value;
}

void Teach::skip(std::int64_t now_ns) {
    if (phase_ == Phase::rest) begin_question(now_ns);
    if (phase_ == Phase::question) next(now_ns);
}

double Teach::seconds_left(std::int64_t now_ns) const {
    if (phase_ != Phase::question) return static_cast<double>(limits_.answer_limit_ns) * 1e-9;
    return static_cast<double>(std::max<std::int64_t>(0, limits_.answer_limit_ns - (now_ns - since_ns_))) * 1e-9;
}

std::string Teach::question() const {
    if (phase_ == Phase::done || steps_.empty()) return "That was all";
    const bool other_way = steps_.front().sign < 0;
    switch (steps_.front().action) {
        case Action::forward:
            return other_way ? "Move the control that walks backward" : "Move the control that walks forward, as far as it goes";
        case Action::side:
            return other_way ? "Move the control that walks to the left" : "Move the control that walks to the right";
        case Action::up:
            return other_way ? "Move the control that sinks" : "Move the control that rises";
        case Action::turn:
            return other_way ? "Move the control that turns to the right" : "Move the control that turns to the left";
        case Action::look:
            return other_way ? "Move the control that looks down" : "Move the control that looks up";
        case Action::speed:
            return other_way ? "Move the control that makes it slower"
                             : "Move the control that makes it faster (a lever: to its fast end)";
        case Action::next_viewpoint:
            return "Press the button for the next viewpoint";
        case Action::reset:
            return "Press the button that goes back to the start";
        case Action::tour:
            return "Press the button that starts the tour";
        case Action::sunlight:
            return "Press the button that switches the sunlight";
        case Action::shadows:
            return "Press the button that switches the shadows";
        case Action::lamps:
            return "Press the button that switches the lamps";
        case Action::fog:
            return "Press the button that switches the fog";
        default:
            return "Press the button that pauses";
    }
}

}  // namespace surefoot::input
