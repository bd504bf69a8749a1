// The coordinator of preparation. A little after each frame's start it takes the newest pose, lets the workers prepare, and
// publishes. The frame thread neither waits for it nor wakes it. It is notified of jumps (to a viewpoint) between frames, so that
// the first frame there is prepared too.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <latch>
#include <optional>
#include <thread>

#include "render/engine.hpp"
#include "rt/base/thread_annotations.hpp"
#include "rt/clock/grid.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/frame/blame.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::walk {

/// Where the eye can be until `horizon_s()` from now, if its input knows that.
struct PredictedRegion {
    bool known = false;
    prepare::Region region;  ///< a path's next poses; or the hand's, and how far from it the limits of motion allow
    double speed_m_s = 0, turn_rad_s = 0;
    bool on_foot = false;  ///< a walker stands at `feet` and `eye`, and its velocity leads `way` on: walls clip the region
    dvec3 feet{0.0}, eye{0.0}, way{0.0};
    double carried_m = 0;  ///< of a walker: how far what moves may carry it until then
};

/// What the frame thread publishes at each frame's start.
struct PoseSample {
    std::uint64_t frame = 0;   ///< rehearsed and walked frames, from 0
    std::int64_t time_ns = 0;  ///< when it was due
    Pose pose, before;         ///< now, and one frame ago
    double dt_s = 0;
    PredictedRegion predicted;  ///< not known: the last two poses say where the walk goes
    PrepareHints hints;
    bool valid = false;
};

/// Sets are prepared for this long ahead of the newest pose: until they are too old to be used.
constexpr double horizon_s(double period_s) {
    const auto period_ns = static_cast<std::int64_t>(period_s * 1e9 + 0.5);  // NOLINT(bugprone-incorrect-roundings): above 0
    return rt::oldest_prepared(period_ns) * period_s;
}

/// How long a set is used where things move: a set may be two periods older than its frames say, without things that moved away.
constexpr double span_s(double period_s) { return horizon_s(period_s) + 2 * period_s; }

class RegionClip;

/// Where the eye is expected in the frames after `sample`: of its input, or by its last two poses.
prepare::Region region_after(const PoseSample& sample, double period_s);

/// Fills `out` for the frames after `sample`. Shared by the thread below and by the virtual clock's inline preparation. `clip`:
/// null where nobody walks.
void prepare_after(Engine& engine, const PoseSample& sample, double period_s, RegionClip* clip, prepare::PreparedFrame& out);

/// Poses that the eye jumps to (buttons), from the input thread. Only poses and times are used.
using JumpBuffer = rt::TripleBuffer<PoseSample>;

/// When the next set is prepared. Rasterisers and workers may share cores: what preparing takes there, frames lose. Then one set
/// serves for two frames, if the last one was ready before the second frame, and if it covers the pose.
class PrepareRhythm {
public:
    PrepareRhythm(std::uint64_t frames_a_set, double period_us) : frames_a_set_(frames_a_set), period_us_(period_us) {}
    /// Whether to prepare after this frame.
    [[nodiscard]] bool due(const PoseSample& now) const {
        return !any_ || now.frame - last_ >= frames_a_set_ || !covers(region_, now.pose, viewport_);
    }
    void prepared(const prepare::PreparedFrame& set) {
        constexpr double ready = 0.9;  // of the period
        last_ = set.frame;
        region_ = set.region;
        viewport_ = set.viewport;
        any_ = set.wall_us < ready * period_us_;
    }
    /// The next frame is prepared whatever the last set was.
    void forget() { any_ = false; }

private:
    std::uint64_t frames_a_set_, last_ = 0;
    double period_us_;
    prepare::Region region_;
    model::Viewport viewport_;
    bool any_ = false;
};

/// Runs preparation on a thread of its own, at most once a frame.
class PrepareThread {
public:
    /// Start from a neutral thread; the thread is in its place when this returns. The buffers must outlive it. `jump_poses`: null
    /// if the eye never jumps; else it is read eight times a period. `clip`: null if nobody walks. shares_cores: with the
    /// rasterisers. delay: called before each set, by tests; may be empty.
    PrepareThread(Engine& engine, rt::Grid grid, rt::TripleBuffer<PoseSample>& poses,
                  rt::TripleBuffer<prepare::PreparedFrame>& prepared, JumpBuffer* jump_poses, RegionClip* clip,
                  rt::Placement placement, bool shares_cores, std::function<void()> delay = {});
    ~PrepareThread();
    PrepareThread(const PrepareThread&) = delete;
    PrepareThread& operator=(const PrepareThread&) = delete;
    void stop();
    /// The error if it could not be placed.
    [[nodiscard]] const std::optional<Error>& misplaced() const { return misplaced_; }

private:
    void run();
    void prepare_newest() REQUIRES(prepares_);
    [[no_unique_address]] ThreadRole prepares_;  ///< the thread below
    Engine& engine_;
    rt::Grid grid_;
    rt::TripleBuffer<PoseSample>& poses_;
    rt::TripleBuffer<prepare::PreparedFrame>& prepared_;
    JumpBuffer* jump_poses_;
    RegionClip* clip_;
    PrepareRhythm rhythm_ GUARDED_BY(prepares_);
    std::uint64_t seen_ GUARDED_BY(prepares_) = ~0ULL;  ///< frame prepared after last
    const std::function<void()> delay_;
    const rt::Placement placement_;
    std::optional<Error> misplaced_;  ///< written before placed_
    std::latch placed_{1};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace surefoot::walk
