// Poses along a path.
#include "tools/walk/pose_source.hpp"

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

}  // namespace

FramePose PathPoses::sample(const FrameTime& time) {
    FramePose out;
    const double now_s = static_cast<double>(time.path_slot) * period_s_;
    out.pose = pose_at(path_, now_s);
    out.before = time.path_slot > 0 ? pose_at(path_, now_s - period_s_) : mirrored(pose_at(path_, period_s_), out.pose);
    return out;
}

}  // namespace surefoot::walk
