// Where a frame's pose comes from: a path, or an input that steers. Called on the frame thread.
#pragma once

#include <cstdint>

#include "rt/base/light.hpp"
#include "rt/base/path.hpp"
#include "tools/walk/prepare_thread.hpp"

namespace surefoot::walk {

/// The pose of one frame, and the input that it contains.
struct FramePose {
    Pose pose;
    Pose before;                 ///< one period earlier by the same motion; used if no frame has shown it
    PredictedRegion predicted;   ///< possible poses of the next frames, if the source knows more than its last two poses
    bool jumped = false;         ///< a jump since the last frame: the last pose says nothing about this motion
    bool stopped = false;        ///< stands still: emergency stop or dead-man
    std::int64_t stamp_ns = 0;   ///< of the newest report in it; 0: none
    std::uint64_t reports = 0;   ///< in it, since the walk began
    rt::SwitchPresses switches;  ///< of the light, until then
};

/// The time of a frame, for a source.
struct FrameTime {
    std::uint64_t path_slot = 0;  ///< periods since the start of the walk
    std::int64_t due_ns = 0, now_ns = 0;
};

/// Neither allocates, locks, nor waits.
class PoseSource {
public:
    virtual ~PoseSource() = default;
    /// At the frame's start.
    virtual FramePose sample(const FrameTime& time) = 0;
    /// Just before the first slice: the newest pose. False: none is newer than the last.
    virtual bool latch(const FrameTime& time, FramePose& newest) = 0;
};

/// Poses of a recorded path, forwards and backwards in turn. Where the next frames look, and how wide, is known.
class PathPoses final : public PoseSource {
public:
    PathPoses(const Path& path, std::int64_t period_ns, model::Viewport viewport = {})
        : path_(path), period_s_(static_cast<double>(period_ns) * 1e-9), viewport_(viewport) {}
    FramePose sample(const FrameTime& time) override;
    bool latch(const FrameTime& /*time*/, FramePose& /*newest*/) override { return false; }

private:
    const Path& path_;
    double period_s_;
    model::Viewport viewport_;  ///< of the picture
};

}  // namespace surefoot::walk
