// Bench: predicted against measured whole-frame cost on random poses, online correction frozen at 1.
// bench_whole_frame_cost MODEL.walk [POSES 500] [PATH.csv] [STATE_DIR] [fitted|table] [LIFT_M] -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "render/engine.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/random.hpp"
#include "rt/threads/memory.hpp"
#include "rt/threads/placement.hpp"
#include "tests/bench/statistics.hpp"
#include "tools/app/path_source.hpp"
#include "tools/app/placing.hpp"
#include "tools/app/state.hpp"

namespace {

using namespace surefoot;
using bench::quantile;

std::int64_t now_ns(void* /*context*/) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int fail(const Error& error) {
    fmt::print(stderr, "{}\n", error.text());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2)
        return fmt::print(stderr, "bench_whole_frame_cost MODEL.walk [POSES] [PATH.csv] [STATE_DIR] [fitted|table] [LIFT_M]\n"),
               2;
    const int poses = argc > 2 ? std::atoi(argv[2]) : 500;
    model::WalkFileInfo info;
    auto model = model::read_walk(argv[1], &info);
    if (!model) return fail(model.error());
    auto path = app::choose_path(argc > 3 ? argv[3] : "", argv[1], *model, argc > 6 ? std::atof(argv[6]) : 0);
    if (!path) return fail(path.error());
    std::string note;
    auto costs = app::load_costs(app::state_directory(argc > 4 ? argv[4] : ""), "", note);
    if (!costs) return fail(costs.error());
    if (!note.empty()) fmt::print(stderr, "{}\n", note);
    if (argc > 5 && std::string_view(argv[5]) == "fitted") {  // "fitted": as `surefoot calibrate MODEL.walk` left it
        costs = app::fitted_costs(app::state_directory(argv[4]), *costs, {info.hash, 1280, 720, "egl"});
        if (!costs) return fail(costs.error());
    }
    (void)rt::prepare_memory({});
    EngineOptions options;
    options.in_frame_check = false;
    auto engine = Engine::open(std::move(*model), *costs, options);
    if (!engine) return fail(engine.error());
    app::WalkRequest request;
    auto plan = app::plan_placing(request, true);
    if (!plan) return fail(plan.error());
    (void)app::place_rasterisers(*plan);
    (void)rt::place_thread(0, app::frame_placement(*plan));
    (*engine)->device().bind();

    Random random(2026);
    prepare::PreparedFrame prepared;
    (*engine)->reserve(prepared);
    SubmitLimits limits;
    limits.limit_us = 1e12;
    limits.now_ns = now_ns;
    std::vector<double> errors, ratios, frame_ms;
    for (int i = 0; i < poses + 20; ++i) {
        const Pose pose = app::random_pose(path->path, random);
        const double budget_us = random.range(3000, 28000);
        (*engine)->prepare({pose, 0, 0}, 0, 0, 0, prepared);
        (*engine)->select(prepared, budget_us, {}, 0);
        std::vector<double> times;
        double predicted = 0;
        for (int r = 0; r < 3; ++r) {
            const SubmitReport report = (*engine)->submit(pose, limits);
            times.push_back(report.finished_us);
            predicted = report.predicted_us;
        }
        if (i < 20) continue;  // warm-up
        std::sort(times.begin(), times.end());
        errors.push_back(std::abs(predicted - times[1]) / times[1]);
        ratios.push_back(times[1] / predicted);
        frame_ms.push_back(times[1] * 1e-3);
    }
    // What a correction of the run's own speed would leave: the machine's speed moves between calibration and this run.
    const double speed = quantile(ratios, 0.5);
    std::vector<double> shape;
    for (const double ratio : ratios) shape.push_back(std::abs(speed / ratio - 1));
    fmt::print(
        "{{\"model\": \"{}\", \"poses\": {}, \"error\": {{\"p50\": {:.4f}, \"p90\": {:.4f}, \"p99\": {:.4f}}}, "
        "\"error_at_the_runs_speed\": {{\"p50\": {:.4f}, \"p90\": {:.4f}, \"p99\": {:.4f}}}, "
        "\"actual_over_predicted\": {{\"p10\": {:.3f}, \"p50\": {:.3f}, \"p90\": {:.3f}}}, \"frame_ms\": {{\"p50\": {:.2f}, "
        "\"p90\": {:.2f}}}}}\n",
        argv[1], poses, quantile(errors, 0.5), quantile(errors, 0.9), quantile(errors, 0.99), quantile(shape, 0.5),
        quantile(shape, 0.9), quantile(shape, 0.99), quantile(ratios, 0.1), speed, quantile(ratios, 0.9), quantile(frame_ms, 0.5),
        quantile(frame_ms, 0.9));
    return 0;
}
