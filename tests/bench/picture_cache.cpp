// Bench: the image cache along a path at one speed, by its picture and by CPU time. Two engines draw each frame in turns: with
// pictures and without. Every tenth picture is compared with full detail. With a folder: writes the worst one, full detail and
// the difference. bench_picture_cache MODEL.walk PATH.csv [FRAMES 300] [SELECTOR flat] [FOLDER] [STATE_DIR] [LIFT_M 0]
// [SPEED_M_S 1.4] [view|surround] [WIDTHxHEIGHT 1280x720] [WARM_UP] [AT 0.5] -> one JSON object. On stderr, in the end: what
// these pictures would cost on meshes. With WARM_UP, so many frames come before, drawn with pictures alone, and all FRAMES
// count. Prices are corrected as in a walk on the real clock. The middle of the FRAMES lies at the share AT of the path's time,
// whatever the speed, unless the path begins later. Then one picture is compared and no mesh is made: only times count.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "render/cache/depth_mesh.hpp"
#include "render/engine.hpp"
#include "render/gl/picture_faces.hpp"
#include "render/image/image.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/frame/controller.hpp"
#include "tests/bench/bench_picture.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/fragments.hpp"

namespace {

using namespace surefoot;
using bench::fail, bench::Pixels, bench::psnr_db, bench::shown;

constexpr std::uint32_t layers = 128;
constexpr double period_s = 1.0 / 30, horizon_s = 0.1, budget_us = 1e9, nominal_us = 33'333;
constexpr int compared_every = 10, blocks = 6;

double process_cpu_us() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

std::int64_t steady_ns(void* /*context*/) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1'000'000'000 * std::int64_t{now.tv_sec} + now.tv_nsec;
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
    std::vector<double> frames_us{};  ///< CPU time of each frame that counts
    bool corrects = false;            ///< prices are corrected by what frames take, as in walks on the real clock
    rt::CostController controller{};

    SubmitReport frame(const Pose& before, const Pose& pose, const Pose& next, std::uint64_t number, double target_rad,
                       bool counts) {
        engine->device().bind();  // each engine has a context of its own
        const double start_us = process_cpu_us();
        engine->prepare(predict_region(before, pose, period_s, horizon_s), number, 1.4, 0, set, hints);
        hints.covered = engine->cover(pose, predict_region(pose, next, period_s, horizon_s));
        engine->select(set, nominal_us, {.factor = controller.factor()}, target_rad);
        SubmitReport report =
            engine->submit(pose, {.elapsed_us = 0, .limit_us = budget_us, .now_ns = corrects ? steady_ns : nullptr});
        if (corrects) controller.update(report.predicted_us, report.finished_us);
        if (!counts) return report;
        frames_us.push_back(process_cpu_us() - start_us);
        cpu_us += frames_us.back();
        predicted_us += report.predicted_us;
        pictures += report.pictures;
        made += report.pictures_made;
        captures_us += report.captures_us;
        triangles += static_cast<double>(report.triangles);
        uncovered += report.uncovered_items;
        return report;
    }
};

/// What the command line chooses beside the scene.
struct Chosen {
    int frames = 300, warm_up = -1;  ///< warm_up below 0: none was given
    std::string selector, folder, keeps;
    double speed_m_s = 1.4, at = 0.5;
    model::Viewport viewport;

    [[nodiscard]] bool only_times() const { return warm_up >= 0; }
    [[nodiscard]] int first_counted() const { return only_times() ? warm_up : frames / 4; }
    [[nodiscard]] int all_frames() const { return only_times() ? warm_up + frames : frames; }
    [[nodiscard]] bool compares(int i) const {
        return only_times() ? i == all_frames() - 1 : i % compared_every == compared_every - 1;
    }
};

Result<Walker> open_walker(const bench::Scene& scene, const Chosen& chosen, bool cache) {
    EngineOptions options;
    options.device.kind = gl::BackendKind::egl;
    options.device.viewport = chosen.viewport;
    options.device.picture_layers = cache ? layers : 0;
    options.pictures_all_round = cache && chosen.keeps == "surround";
    options.selector = chosen.selector;
    auto engine = Engine::open(scene.model, scene.costs, options);
    if (!engine) return engine.error();
    Walker walker;
    walker.engine = std::move(*engine);
    walker.corrects = chosen.only_times();
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

/// Compares pictures with full detail, and keeps the worst.
struct Comparison {
    double worst_db = 1e9, sum_db = 0, other_db = 1e9;
    int compared = 0;

    void add(Engine& engine, const Pose& pose, const Pixels& plain, const std::string& folder) {
        gl::Device& device = engine.device();
        const model::Viewport viewport = engine.options().device.viewport;
        device.draws.plays();
        const Pixels cached = shown(device);
        engine.draw_unbudgeted(pose, engine.full_detail(pose));
        const Pixels full = shown(device);
        const double db = psnr_db(cached, full);
        other_db = std::min(other_db, psnr_db(plain, full));
        sum_db += db;
        ++compared;
        if (!(db < worst_db)) return;
        worst_db = db;
        if (folder.empty()) return;
        Pixels difference(full.size(), 255);
        for (std::size_t p = 0; p < full.size(); ++p)
            if (p % 4 != 3) difference[p] = static_cast<std::uint8_t>(std::min(255, 4 * std::abs(int{cached[p]} - int{full[p]})));
        (void)image::write_png(folder + "/cached.png", viewport.width, viewport.height, cached);
        (void)image::write_png(folder + "/full.png", viewport.width, viewport.height, full);
        (void)image::write_png(folder + "/difference.png", viewport.width, viewport.height, difference);
    }
};

/// CPU time with pictures over that without: of all frames that count, and the least and the greatest of blocks of them.
struct Ratio {
    double all = 0, least = 1e9, greatest = 0;
};

Ratio ratio_of(const std::vector<double>& with_us, const std::vector<double>& without_us) {
    const auto of = [&](std::size_t from, std::size_t to) {
        double a = 0, b = 0;
        for (std::size_t i = from; i < to; ++i) a += with_us[i], b += without_us[i];
        return b > 0 ? a / b : 0.0;
    };
    Ratio ratio{of(0, with_us.size())};
    const std::size_t block = std::max<std::size_t>(1, with_us.size() / blocks);
    for (std::size_t from = 0; from + block <= with_us.size(); from += block) {
        ratio.least = std::min(ratio.least, of(from, from + block));
        ratio.greatest = std::max(ratio.greatest, of(from, from + block));
    }
    return ratio;
}

/// Fragments of what is drawn over the pixels of the picture; below 0 where the driver does not count.
template <class Draw>
bench::Fragments overdraw_of(Engine& engine, const Draw& draw) {
    engine.device().bind();
    const model::Viewport viewport = engine.options().device.viewport;
    const double pixels = 1.0 * viewport.width * viewport.height;
    bench::FragmentCounter counter;
    if (!counter.begin()) return {-1, -1};
    draw();
    const bench::Fragments count = counter.end();
    return {count.made / pixels, count.written / pixels};
}

Result<Chosen> read_arguments(int argc, char** argv) {
    const auto argument = [&](int i, const char* otherwise) { return argc > i ? std::string(argv[i]) : std::string(otherwise); };
    Chosen chosen;
    chosen.frames = std::atoi(argument(3, "300").c_str());
    chosen.selector = argument(4, "flat");
    chosen.folder = argument(5, "");
    chosen.speed_m_s = std::atof(argument(8, "1.4").c_str());
    chosen.keeps = argument(9, "view");
    chosen.warm_up = std::atoi(argument(11, "-1").c_str());
    chosen.at = std::atof(argument(12, "0.5").c_str());
    if (!(chosen.speed_m_s > 0) || (chosen.keeps != "view" && chosen.keeps != "surround"))
        return Error{"bench_picture_cache", "The speed is no number above 0, or neither view nor surround is kept",
                     "Correct them"};
    char end = 0;
    if (std::sscanf(argument(10, "1280x720").c_str(), "%ux%u%c", &chosen.viewport.width, &chosen.viewport.height, &end) != 2)
        return Error{"bench_picture_cache", "The size is not as 1280x720", "Correct it"};
    return chosen;
}

}  // namespace

int main(int argc, char** argv) {
    const auto argument = [&](int i, const char* otherwise) { return argc > i ? std::string(argv[i]) : std::string(otherwise); };
    const auto chosen = read_arguments(argc, argv);
    if (!chosen) return fail(chosen.error()), 2;
    auto scene = bench::open_scene({argument(1, ""), argument(2, ""), std::atof(argument(7, "0").c_str()), argument(6, "")});
    if (!scene) return fail(scene.error());
    auto with = open_walker(*scene, *chosen, true);
    auto without = open_walker(*scene, *chosen, false);
    if (!with || !without) return fail(with ? without.error() : with.error());
    Comparison comparison;
    const Path paced = at_speed(scene->path.path, chosen->speed_m_s);
    const int frames = chosen->all_frames(), first = chosen->first_counted();
    const double counted_s = chosen->at * paced.samples.back().time_s - period_s * (first + 0.5 * chosen->frames);
    const double start_s = chosen->only_times() ? std::max(0.0, counted_s) : 0.0;
    const auto pose_of = [&](int i) { return sample_path(paced, start_s + i * period_s); };
    double moved_m = 0;
    for (int i = 0; i < frames; ++i) {
        const Pose before = pose_of(std::max(0, i - 1)), pose = pose_of(i), next = pose_of(i + 1);
        const bool counts = i >= first, compares = chosen->compares(i);
        const double target_rad = chosen->selector == "curve-accuracy" ? model::pixel_angle(pose, chosen->viewport) : 0.0;
        if (counts) moved_m += glm::length(next.position - pose.position);
        if (i >= first - 3 || !chosen->only_times())  // its first frames are slower, and do not count
            (void)without->frame(before, pose, next, static_cast<std::uint64_t>(i), target_rad, counts);
        const Pixels plain = compares ? shown(without->engine->device()) : Pixels{};
        (void)with->frame(before, pose, next, static_cast<std::uint64_t>(i), target_rad, counts);
        if (compares) comparison.add(*with->engine, pose, plain, chosen->folder);
    }
    if (!chosen->only_times()) print_mesh_figures(*with->engine, pose_of(frames - 1));
    // One frame more of each, with nothing timed.
    const auto one_more = [&](Walker& walker) {
        const Pose before = pose_of(frames - 1), pose = pose_of(frames), next = pose_of(frames + 1);
        const double target_rad = chosen->selector == "curve-accuracy" ? model::pixel_angle(pose, chosen->viewport) : 0.0;
        return overdraw_of(*walker.engine, [&] {
            (void)walker.frame(before, pose, next, static_cast<std::uint64_t>(frames), target_rad, false);
        });
    };
    const bench::Fragments overdraw = one_more(*without), with_pictures = one_more(*with);
    const Ratio ratio = ratio_of(with->frames_us, without->frames_us);
    const double n = std::max<double>(1, static_cast<double>(with->frames_us.size()));
    fmt::print(
        "{{\"bench\": \"picture_cache\", \"frames\": {}, \"selector\": \"{}\", \"speed_m_s\": {}, \"keeps\": \"{}\", \"cpu_ms\": "
        "{:.2f}, \"cpu_ms_without\": {:.2f}, "
        "\"predicted_ms\": {:.2f}, \"predicted_ms_without\": {:.2f}, \"pictures\": {:.1f}, \"made\": {:.2f}, \"captures_us\": "
        "{:.0f}, "
        "\"triangles\": {:.0f}, \"triangles_without\": {:.0f}, \"uncovered\": {:.1f}, \"worst_db\": {:.1f}, \"mean_db\": {:.1f}, "
        "\"worst_db_without\": {:.1f}, ",
        n, chosen->selector, chosen->speed_m_s, chosen->keeps, 1e-3 * with->cpu_us / n, 1e-3 * without->cpu_us / n,
        1e-3 * with->predicted_us / n, 1e-3 * without->predicted_us / n, with->pictures / n, with->made / n,
        with->captures_us / n, with->triangles / n, without->triangles / n, with->uncovered / n, comparison.worst_db,
        comparison.sum_db / std::max(1, comparison.compared), comparison.other_db);
    fmt::print(
        "\"width\": {}, \"height\": {}, \"moved_m_s\": {:.3f}, \"ratio\": {:.4f}, \"ratio_least\": {:.4f}, \"ratio_greatest\": "
        "{:.4f}, \"overdraw\": {:.3f}, \"overdraw_written\": {:.3f}, \"overdraw_with\": {:.3f}}}\n",
        chosen->viewport.width, chosen->viewport.height, moved_m / (n * period_s), ratio.all, ratio.least, ratio.greatest,
        overdraw.made, overdraw.written, with_pictures.made);
    return 0;
}
