// Bench: what samples and texture filter cost, and what they change. Frames of full detail are drawn in slices, as walks draw
// them, under each variant in turns. Counted is the CPU time of the process, as the least of ten rounds. The pictures are
// compared with the first variant's, and with the mean of 64 trilinear samples. The variants are among bilinear, trilinear,
// samples1, samples2 and samples4. bench_levers MODEL.walk VARIANT,... [POSES 10] [PATH.csv] [STATE_DIR] [LIFT_M] [FOLDER] -> a
// JSON object a variant.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/image/image.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/bench_picture.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/tour_controller.hpp"

namespace {

using namespace surefoot;
using bench::fail, bench::Pixels, bench::psnr_db;

double cpu_us() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

std::int64_t now_ns(void* /*context*/) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Variant {
    std::string name;
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    std::vector<std::vector<double>> cpu;  // [pose][round]
    std::vector<double> to_first_db, to_smooth_db;
};

EngineOptions options_of(std::string_view name) {
    EngineOptions o;
    o.in_frame_check = false;
    o.selector = "flat";
    if (name.starts_with("samples")) o.device.samples = static_cast<std::uint32_t>(name.back() - '0');
    for (const rt::TextureFilter filter : {rt::TextureFilter::bilinear, rt::TextureFilter::trilinear})
        if (name == rt::name_of(filter)) o.device.filter = filter;
    return o;
}

Pixels smooth_picture(Engine& engine, const Pose& pose) {
    gl::Device& device = engine.device();
    device.draws.plays();
    device.bind();
    Pixels mean = bench::grid_of_64(device, pose, engine.full_detail(pose));
    device.release();
    return mean;
}

gl::PixelImage shown(Engine& e) {
    e.device().draws.plays();
    auto image = e.device().read_pixels();
    return image ? *image : gl::PixelImage{};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3)
        return fmt::print(stderr, "bench_levers MODEL.walk VARIANT,... [POSES] [PATH.csv] [STATE_DIR] [LIFT_M] [FOLDER]\n"), 2;
    const std::size_t poses = argc > 3 ? static_cast<std::size_t>(std::atoi(argv[3])) : 10;
    bench::SceneArguments arguments{argv[1]};
    if (argc > 4) arguments.path_file = argv[4];
    if (argc > 5) arguments.state_dir = argv[5];
    if (argc > 6) arguments.lift_m = std::atof(argv[6]);
    const std::string folder = argc > 7 ? argv[7] : "";
    std::vector<Variant> variants;
    Path path;
    const std::string names = std::string("trilinear,") + argv[2];  // the first draws the smooth pictures
    for (std::size_t at = 0; at < names.size();) {
        const std::size_t end = std::min(names.find(',', at), names.size());
        Variant v;
        v.name = names.substr(at, end - at);
        at = end + 1;
        auto scene = bench::open_scene(arguments);
        if (!scene) return fail(scene.error());
        path = scene->path.path;
        EngineOptions options = options_of(v.name);
        if (variants.empty()) options.rest_after_ms = 1e9;  // only its targets
        auto engine = Engine::open(std::move(scene->model), scene->costs, options);
        if (!engine) return fail(engine.error());
        v.engine = std::move(*engine);
        v.engine->reserve(v.prepared);
        v.cpu.resize(poses);
        v.engine->device().draws.plays();
        v.engine->device().release();
        variants.push_back(std::move(v));
    }
    SubmitLimits limits;
    limits.limit_us = 1e12;
    limits.now_ns = now_ns;
    constexpr std::size_t rounds = 10;
    const std::unique_ptr<Engine> smoother = std::move(variants.front().engine);
    variants.erase(variants.begin());
    if (variants.empty()) return 2;
    for (std::size_t p = 0; p < poses; ++p) {
        const Pose pose = walk::pose_at(path, path.duration_s() * (static_cast<double>(p) + 0.5) / static_cast<double>(poses));
        const Pixels smooth = smooth_picture(*smoother, pose);
        std::vector<std::uint8_t> first;
        for (std::size_t round = 0; round < rounds; ++round) {
            for (std::size_t i = 0; i < variants.size(); ++i) {
                Variant& v = variants[round % 2 == 0 ? i : variants.size() - 1 - i];
                v.engine->device().bind();
                if (round == 0) {
                    v.engine->prepare({pose, 0, 0}, 0, 0, 0, v.prepared);
                    v.engine->select(v.prepared, 1e9, {}, 0);
                    v.engine->submit(pose, limits);
                }
                v.engine->select(v.prepared, 1e9, {}, 0);
                const double begun_us = cpu_us();
                v.engine->submit(pose, limits);
                v.cpu[p].push_back(cpu_us() - begun_us);
                if (round == 0) {
                    const gl::PixelImage image = shown(*v.engine);
                    if (!folder.empty())
                        (void)image::write_png(fmt::format("{}/{}-{}.png", folder, p, v.name), image.width, image.height,
                                               image.rgba);
                    if (i == 0) first = image.rgba;
                    v.to_first_db.push_back(psnr_db(image.rgba, first));
                    v.to_smooth_db.push_back(psnr_db(image.rgba, smooth));
                }
                v.engine->device().draws.plays();
                v.engine->device().release();
            }
        }
    }
    for (const Variant& v : variants) {
        std::vector<double> ratios;
        double sum_us = 0, first_us = 0;
        for (std::size_t p = 0; p < poses; ++p) {
            const double mine_us = *std::min_element(v.cpu[p].begin(), v.cpu[p].end());
            const double other_us = *std::min_element(variants.front().cpu[p].begin(), variants.front().cpu[p].end());
            ratios.push_back(mine_us / other_us);
            sum_us += mine_us;
            first_us += other_us;
        }
        fmt::print(
            "{{\"variant\": \"{}\", \"cpu_ms\": {:.2f}, \"cpu_to_first\": {:.4f}, \"p10\": {:.4f}, \"p90\": {:.4f}, "
            "\"to_first_db\": {{\"p50\": {:.2f}, \"min\": {:.2f}}}, \"to_smooth_db\": {{\"p50\": {:.2f}, \"min\": {:.2f}}}}}\n",
            v.name, 1e-3 * sum_us / static_cast<double>(poses), sum_us / first_us, quantile_of(ratios, 0.1),
            quantile_of(ratios, 0.9), quantile_of(v.to_first_db, 0.5), quantile_of(v.to_first_db, 0.0),
            quantile_of(v.to_smooth_db, 0.5), quantile_of(v.to_smooth_db, 0.0));
    }
    return 0;
}
