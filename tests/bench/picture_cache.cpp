// Bench: the image cache along a path at one speed, by its picture and by CPU time. Two engines draw each frame in turns: with
// pictures and without. Every tenth picture is compared with full detail. With a folder: writes the worst one, full detail and
// the difference. bench_picture_cache MODEL.walk PATH.csv [FRAMES 300] [SELECTOR flat] [FOLDER] [STATE_DIR] [LIFT_M 0]
// [SPEED_M_S 1.4] [view|surround] -> one JSON object. On stderr, in the end: what these pictures would cost on meshes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "render/cache/depth_mesh.hpp"
#include "render/engine.hpp"
#include "render/gl/picture_faces.hpp"
#include "render/image/image.hpp"
#include "render/measure/image_metrics.hpp"
#include "tests/bench/bench_picture.hpp"
#include "tests/bench/bench_scene.hpp"

namespace {

using namespace surefoot;
using bench::fail, bench::Pixels, bench::psnr_db, bench::shown;

constexpr std::uint32_t layers = 128;
constexpr double period_s = 1.0 / 30, horizon_s = 0.1, budget_us = 1e9, nominal_us = 33'333;
constexpr int compared_every = 10;

double process_cpu_us() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// The same way at one speed; where it turns faster than an eye does, it takes its time.
Path at_speed(const Path& path, double speed_m_s) {
    constexpr double max_turn_rad_s = 1;
    Path paced;
    double time_s = 0;
    for (const PathSample& sample : path.samples) {
        if (!paced.samples.empty()) {
            const Pose &a = paced.samples.back().pose, &b = sample.pose;
            const double turn = 2 * std::acos(std::min(1.0, std::abs(glm::dot(a.orientation, b.orientation))));
            const double step_s = std::max(glm::length(b.position - a.position) / speed_m_s, turn / max_turn_rad_s);
            if (!(step_s > 1e-6)) continue;
            time_s += step_s;
        }
        paced.samples.push_back({time_s, sample.pose});
    }
    return paced;
}

/// An engine, and what its frames took.
struct Walker {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame set;
    PrepareHints hints;
    double cpu_us = 0, predicted_us = 0, pictures = 0, made = 0, captures_us = 0, triangles = 0, uncovered = 0;

    SubmitReport frame(const Pose& before, const Pose& pose, const Pose& next, std::uint64_t number, double target_rad,
                       bool counts) {
        engine->device().bind();  // each engine has a context of its own
        const double start_us = process_cpu_us();
        engine->prepare(predict_region(before, pose, period_s, horizon_s), number, 1.4, 0, set, hints);
        hints.covered = engine->cover(pose, predict_region(pose, next, period_s, horizon_s));
        engine->select(set, nominal_us, {}, target_rad);
        SubmitReport report = engine->submit(pose, {.elapsed_us = 0, .limit_us = budget_us});
        if (!counts) return report;
        cpu_us += process_cpu_us() - start_us;
        predicted_us += report.predicted_us;
        pictures += report.pictures;
        made += report.pictures_made;
        captures_us += report.captures_us;
        triangles += static_cast<double>(report.triangles);
        uncovered += report.uncovered_items;
        return report;
    }
};

Result<Walker> open_walker(const bench::Scene& scene, const std::string& selector, bool cache, bool all_round) {
    EngineOptions options;
    options.device.kind = gl::BackendKind::egl;
    options.device.picture_layers = cache ? layers : 0;
    options.pictures_all_round = all_round;
    options.selector = selector;
    auto engine = Engine::open(scene.model, scene.costs, options);
    if (!engine) return engine.error();
    Walker walker;
    walker.engine = std::move(*engine);
    walker.engine->reserve(walker.set);
    return walker;
}

/// What the pictures of the last frame would cost on meshes of their depths.
struct MeshFigures {
    int pictures = 0, meshable = 0, cheaper = 0;
    double quads_us = 0, meshes_us = 0, cheaper_us = 0, triangles = 0, covered = 0, making_us = 0;
};

MeshFigures mesh_figures(Engine& engine, const Pose& pose, double share) {
    gl::Device& device = engine.device();
    const std::vector<gl::CachePicture> pictures(engine.pictures().begin(), engine.pictures().end());
    const auto full = engine.full_detail(pose);
    const std::vector<gl::DrawItem> items(full.begin(), full.end());
    const cache::KindPrices prices;
    constexpr std::uint32_t max_triangles = 21'845;
    cache::DepthMesher mesher(gl::picture_layer_px, max_triangles);
    std::vector<float> depths(std::size_t{gl::picture_layer_px} * gl::picture_layer_px);
    const double pixel_rad = model::pixel_angle(pose, engine.options().device.viewport);
    MeshFigures figures;
    for (const gl::CachePicture& picture : pictures) {
        auto of_box = cache::picture_of(picture.box, picture.eye);
        device.draws.plays();
        if (!of_box || !device.capture_depths(picture, items, depths)) continue;
        device.begin_frame(pose);
        device.finish_frame();
        for (float& depth : depths) depth /= static_cast<float>(gl::nearest_depth_m(picture));
        const double texel_rad = picture.side_m / (picture.plane_m * picture.place.texels);
        const double quad_us = prices.quad(cache::faces_sr(picture.box, pose.position) / (pixel_rad * pixel_rad));
        const double start_us = process_cpu_us();
        const auto made =
            mesher.make(depths, picture.place.texels, {static_cast<float>(cache::mesh_tolerance(*of_box, share)), max_triangles});
        figures.making_us += process_cpu_us() - start_us;
        const bool dear = made == cache::DepthMeshResult::too_dear;
        const double covered = mesher.covered(), texels = 1.0 * picture.place.texels * picture.place.texels;
        const double triangles = dear ? max_triangles : static_cast<double>(mesher.indices().size()) / 3;
        const double mesh_us = prices.mesh(covered * texel_rad * texel_rad / (pixel_rad * pixel_rad), triangles);
        ++figures.pictures;
        figures.meshable += dear ? 0 : 1;
        figures.cheaper += mesh_us < quad_us ? 1 : 0;
        figures.quads_us += quad_us;
        figures.meshes_us += mesh_us;
        figures.cheaper_us += std::min(mesh_us, quad_us);
        figures.triangles += triangles;
        figures.covered += covered / texels;
    }
    return figures;
}

void print_mesh_figures(Engine& engine, const Pose& pose) {
    for (const double share : {0.25, 0.5, 1.0}) {
        const MeshFigures f = mesh_figures(engine, pose, share);
        const double n = std::max(1, f.pictures);
        fmt::print(stderr,
                   "{{\"bench\": \"picture_meshes\", \"share\": {}, \"pictures\": {}, \"meshable\": {}, \"cheaper\": {}, "
                   "\"quads_us\": {:.0f}, \"meshes_us\": {:.0f}, \"cheaper_us\": {:.0f}, \"triangles\": {:.0f}, "
                   "\"covered\": {:.2f}, \"making_us\": {:.0f}}}\n",
                   share, f.pictures, f.meshable, f.cheaper, f.quads_us, f.meshes_us, f.cheaper_us, f.triangles / n,
                   f.covered / n, f.making_us / n);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const auto argument = [&](int i, const char* otherwise) { return argc > i ? std::string(argv[i]) : std::string(otherwise); };
    auto scene = bench::open_scene({argument(1, ""), argument(2, ""), std::atof(argument(7, "0").c_str()), argument(6, "")});
    if (!scene) return fail(scene.error());
    const int frames = std::atoi(argument(3, "300").c_str());
    const std::string selector = argument(4, "flat"), folder = argument(5, "");
    const double speed_m_s = std::atof(argument(8, "1.4").c_str());
    const std::string keeps = argument(9, "view");
    if (!(speed_m_s > 0) || (keeps != "view" && keeps != "surround"))
        return fmt::print(stderr, "bench_picture_cache: the speed is no number above 0, or neither view nor surround is kept\n"),
               2;
    auto with = open_walker(*scene, selector, true, keeps == "surround");
    auto without = open_walker(*scene, selector, false, false);
    if (!with || !without) return fail(with ? without.error() : with.error());
    gl::Device& device = with->engine->device();
    const model::Viewport viewport = with->engine->options().device.viewport;
    double worst_db = 1e9, sum_db = 0, other_db = 1e9;
    int compared = 0, counted = 0;
    const Path paced = at_speed(scene->path.path, speed_m_s);
    const auto pose_of = [&](int i) { return sample_path(paced, i * period_s); };
    for (int i = 0; i < frames; ++i) {
        const Pose before = pose_of(std::max(0, i - 1)), pose = pose_of(i), next = pose_of(i + 1);
        const bool counts = i >= frames / 4;
        const double target_rad = selector == "curve-accuracy" ? model::pixel_angle(pose, viewport) : 0.0;
        counted += counts ? 1 : 0;
        (void)without->frame(before, pose, next, static_cast<std::uint64_t>(i), target_rad, counts);
        const bool compares = i % compared_every == compared_every - 1;
        const Pixels plain = compares ? shown(without->engine->device()) : Pixels{};
        (void)with->frame(before, pose, next, static_cast<std::uint64_t>(i), target_rad, counts);
        if (!compares) continue;
        device.draws.plays();
        const Pixels cached = shown(device);
        with->engine->draw_unbudgeted(pose, with->engine->full_detail(pose));
        const Pixels full = shown(device);
        const double db = psnr_db(cached, full);
        other_db = std::min(other_db, psnr_db(plain, full));
        sum_db += db;
        ++compared;
        if (!(db < worst_db)) continue;
        worst_db = db;
        if (folder.empty()) continue;
        Pixels difference(full.size(), 255);
        for (std::size_t p = 0; p < full.size(); ++p)
            if (p % 4 != 3) difference[p] = static_cast<std::uint8_t>(std::min(255, 4 * std::abs(int{cached[p]} - int{full[p]})));
        (void)image::write_png(folder + "/cached.png", viewport.width, viewport.height, cached);
        (void)image::write_png(folder + "/full.png", viewport.width, viewport.height, full);
        (void)image::write_png(folder + "/difference.png", viewport.width, viewport.height, difference);
    }
    print_mesh_figures(*with->engine, pose_of(frames - 1));
    const double n = std::max(1, counted);
    fmt::print(
        "{{\"bench\": \"picture_cache\", \"frames\": {}, \"selector\": \"{}\", \"speed_m_s\": {}, \"keeps\": \"{}\", \"cpu_ms\": "
        "{:.2f}, \"cpu_ms_without\": {:.2f}, "
        "\"predicted_ms\": {:.2f}, \"predicted_ms_without\": {:.2f}, \"pictures\": {:.1f}, \"made\": {:.2f}, \"captures_us\": "
        "{:.0f}, "
        "\"triangles\": {:.0f}, \"triangles_without\": {:.0f}, \"uncovered\": {:.1f}, \"worst_db\": {:.1f}, \"mean_db\": {:.1f}, "
        "\"worst_db_without\": {:.1f}}}\n",
        counted, selector, speed_m_s, keeps, 1e-3 * with->cpu_us / n, 1e-3 * without->cpu_us / n, 1e-3 * with->predicted_us / n,
        1e-3 * without->predicted_us / n, with->pictures / n, with->made / n, with->captures_us / n, with->triangles / n,
        without->triangles / n, with->uncovered / n, worst_db, sum_db / std::max(1, compared), other_db);
    return 0;
}
