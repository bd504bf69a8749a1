// From the newest sample to a frame's pose.
#include "tools/walk/steered_poses.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::walk {

SteeredPoses::SteeredPoses(rt::TripleBuffer<SteeredSample>& samples, const input::MotionLimits& limits, std::int64_t period_ns,
                           InputStepper* inline_stepper, PathPoses* path_poses, InputStepper* timed)
    : samples_(samples),
      limits_(limits),
      period_ns_(period_ns),
      inline_stepper_(inline_stepper),
      path_poses_(path_poses),
      timed_(timed) {}

FramePose SteeredPoses::sample(const FrameTime& time) {
    if (timed_ != nullptr) timed_->set_zero(time.due_ns - static_cast<std::int64_t>(time.path_slot) * period_ns_);
    if (inline_stepper_ != nullptr) inline_stepper_->advance_to(time.now_ns);
    samples_.refresh();
    FramePose pose = pose_of(time);
    jumps_seen_ = samples_.front().jumps;
    return pose;
}

bool SteeredPoses::latch(const FrameTime& time, FramePose& newest) {
    if (inline_stepper_ != nullptr) inline_stepper_->advance_to(time.now_ns);
    if (!samples_.refresh()) return false;
    newest = pose_of(time);
    return true;
}

FramePose SteeredPoses::pose_of(const FrameTime& time) const {
    const SteeredSample& s = samples_.front();
    FramePose out;
    if (s.on_schedule && path_poses_ != nullptr) {
        out = path_poses_->sample(time);
        out.stamp_ns = s.nav.stamp_ns;
        out.reports = s.reports;
        out.switches = s.nav.presses.light;
        return out;
    }
    const std::int64_t by_ns = std::clamp(time.due_ns - s.time_ns, -carry_limit_ns, carry_limit_ns);
    const auto carried_by = [&](std::int64_t ns) {
        return ns == 0 ? s.nav.pose : input::carried(s.nav, static_cast<double>(ns) * 1e-9);
    };
    out.pose = carried_by(by_ns);
    out.before = carried_by(by_ns - period_ns_);
    out.jumped = s.jumps != jumps_seen_;
    out.stopped = s.nav.stopped;
    out.stamp_ns = s.nav.stamp_ns;
    out.reports = s.reports;
    out.switches = s.nav.presses.light;
    if (s.touring) return out;  // the limits say nothing about a path: the last two poses do
    const double ahead_s = region_ahead_s(period_ns_);
    const input::Prediction ahead = input::predict(s.nav, limits_, ahead_s, s.walking ? walker_rise_m_s2 : 0);
    out.predicted.known = true;
    out.predicted.region = {ahead.pose, ahead.uncertainty_m, ahead.uncertainty_rad};
    out.predicted.speed_m_s = glm::length(s.nav.velocity_m_s);
    out.predicted.turn_rad_s = glm::length(s.nav.angular_rad_s);
    out.predicted.on_foot = s.on_foot;
    if (!s.on_foot) return out;
    out.predicted.feet = s.feet, out.predicted.eye = s.nav.pose.position, out.predicted.way = s.nav.velocity_m_s * ahead_s;
    out.predicted.carried_m = (glm::length(s.nav.carried_m_s) + s.nav.max_carried_m_s) * ahead_s;
    return out;
}

}  // namespace surefoot::walk
