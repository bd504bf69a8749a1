// Bench: a picture at rest on the real clock. Stands still for some seconds at one pose of a path, in frames of a walk.
// Judged: when full detail is shown, how near it is to a frame of full detail, and the last picture to the mean of 64 samples
// that lie on a regular grid. With a folder: writes the pictures before, in full detail, and of 64 samples. bench_rest_picture
// MODEL.walk [PATH.csv] [AT_S 0] [STATE_DIR] [LIFT_M 0] [SECONDS 20] [FOLDER] -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "render/engine.hpp"
#include "render/image/image.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/threads/memory.hpp"
#include "tests/bench/bench_picture.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/report/report.hpp"

namespace {

using namespace surefoot;
using bench::fail;

constexpr std::int64_t period_ns = 33'333'333;
constexpr double rest_after_ms = 500;
constexpr double frame_share = 0.88;  // of the period, as in a walk

std::int64_t now_ns(void* /*context*/) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using bench::Pixels, bench::psnr_db, bench::shown;

/// What was seen while the eye stood still.
struct Stand {
    Pixels before, full, last;
    double full_ms = -1, smooth_ms = -1, frame_ms_max = 0;  ///< from the first frame
    int frames = 0, late = 0, late_without_rest = 0;
    std::uint32_t samples = 0;
    double changed_before = 0;  ///< largest share of pixels that changed from frame to frame at rest, until full detail
};

Stand stand(Engine& engine, const Pose& pose, double seconds) {
    Stand s;
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    SubmitLimits limits;
    limits.limit_us = frame_share * 1e-3 * static_cast<double>(period_ns);
    limits.now_ns = now_ns;
    const std::int64_t begun = now_ns(nullptr);
    std::int64_t due = begun;
    for (double at_s = 0; at_s < seconds; at_s = 1e-9 * static_cast<double>(due - begun)) {
        engine.prepare({pose, 0.25, 0.06}, static_cast<std::uint64_t>(s.frames), 0, 0, prepared);
        const std::int64_t start = now_ns(nullptr);
        engine.select(prepared, frame_share * 1e-3 * static_cast<double>(period_ns), {}, 0);
        limits.frame_ns = due;
        limits.elapsed_us = 1e-3 * static_cast<double>(now_ns(nullptr) - start);
        const SubmitReport report = engine.submit(pose, limits);
        const std::int64_t end = now_ns(nullptr);
        s.frame_ms_max = std::max(s.frame_ms_max, 1e-6 * static_cast<double>(end - start));
        (report.at_rest ? s.late : s.late_without_rest) += end - start > period_ns ? 1 : 0;
        ++s.frames;
        const bool reads = report.rest_samples <= 1 || report.rest_samples != s.samples;
        s.samples = report.rest_samples;
        Pixels now;
        if (reads) now = shown(engine.device());
        if (report.rest_samples == 0) {
            if (report.at_rest && !s.before.empty())
                s.changed_before = std::max(s.changed_before, 1 - measure::share_within(s.before, now, 0));
            s.before = std::move(now);
        } else if (reads) {
            const double ms = 1e-6 * static_cast<double>(end - begun);
            if (s.full.empty()) s.full = now, s.full_ms = ms;
            if (report.rest_samples == 64) s.smooth_ms = ms;
            s.last = std::move(now);
        }
        due += period_ns;
        const std::int64_t left = due - now_ns(nullptr);
        if (left > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(left));
        due = std::max(due, now_ns(nullptr));  // reading the picture takes longer than a frame
    }
    return s;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2)
        return fmt::print(stderr, "bench_rest_picture MODEL.walk [PATH.csv] [AT_S] [STATE_DIR] [LIFT_M] [SECONDS] [FOLDER]\n"), 2;
    bench::SceneArguments arguments{argv[1]};
    if (argc > 2) arguments.path_file = argv[2];
    if (argc > 4) arguments.state_dir = argv[4];
    if (argc > 5) arguments.lift_m = std::atof(argv[5]);
    auto scene = bench::open_scene(arguments);
    if (!scene) return fail(scene.error());
    EngineOptions options;
    options.rest_after_ms = rest_after_ms;
    auto opened = Engine::open(std::move(scene->model), scene->costs, options);
    if (!opened) return fail(opened.error());
    Engine& engine = **opened;
    engine.device().bind();
    const Pose pose = sample_path(scene->path.path, argc > 3 ? std::atof(argv[3]) : 0);
    const Stand s = stand(engine, pose, argc > 6 ? std::atof(argv[6]) : 20);

    const auto items = engine.full_detail(pose);
    const auto begun = now_ns(nullptr);
    engine.draw_unbudgeted(pose, items);
    const double full_cost_ms = 1e-6 * static_cast<double>(now_ns(nullptr) - begun);
    const Pixels full = shown(engine.device()), grid = bench::grid_of_64(engine.device(), pose, items);
    const auto db = [](const Pixels& a, const Pixels& b) { return a.empty() ? -1.0 : psnr_db(a, b); };
    fmt::print(
        "{{\"model\": \"{}\", \"frames\": {}, \"full_detail_frame_ms\": {:.1f}, \"shown_after_ms\": {:.0f}, \"smooth_after_ms\": "
        "{:.0f}, \"samples\": {}, \"cut_db\": {:.1f}, \"full_db\": {:.1f}, \"cut_to_grid_db\": {:.1f}, \"full_to_grid_db\": "
        "{:.1f}, \"smooth_db\": {:.1f}, \"changed_before_percent\": {:.3f}, \"late_at_rest\": {}, \"late_before\": {}, "
        "\"frame_ms_max\": {:.1f}}}\n",
        argv[1], s.frames, full_cost_ms, s.full_ms, s.smooth_ms, s.samples, db(s.before, full), db(s.full, full),
        db(s.before, grid), db(s.full, grid), db(s.last, grid), 100 * s.changed_before, s.late, s.late_without_rest,
        s.frame_ms_max);
    if (argc > 7) {
        for (const auto& [name, pixels] :
             {std::pair{"before", &s.before}, {"full", &s.full}, {"smooth", &s.last}, {"grid", &grid}}) {
            if (pixels->empty()) continue;
            if (auto ok = image::write_png(fmt::format("{}/{}.png", argv[7], name), options.device.viewport.width,
                                           options.device.viewport.height, *pixels);
                !ok)
                return fail(ok.error());
        }
    }
    return s.full.empty() ? 1 : 0;
}
