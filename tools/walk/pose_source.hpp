// Where a frame's pose comes from: a path, or an input that steers. Called on the frame thread.
#pragma once

#include <cstdint>

#include "rt/base/path.hpp"
#include "tools/walk/prepare_thread.hpp"

namespace surefoot::walk {

/// The pose of one frame, and what is in it.
struct FramePose {
    Pose pose;
    Pose before;                ///< a period earlier, by the motion that goes on from here: asked where no frame has seen it
    Foresight foresight;        ///< where the eye can be in the next frames, where the source knows better than two poses do
    bool jumped = false;        ///< put there since the last frame: what that one saw says nothing about this one's motion
    bool stopped = false;       ///< stands still by order: emergency stop or dead-man
    std::int64_t stamp_ns = 0;  ///< of the newest report in it; 0: none
    std::uint64_t reports = 0;  ///< in it, since the walk began
};

/// What a source may go by.
struct FrameTime {
    std::uint64_t path_slot = 0;  ///< periods that the walk has been under way
    std::int64_t due_ns = 0, now_ns = 0;
};

/// Neither allocates, locks, nor waits.
class PoseSource {
public:
    virtual ~PoseSource() = default;
    /// At the frame's start.
    virtual FramePose sample(const FrameTime& time) = 0;
    /// Just before the first slice: the newest there is by now. False: none newer than the last.
    virtual bool latch(const FrameTime& time, FramePose& newest) = 0;
};

/// Poses of a recorded path, forth and back.
class PathPoses final : public PoseSource {
public:
    PathPoses(const Path& path, std::int64_t period_ns) : path_(path), period_s_(static_cast<double>(period_ns) * 1e-9) {}
    FramePose sample(const FrameTime& time) override;
    bool latch(const FrameTime& /*time*/, FramePose& /*newest*/) override { return false; }

private:
    const Path& path_;
    double period_s_;
};

}  // namespace surefoot::walk
