// Poses along a path.
#include "tools/walk/pose_source.hpp"

#include <algorithm>
#include <cmath>

#include "tools/walk/tour_controller.hpp"

namespace surefoot::walk {

namespace {

/// As far from `about` as `pose` is, the other way.
Pose mirrored(const Pose& pose, const Pose& about) {
    Pose out = about;
    out.position += about.position - pose.position;
    out.orientation = glm::normalize(about.orientation * glm::conjugate(pose.orientation) * about.orientation);
    return out;
}

double angle_between(const Pose& a, const Pose& b) {
    return 2.0 * std::acos(std::min(1.0, std::abs(glm::dot(a.orientation, b.orientation))));
}

}  // namespace

FramePose PathPoses::sample(const FrameTime& time) {
    FramePose out;
    const double now_s = static_cast<double>(time.path_slot) * period_s_;
    out.pose = pose_at(path_, now_s);
    out.before = time.path_slot > 0 ? pose_at(path_, now_s - period_s_) : mirrored(pose_at(path_, period_s_), out.pose);
    // A set that is prepared now serves until the horizon, and is begun a frame before it is used.
    Pose from = out.pose;
    const auto periods = static_cast<int>(std::lround(horizon_s(period_s_) / period_s_)) + 1;
    for (int i = 1; i <= periods; ++i) {
        const Pose to = pose_at(path_, now_s + i * period_s_);
        out.turn_ahead_rad_s = std::max(out.turn_ahead_rad_s, angle_between(from, to) / period_s_);
        from = to;
    }
    return out;
}

}  // namespace surefoot::walk
