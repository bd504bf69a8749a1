// The coordinator of preparation, on its own grid.
#include "tools/walk/prepare_thread.hpp"

#include <algorithm>
#include <cmath>

#include "rt/clock/clock.hpp"
#include "tools/walk/region_clip.hpp"

namespace surefoot::walk {

prepare::Region region_after(const PoseSample& sample, double period_s) {
    if (sample.predicted.known) return sample.predicted.region;
    return predict_region(sample.before, sample.pose, std::max(sample.dt_s, 1e-3), horizon_s(period_s));
}

void prepare_after(Engine& engine, const PoseSample& sample, double period_s, RegionClip* clip, prepare::PreparedFrame& out) {
    if (PredictedRegion f = sample.predicted; f.known) {
        if (clip != nullptr) clip->clip(f);
        engine.prepare(f.region, sample.frame, f.speed_m_s, f.turn_rad_s, out, sample.hints);
        return;
    }
    const double dt_s = std::max(sample.dt_s, 1e-3);
    const prepare::Region region = region_after(sample, period_s);
    const double speed_mps = glm::length(sample.pose.position - sample.before.position) / dt_s;
    const double w = std::min(1.0, std::abs(glm::dot(sample.pose.orientation, sample.before.orientation)));
    engine.prepare(region, sample.frame, speed_mps, 2.0 * std::acos(w) / dt_s, out, sample.hints);
}

PrepareThread::PrepareThread(Engine& engine, rt::Grid grid, rt::TripleBuffer<PoseSample>& poses,
                             rt::TripleBuffer<prepare::PreparedFrame>& prepared, JumpBuffer* jump_poses, RegionClip* clip,
                             rt::Placement placement, bool shares_cores, std::function<void()> delay)
    : engine_(engine),
      grid_(grid),
      poses_(poses),
      prepared_(prepared),
      jump_poses_(jump_poses),
      clip_(clip),
      rhythm_(shares_cores ? 2 : 1, 1e-3 * static_cast<double>(grid.period_ns)),
      delay_(std::move(delay)),
      placement_(std::move(placement)),
      thread_([this] { run(); }) {
    placed_.wait();
}

PrepareThread::~PrepareThread() { stop(); }

void PrepareThread::stop() {
    stopping_.store(true);
    if (thread_.joinable()) thread_.join();
}

void PrepareThread::prepare_newest() {
    const double period_s = static_cast<double>(grid_.period_ns) * 1e-9;
    const bool frame = poses_.refresh() && poses_.front().valid && poses_.front().frame != seen_;
    bool jump = jump_poses_ != nullptr && jump_poses_->refresh();
    jump = jump && poses_.front().valid && jump_poses_->front().time_ns > poses_.front().time_ns;  // else a frame has it already
    if (!frame && !jump) return;
    if (!jump && !rhythm_.due(poses_.front())) return;
    PoseSample sample = poses_.front();
    if (jump) {  // the next frame is drawn there
        sample.pose = jump_poses_->front().pose;
        sample.before = jump_poses_->front().before;
        sample.dt_s = jump_poses_->front().dt_s;
        sample.predicted = {};
    }
    seen_ = sample.frame;
    if (delay_) delay_();
    prepare_after(engine_, sample, period_s, clip_, prepared_.back());
    rhythm_.prepared(prepared_.back());
    if (jump) rhythm_.forget();  // its region is of a standing eye
    prepared_.publish();
}

void PrepareThread::run() {
    prepares_.plays();
    if (auto placed = rt::place_thread(0, placement_); !placed) {
        misplaced_ = placed.error();
        (void)rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = placement_.cpus, .name = placement_.name});
    }
    placed_.count_down();
    rt::RealClock clock;
    // A fortieth of a period after the frame's start: the pose is there by then, and most of the period is left.
    const std::int64_t offset_ns = grid_.period_ns / 40;
    const std::int64_t step_ns = jump_poses_ != nullptr ? grid_.period_ns / 8 : grid_.period_ns;
    while (!stopping_.load(std::memory_order_relaxed)) {
        prepare_newest();
        // The steps are counted from each frame's start, so that one of them is always where it is without them. The newest
        // frame says where the grid is: a display may move it.
        const bool begun = poses_.front().valid && poses_.front().time_ns >= grid_.t0_ns;
        const std::int64_t begun_ns = (begun ? poses_.front().time_ns : grid_.t0_ns) + offset_ns, now = clock.now_ns();
        if (now < begun_ns) {
            clock.sleep_until_ns(std::min(now + grid_.period_ns / 8, begun_ns));  // rehearsed frames come at any time
            continue;
        }
        const std::int64_t slot = (now - begun_ns) / grid_.period_ns, slot_ns = begun_ns + slot * grid_.period_ns;
        const std::int64_t next_ns = slot_ns + ((now - slot_ns) / step_ns + 1) * step_ns;
        clock.sleep_until_ns(std::min(next_ns, slot_ns + grid_.period_ns));
    }
}

}  // namespace surefoot::walk
