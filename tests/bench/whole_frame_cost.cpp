// Bench: predicted against measured whole-frame cost on random poses, online correction frozen at 1.
// Each is drawn in eight rounds, and counts as measure::robust_frame_times() says; beside it, how two measurements differ
// here, once round for round and once by robust_frame_times() over four rounds each: no prediction can be nearer than that.
// bench_whole_frame_cost MODEL.walk [POSES 500] [PATH.csv] [STATE_DIR] [fitted|table] [LIFT_M] -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/measure/calibrate_fit.hpp"
#include "rt/base/random.hpp"
#include "rt/base/statistics.hpp"
#include "rt/threads/memory.hpp"
#include "rt/threads/placement.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/walk/placing.hpp"

namespace {

using namespace surefoot;
using bench::fail;

std::int64_t now_ns(void* /*context*/) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using Rounds = std::vector<std::vector<measure::FrameSample>>;  // [pose][round]

/// Random poses at random budgets, drawn in `rounds` rounds.
Rounds drawn(Engine& engine, const Path& path, std::size_t poses, int rounds) {
    constexpr std::size_t warm_up = 20;
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    SubmitLimits limits;
    limits.limit_us = 1e12;
    limits.now_ns = now_ns;
    Rounds frames(poses);
    for (int round = 0; round < rounds; ++round) {
        Random random(2026);  // the same poses again
        for (std::size_t i = 0; i < poses + warm_up; ++i) {
            const Pose pose = walk::random_pose(path, random);
            const double budget_us = random.range(3000, 28000);
            engine.prepare({pose, 0, 0}, 0, 0, 0, prepared);
            engine.select(prepared, budget_us, {}, 0);
            engine.submit(pose, limits);
            const SubmitReport report = engine.submit(pose, limits);
            if (i < warm_up) continue;
            frames[i - warm_up].push_back({static_cast<double>(report.predicted.submit_us),
                                           static_cast<double>(report.predicted.raster_us), report.finished_us});
        }
    }
    return frames;
}

/// Even rounds, or odd ones.
Rounds half_of(const Rounds& frames, std::size_t which) {
    Rounds half(frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
        for (std::size_t r = which; r < frames[i].size(); r += 2) half[i].push_back(frames[i][r]);
    return half;
}

/// |a - b| / b of the frames that both drew alike.
std::vector<double> apart(const std::vector<measure::FrameSample>& a, const std::vector<measure::FrameSample>& b) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].submit_us == b[i].submit_us && a[i].raster_us == b[i].raster_us)
            errors.push_back(std::abs(a[i].actual_us - b[i].actual_us) / b[i].actual_us);
    return errors;
}

std::vector<measure::FrameSample> round_of(const Rounds& frames, std::size_t round) {
    std::vector<measure::FrameSample> of;
    for (const auto& frame : frames) of.push_back(frame[round]);
    return of;
}

std::vector<double> relative_errors(const std::vector<double>& of, const std::vector<double>& against) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < of.size(); ++i) errors.push_back(std::abs(of[i] - against[i]) / against[i]);
    return errors;
}

std::string quantiles_json(const std::vector<double>& v) {
    return fmt::format("{{\"p50\": {:.4f}, \"p90\": {:.4f}, \"p99\": {:.4f}}}", quantile_of(v, 0.5), quantile_of(v, 0.9),
                       quantile_of(v, 0.99));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2)
        return fmt::print(stderr, "bench_whole_frame_cost MODEL.walk [POSES] [PATH.csv] [STATE_DIR] [fitted|table] [LIFT_M]\n"),
               2;
    const int poses = argc > 2 ? std::atoi(argv[2]) : 500;
    bench::SceneArguments arguments{argv[1]};
    if (argc > 3) arguments.path_file = argv[3];
    if (argc > 4) arguments.state_dir = argv[4];
    arguments.fitted = argc > 5 && std::string_view(argv[5]) == "fitted";
    if (argc > 6) arguments.lift_m = std::atof(argv[6]);
    auto scene = bench::open_scene(arguments);
    if (!scene) return fail(scene.error());
    const model::CostModel& costs = scene->costs;
    const Path& path = scene->path.path;
    (void)rt::prepare_memory({});
    EngineOptions options;
    options.in_frame_check = false;
    auto engine = Engine::open(std::move(scene->model), costs, options);
    if (!engine) return fail(engine.error());
    walk::WalkRequest request;
    auto plan = walk::plan_placing(request, true);
    if (!plan) return fail(plan.error());
    (void)walk::place_rasterisers(*plan);
    (void)rt::place_thread(0, walk::frame_placement(*plan));
    (*engine)->device().bind();

    constexpr int rounds = 8;
    const Rounds frames = drawn(**engine, path, static_cast<std::size_t>(poses), rounds);
    const measure::FrameTimes frame_times = measure::robust_frame_times(frames);
    std::vector<double> took, predicted, ratios, at_speed;
    for (const measure::FrameSample& f : frame_times.frames) {
        took.push_back(f.actual_us);
        predicted.push_back(
            static_cast<double>(costs.combine.frame_us(static_cast<float>(f.submit_us), static_cast<float>(f.raster_us))));
        ratios.push_back(took.back() / predicted.back());
    }
    // What a correction of the run's own speed would leave: the machine's speed moves between calibration and this run.
    const double speed = quantile_of(ratios, 0.5);
    for (const double us : predicted) at_speed.push_back(speed * us);
    fmt::print(
        "{{\"model\": \"{}\", \"poses\": {}, \"error\": {}, \"error_at_the_runs_speed\": {}, \"actual_over_predicted\": "
        "{{\"p10\": {:.3f}, \"p50\": {:.3f}, \"p90\": {:.3f}}}, \"frame_ms\": {{\"p50\": {:.2f}, \"p90\": {:.2f}}}, "
        "\"slowdown\": {:.3f}, \"repeated\": {}, \"two_measurements\": {{\"of_a_round_each\": {}, \"of_four_rounds_each\": "
        "{}}}}}\n",
        argv[1], poses, quantiles_json(relative_errors(predicted, took)), quantiles_json(relative_errors(at_speed, took)),
        quantile_of(ratios, 0.1), speed, quantile_of(ratios, 0.9), 1e-3 * quantile_of(took, 0.5), 1e-3 * quantile_of(took, 0.9),
        frame_times.slowdown, frame_times.repeated, quantiles_json(apart(round_of(frames, 1), round_of(frames, rounds - 1))),
        quantiles_json(apart(measure::robust_frame_times(half_of(frames, 0)).frames,
                             measure::robust_frame_times(half_of(frames, 1)).frames)));
    return 0;
}
