// Poses that an input steers: the newest sample, moved to the frame's due time, with bounds of the next poses.
#pragma once

#include "input/motion/motion.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "tools/walk/input_stepper.hpp"
#include "tools/walk/pose_source.hpp"

namespace surefoot::walk {

/// A sample's pose is carried forward or back to the frame's due time, by at most this much. So the phase between input steps and
/// frames does not show. If the input thread stalls for longer, the eye stays where it was.
constexpr std::int64_t carry_limit_ns = 2 * input_tick_ns;

/// How far ahead of a sample its region of poses reaches.
inline double region_ahead_s(std::int64_t period_ns) {
    return horizon_s(static_cast<double>(period_ns) * 1e-9) + static_cast<double>(carry_limit_ns) * 1e-9;
}

/// Poses of a walk that devices steer. For the frame thread.
/// A walker's region is clipped by walls: it is around where walls let the eye come to, and no larger than to the nearest wall.
class SteeredPoses final : public PoseSource {
public:
    /// `path_poses`: in place of samples while nobody has left the path; must outlive this. `inline_stepper`: on the virtual
    /// clock, stepped here up to the frame's time; null: a thread of its own steps it. `timed`: the stepper that is notified of
    /// the walk's time.
    SteeredPoses(rt::TripleBuffer<SteeredSample>& samples, const input::MotionLimits& limits, std::int64_t period_ns,
                 InputStepper* inline_stepper, PathPoses* path_poses = nullptr, InputStepper* timed = nullptr);

    FramePose sample(const FrameTime& time) override;
    bool latch(const FrameTime& time, FramePose& newest) override;

private:
    [[nodiscard]] FramePose pose_of(const FrameTime& time) const;

    rt::TripleBuffer<SteeredSample>& samples_;
    input::MotionLimits limits_;
    std::int64_t period_ns_;
    InputStepper* inline_stepper_;
    PathPoses* path_poses_;
    InputStepper* timed_;
    std::uint32_t jumps_seen_ = 0;
};

}  // namespace surefoot::walk
