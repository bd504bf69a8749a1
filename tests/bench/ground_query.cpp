// Bench: how long the walker's question takes. A visitor walks at random for ten minutes of 500 steps a second, from where the
// default path begins. Steps are timed as the input thread takes them, and the clipping of regions as the preparing thread does.
// bench_ground_query MODEL.walk [SECONDS 600] [SEED 1] -> one JSON object.
#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "rt/base/random.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/walk/region_clip.hpp"
#include "tools/walk/walking.hpp"

namespace {

using namespace surefoot;

constexpr double step_s = 0.002;
constexpr double ahead_s = 0.13, turned_rad = 0.2;  // as prepared at 30 Hz
constexpr int steps_of_a_frame = 17;
constexpr int steps_of_a_whim = 500;

double now_us() { return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Timed {
    std::vector<double> step_us, clip_us;
    double walked_m = 0;
};

/// Turns and changes pace at random; turns away from what stops it no sooner than at its next whim.
Timed time_steps(walk::Walking& walking, walk::RegionClip& clip, dvec3 eye, double seconds, std::uint64_t seed) {
    Random random(seed);
    Timed timed;
    const auto steps = static_cast<std::size_t>(seconds / step_s);
    timed.step_us.reserve(steps), timed.clip_us.reserve(steps);
    double heading = random.range(0, 6.28), turn = 0, speed = 1.4;
    for (std::size_t i = 0; i < steps; ++i) {
        if (i % steps_of_a_whim == 0) turn = random.range(-1.2, 1.2), speed = random.below(10) == 0 ? 0 : random.range(0.3, 4);
        heading += turn * step_s;
        const dvec3 velocity = dvec3(std::cos(heading), 0, std::sin(heading)) * speed;
        const double begun = now_us();
        const input::Ground ground = walking.ground(false);
        const dvec3 next = ground.query(ground.context, eye, eye + velocity * step_s, step_s);
        timed.step_us.push_back(now_us() - begun);
        if (i % steps_of_a_frame == 0 && walking.walker()->stands()) {
            walk::PredictedRegion region;
            region.known = region.on_foot = true;
            region.region.centre.position = next + velocity * ahead_s;
            region.region.radius_m =
                glm::length(velocity) * turned_rad + 0.5 * input::MotionLimits{}.accel_m_s2 * ahead_s * ahead_s;
            region.feet = walking.walker()->feet(), region.eye = next, region.way = velocity * ahead_s;
            const double before = now_us();
            clip.clip(region);
            timed.clip_us.push_back(now_us() - before);
        }
        timed.walked_m += std::hypot(next.x - eye.x, next.z - eye.z);
        eye = next;
    }
    return timed;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return bench::fail({"MODEL.walk", "is missing", "give a baked model"});
    auto model = model::read_walk(argv[1]);
    if (!model) return bench::fail(model.error());
    if (model->ground.empty() || model->tour.samples.empty())
        return bench::fail({argv[1], "has no ground or no default path", "bake it anew"});
    const double seconds = argc > 2 ? std::atof(argv[2]) : 600;
    walk::Walking walking(model->ground, {}, rt::WalkingMode::walk);
    walk::RegionClip clip(model->ground, {});
    const dvec3 start = model->tour.samples.front().pose.position;
    (void)::mlockall(MCL_CURRENT | MCL_FUTURE);    // as a walk does; refused, times are longer
    (void)time_steps(walking, clip, start, 1, 7);  // warms caches and touches the model's pages
    Timed timed = time_steps(walking, clip, start, seconds, argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
    const auto quantiles = [](std::vector<double>& us) {
        return fmt::format("{{\"p50\": {:.3f}, \"p99\": {:.3f}, \"p999\": {:.3f}, \"max\": {:.3f}}}", quantile_of(us, 0.5),
                           quantile_of(us, 0.99), quantile_of(us, 0.999), *std::max_element(us.begin(), us.end()));
    };
    fmt::print("{{\"steps\": {}, \"walked_m\": {:.1f}, \"returns\": {}, \"step_us\": {}, \"clip_us\": {}}}\n",
               timed.step_us.size(), timed.walked_m, walking.walker()->returns(), quantiles(timed.step_us),
               quantiles(timed.clip_us));
    return 0;
}
