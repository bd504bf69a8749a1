// Poses along a path.
#include "tools/walk/pose_source.hpp"

#include <algorithm>
#include <cmath>

#include "render/engine.hpp"
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

/// A late frame may look a little past the next views.
constexpr double margin_rad = 0.03;

}  // namespace

FramePose PathPoses::sample(const FrameTime& time) {
    FramePose out;
    const double now_s = static_cast<double>(time.path_slot) * period_s_;
    out.pose = pose_at(path_, now_s);
    out.before = time.path_slot > 0 ? pose_at(path_, now_s - period_s_) : mirrored(pose_at(path_, period_s_), out.pose);
    // Where the eye will be is extrapolated: so costs are predicted alike where it stands and where it walks. Where it will look
    // is known. A set that is prepared now is first used in the next frame, the walk's first one at once. It serves until the
    // horizon.
    prepare::Region region = predict_region(out.before, out.pose, period_s_, horizon_s(period_s_));
    const int first = time.path_slot > 0 ? 1 : 0;
    const auto last = static_cast<int>(std::lround(horizon_s(period_s_) / period_s_)) + 1;
    const Pose middle = pose_at(path_, now_s + 0.5 * (first + last) * period_s_);
    region.centre.orientation = middle.orientation;
    region.centre.fov_y_rad = middle.fov_y_rad;
    region.angle_rad = margin_rad;
    for (int i = first; i <= last; ++i) {
        const Pose next = pose_at(path_, now_s + i * period_s_);
        region.angle_rad =
            std::max(region.angle_rad, angle_between(next, middle) + model::widened_rad(next, middle, viewport_) + margin_rad);
    }
    region.angle_rad = std::min(region.angle_rad, 1.0);
    out.predicted = {true, region, glm::length(out.pose.position - out.before.position) / period_s_,
                     angle_between(out.pose, out.before) / period_s_};
    return out;
}

}  // namespace surefoot::walk
