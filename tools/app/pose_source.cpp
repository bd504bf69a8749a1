// Poses along a path.
#include "tools/app/pose_source.hpp"

#include "tools/app/visit.hpp"

namespace surefoot::app {

FramePose PathPoses::sample(const FrameTime& time) {
    FramePose out;
    out.pose = pose_at(path_, static_cast<double>(time.path_slot) * period_s_);
    return out;
}

}  // namespace surefoot::app
