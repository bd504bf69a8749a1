// Bench: sudden turns. The drive of a path looks on straight; every three seconds the view turns by 170 degrees at 113 degrees
// a second. Each frame is drawn again after the walk, and in full detail at its pose. A turn's frame drops by the median PSNR of
// the 30 frames beside it, 15 before and 15 after, less its own. PSNR counts up to 40 dB. Beside it: what the same time shows at
// the pose without a turn.
//
// bench_turns MODEL.walk [PATH.csv] [LIFT_M] [STATE_DIR] [virtual|real] [TURNS 5] [SELECTOR] -> one JSON object.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/image/image.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/file.hpp"
#include "rt/base/path.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/walk.hpp"

namespace {

using namespace surefoot;
using bench::fail;

constexpr double turn_rps = 113 * std::numbers::pi / 180, turn_rad = 170 * std::numbers::pi / 180;
constexpr double turn_s = turn_rad / turn_rps, straight_s = 3 - turn_s, period_s = straight_s + turn_s;
constexpr std::size_t beside = 15;  // frames, on either side
constexpr double tolerated_db = 6;
/// From here on nobody tells a picture from full detail. A frame of 60 dB among exact ones is no flash.
constexpr double exact_db = 40;

/// How far the view has turned off the path's at a time. A turn ends each period; every other goes back.
double turned_rad(double time_s) {
    const double periods = std::floor(time_s / period_s);
    const double part = std::clamp((time_s - periods * period_s - straight_s) / turn_s, 0.0, 1.0);
    return turn_rad * (std::fmod(periods, 2) == 0 ? part : 1 - part);
}
bool turns(double time_s) { return time_s >= straight_s && std::fmod(time_s, period_s) >= straight_s; }

/// The drive. It starts a quarter of the path in, at the path's speed, and looks where the path does on average.
std::shared_ptr<const Path> drive_along(const Path& path, std::size_t count) {
    auto drive = std::make_shared<Path>();
    const double seconds = (static_cast<double>(count) + 0.5) * period_s;
    constexpr double step_s = 1.0 / 120;
    for (int i = 0; i * step_s <= seconds; ++i) {
        Pose pose = sample_path(path, 0.25 * path.duration_s() + i * step_s);
        pose.orientation = glm::angleAxis(turned_rad(i * step_s), dvec3(0, 1, 0)) * pose.orientation;
        drive->samples.push_back({i * step_s, pose});
    }
    return drive;
}

/// With the costs that the walk has, so that it can select again.
Result<std::unique_ptr<Engine>> open_engine(const walk::WalkRequest& request, bench::Scene& scene) {
    EngineOptions options;
    options.device.viewport = {request.width, request.height};
    options.selector = request.selector;
    options.in_frame_check = false;
    auto engine = Engine::open(std::move(scene.model), scene.costs, options);
    if (!engine) return engine.error();
    (*engine)->device().bind();
    return engine;
}

Pose pose_of(const rt::FrameRecord& frame, const Path& drive) {
    Pose pose = drive.samples.front().pose;  // for its field of view
    pose.position = {frame.eye[0], frame.eye[1], frame.eye[2]};
    pose.orientation = dquat(frame.orientation[3], frame.orientation[0], frame.orientation[1], frame.orientation[2]);
    return pose;
}

Result<gl::PixelImage> full_detail(Engine& engine, const Pose& pose) {
    engine.device().draws.plays();
    engine.draw_unbudgeted(pose, engine.full_detail(pose));
    return engine.device().read_pixels();
}

double psnr_of(std::span<const std::uint8_t> picture, std::span<const std::uint8_t> full) {
    return report::psnr_db(measure::snr(picture, full).mse);
}

/// Of every picture of the walk, against full detail.
Result<std::vector<double>> psnr_of_frames(Engine& engine, const Path& drive, const std::vector<rt::FrameRecord>& records,
                                           const std::string& folder) {
    std::vector<double> psnr_db;
    for (const rt::FrameRecord& frame : records) {
        const std::string file = fmt::format("{}/{:05}.png", folder, frame.frame);
        const auto text = read_text(file);
        if (!text) return text.error();
        const auto picture = image::decode_image(std::as_bytes(std::span(*text)), file);
        if (!picture) return picture.error();
        const auto full = full_detail(engine, pose_of(frame, drive));
        if (!full) return full.error();
        psnr_db.push_back(psnr_of(picture->rgba, full->rgba));
    }
    return psnr_db;
}

/// What the frame's time buys at its pose where nothing moves: what it would show without the turn.
Result<double> still_psnr(Engine& engine, const Path& drive, const rt::FrameRecord& frame) {
    const Pose pose = pose_of(frame, drive);
    const auto full = full_detail(engine, pose);
    if (!full) return full.error();
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    engine.prepare({pose, 0, 0}, 0, 0, 0, prepared);
    Correction correction;
    correction.factor = static_cast<double>(frame.correction);
    engine.select(prepared, static_cast<double>(frame.budget_us), correction, 0);
    SubmitLimits limits;
    limits.limit_us = 1e12;
    engine.submit(pose, limits);
    const auto picture = engine.device().read_pixels();
    if (!picture) return picture.error();
    return psnr_of(picture->rgba, full->rgba);
}

/// A frame of a turn, against those beside it.
struct Drop {
    std::size_t record = 0;
    double time_s = 0, psnr_db = 0, neighbours_db = 0;
    [[nodiscard]] double db() const { return neighbours_db - psnr_db; }
    [[nodiscard]] double visible_db() const { return std::min(neighbours_db, exact_db) - std::min(psnr_db, exact_db); }
};

std::vector<Drop> drops_of(const std::vector<rt::FrameRecord>& records, double frame_s, const std::vector<double>& psnr_db) {
    std::vector<Drop> drops;
    for (std::size_t i = beside; i + beside < records.size(); ++i) {
        const double time_s = static_cast<double>(records[i].slot) * frame_s;
        if (!turns(time_s)) continue;
        std::vector<double> neighbours;
        for (std::size_t k = i - beside; k <= i + beside; ++k)
            if (k != i) neighbours.push_back(psnr_db[k]);
        drops.push_back({i, time_s, psnr_db[i], median_of(neighbours)});
    }
    return drops;
}

/// Prints the JSON object; returns the exit status.
int print_figures(const walk::WalkRequest& request, const walk::WalkOutcome& outcome, Engine& engine, std::size_t count,
                  const std::vector<double>& psnr_db) {
    const std::vector<Drop> drops = drops_of(outcome.records, 1 / request.rate_hz, psnr_db);
    if (drops.empty()) return fmt::print(stderr, "bench_turns: no frame of a turn was drawn\n"), 1;
    std::vector<double> db;
    std::vector<std::string> over;
    std::size_t still_over = 0;  // frames that the turn did not make worse
    for (const Drop& drop : drops) {
        db.push_back(drop.visible_db());
        if (!(drop.visible_db() > tolerated_db)) continue;
        const rt::FrameRecord& frame = outcome.records[drop.record];
        const auto still = still_psnr(engine, *request.given_path, frame);
        if (!still) return fail(still.error());
        if (std::min(drop.neighbours_db, exact_db) - *still > tolerated_db) ++still_over;
        over.push_back(
            fmt::format("{{\"frame\": {}, \"time_s\": {:.2f}, \"psnr_db\": {:.2f}, \"neighbours_db\": {:.2f}, "
                        "\"still_db\": {:.2f}}}",
                        frame.frame, drop.time_s, drop.psnr_db, drop.neighbours_db, *still));
    }
    const auto raw = std::count_if(drops.begin(), drops.end(), [](const Drop& drop) { return drop.db() > tolerated_db; });
    const report::WalkSummary& s = outcome.summary;
    fmt::print(
        "{{\"model\": \"{}\", \"selector\": \"{}\", \"clock\": \"{}\", \"turns\": {}, \"frames\": {}, \"misses\": {}, "
        "\"coarse_frames\": {}, \"floor_frames\": {}, \"turn_frames\": {}, "
        "\"psnr_db\": {{\"p50\": {:.2f}, \"min\": {:.2f}, \"worst_frame\": {}}}, "
        "\"drop_db\": {{\"p50\": {:.2f}, \"p99\": {:.2f}, \"max\": {:.2f}}}, \"over_6_db\": {}, \"over_6_db_still\": {}, "
        "\"over_6_db_of_any_psnr\": {}, "
        "\"frames_over\": [{}]}}\n",
        request.model_file, s.selector, s.clock, count, s.frames, s.misses, s.coarse_frames, s.floor_frames, drops.size(),
        quantile_of(psnr_db, 0.5), quantile_of(psnr_db, 0),
        outcome.records[static_cast<std::size_t>(std::min_element(psnr_db.begin(), psnr_db.end()) - psnr_db.begin())].frame,
        quantile_of(db, 0.5), quantile_of(db, 0.99), *std::max_element(db.begin(), db.end()), over.size(), still_over, raw,
        fmt::join(over, ", "));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2)
        return fmt::print(stderr, "bench_turns MODEL.walk [PATH.csv] [LIFT_M] [STATE_DIR] [virtual|real] [TURNS] [SELECTOR]\n"),
               2;
    walk::WalkRequest request;
    request.model_file = argv[1];
    request.state_dir = argc > 4 ? argv[4] : "";
    request.clock = argc > 5 && std::string_view(argv[5]) == "real" ? rt::ClockKind::real : rt::ClockKind::virtual_time;
    const auto count = static_cast<std::size_t>(argc > 6 ? std::max(1, std::atoi(argv[6])) : 5);
    if (argc > 7) request.selector = argv[7];
    bench::SceneArguments arguments{request.model_file};
    arguments.fitted = true;
    if (argc > 2) arguments.path_file = argv[2];
    if (argc > 3) arguments.lift_m = std::atof(argv[3]);
    arguments.state_dir = request.state_dir;
    arguments.width = request.width;
    arguments.height = request.height;
    arguments.backend = request.backend;
    auto scene = bench::open_scene(arguments);
    if (!scene) return fail(scene.error());
    request.given_path = drive_along(scene->path.path, count);
    const double frame_s = 1 / request.rate_hz;
    request.frames = static_cast<std::uint64_t>(request.given_path->duration_s() / frame_s);
    std::string folder = (std::filesystem::temp_directory_path() / "bench-turns-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) return fmt::print(stderr, "bench_turns: no temporary folder: {}\n", folder), 1;
    request.snap_dir = folder;
    request.snap_every = 1;
    auto outcome = walk::run_walk(request, {});
    Result<std::unique_ptr<Engine>> engine = std::unique_ptr<Engine>();
    Result<std::vector<double>> psnr_db = std::vector<double>{};
    if (outcome && outcome->failures.empty()) engine = open_engine(request, *scene);
    if (engine && *engine) psnr_db = psnr_of_frames(**engine, *request.given_path, outcome->records, folder);
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    if (!outcome) return fail(outcome.error());
    if (!outcome->failures.empty()) return fail(outcome->failures.front());
    if (!engine) return fail(engine.error());
    if (!psnr_db) return fail(psnr_db.error());
    return print_figures(request, *outcome, **engine, count, *psnr_db);
}
