// The states of the tour controller.
#include "tools/walk/tour_controller.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::walk {

namespace {

bool moves(const input::NavigationSample& s) { return s.velocity_m_s != dvec3(0.0) || s.angular_rad_s != dvec3(0.0); }

/// The turn from one orientation to the other as axis times rate.
dvec3 turn_rate(const dquat& from, const dquat& to, double dt_s) {
    dquat way = to * glm::conjugate(from);
    if (way.w < 0) way = -way;
    const dvec3 half{way.x, way.y, way.z};
    const double sine = glm::length(half);
    return sine < 1e-12 ? dvec3(0.0) : half * (2.0 * std::atan2(sine, way.w) / (sine * dt_s));
}

void stand_still(input::NavigationSample& s) {
    s.velocity_m_s = s.angular_rad_s = dvec3(0.0);
    s.zoom_rate = 0;
    s.uncertainty_m = s.uncertainty_rad = 0;
}

}  // namespace

Pose pose_at(const Path& path, double time_s) {
    const double duration_s = path.duration_s();
    if (duration_s <= 0) return sample_path(path, 0);
    const double turn = std::fmod(time_s, 2.0 * duration_s);
    return sample_path(path, turn <= duration_s ? turn : 2.0 * duration_s - turn);
}

TourController::TourController(const Path& path) : path_(path) {
    for (int i = 0; i < viewpoint_count; ++i) viewpoints_.push_back(sample_path(path, path.duration_s() * i / viewpoint_count));
    last_ = start();
}

void TourController::put(const Pose& pose, input::NavigationSample& sample, input::Steering& steering, bool zooms) {
    steering.place(pose, zooms);
    sample.pose = pose;
    stand_still(sample);
}

void TourController::press_buttons(input::NavigationSample& sample, input::Steering& steering) {
    if (sample.next_viewpoint || sample.reset) {
        viewpoint_ = sample.reset ? 0 : (viewpoint_ + 1) % viewpoints_.size();
        if (sample.reset) tour_s_ = 0;
        touring_ = paused_ = false;
        ++jumps_;
        put(viewpoints_[viewpoint_], sample, steering);
    } else if (sample.tour) {
        if (!touring_) ++jumps_;
        touring_ = true;
        paused_ = hand_rested_ = false;
    }
    if (sample.pause) {
        paused_ = !paused_;
        if (paused_) last_ = sample.pose;
    }
}

void TourController::tour(input::NavigationSample& sample, input::Steering& steering, double to_s) {
    const Pose before = pose_at(path_, tour_s_);
    const double dt_s = to_s - tour_s_;
    tour_s_ = to_s;
    const Pose pose = pose_at(path_, tour_s_);
    put(pose, sample, steering);
    if (dt_s <= 0) return;
    sample.velocity_m_s = (pose.position - before.position) / dt_s;
    sample.angular_rad_s = turn_rate(before.orientation, pose.orientation, dt_s);
}

void TourController::follow(input::NavigationSample& sample, input::Steering& steering, std::int64_t now_ns) {
    const std::int64_t passed = last_ns_ < 0 ? 0 : std::max<std::int64_t>(0, now_ns - last_ns_);
    const double dt_s = std::min(static_cast<double>(passed) * 1e-9, input::longest_step_s);
    last_ns_ = std::max(last_ns_, now_ns);
    if (sample.stopped) touring_ = false;  // taken off, a stop leaves the visitor standing, not carried on
    if (touring_ && !paused_) {
        const bool hand = moves(sample);
        if (hand && hand_rested_) touring_ = false;
        hand_rested_ = hand_rested_ || !hand;
    }
    press_buttons(sample, steering);
    if (paused_ || !touring_) start_ns_ = -1;
    if (paused_)
        put(last_, sample, steering, true);
    else if (touring_)
        tour(sample, steering, on_schedule() ? std::max(0.0, static_cast<double>(now_ns - start_ns_) * 1e-9) : tour_s_ + dt_s);
    last_ = sample.pose;
}

}  // namespace surefoot::walk
