// The coordinator of preparation, on its own grid.
#include "tools/app/prepare_thread.hpp"

#include <algorithm>
#include <cmath>

#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::app {

void prepare_after(Engine& engine, const PoseSample& sample, double period_s, prepare::PreparedFrame& out) {
    if (const Foresight& f = sample.foresight; f.known) {
        engine.prepare(f.region, sample.frame, f.speed_m_s, f.turn_rad_s, out);
        return;
    }
    const double dt_s = std::max(sample.dt_s, 1e-3);
    const prepare::Region region = predict_region(sample.before, sample.pose, dt_s, horizon_periods * period_s);
    const double speed_mps = glm::length(sample.pose.position - sample.before.position) / dt_s;
    const double w = std::min(1.0, std::abs(glm::dot(sample.pose.orientation, sample.before.orientation)));
    engine.prepare(region, sample.frame, speed_mps, 2.0 * std::acos(w) / dt_s, out);
}

PrepareThread::PrepareThread(Engine& engine, rt::Grid grid, rt::TripleBuffer<PoseSample>& poses,
                             rt::TripleBuffer<prepare::PreparedFrame>& prepared)
    : engine_(engine), grid_(grid), poses_(poses), prepared_(prepared), thread_([this] { run(); }) {}

PrepareThread::~PrepareThread() { stop(); }

void PrepareThread::stop() {
    stopping_.store(true);
    if (thread_.joinable()) thread_.join();
}

void PrepareThread::run() {
    (void)rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = "sf-prepare"});
    rt::RealClock clock;
    const double period_s = static_cast<double>(grid_.period_ns) * 1e-9;
    // A fortieth of a period after the frame's start: the pose is there by then, and most of the period is left.
    const std::int64_t offset_ns = grid_.period_ns / 40;
    std::uint64_t seen = ~0ULL;
    while (!stopping_.load(std::memory_order_relaxed)) {
        if (poses_.refresh() && poses_.front().valid && poses_.front().frame != seen) {
            seen = poses_.front().frame;
            prepare_after(engine_, poses_.front(), period_s, prepared_.back());
            prepared_.publish();
        }
        const std::int64_t now = clock.now_ns();
        const std::int64_t slot = now <= grid_.t0_ns ? -1 : (now - offset_ns - grid_.t0_ns) / grid_.period_ns;
        clock.sleep_until_ns(grid_.t0_ns + (slot + 1) * grid_.period_ns + offset_ns);
    }
}

}  // namespace surefoot::app
