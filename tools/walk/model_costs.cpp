// Fitting the frame's weights to a model (model_costs.hpp).
#include "tools/walk/model_costs.hpp"

#include <algorithm>
#include <vector>

#include "render/measure/calibrate.hpp"
#include "render/measure/calibrate_fit.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/pixels.hpp"
#include "rt/base/random.hpp"
#include "rt/clock/clock.hpp"
#include "tools/walk/model_blur.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::walk {

namespace {

constexpr std::uint32_t warm_up = 10;

/// Sums over what was drawn. Raster times are without the table's own price of a pixel, if it has one.
void add_items(const Engine& engine, const model::ItemCosts& item_costs, const Pose& pose, measure::FrameSample& sample) {
    const model::ViewScale scale = model::make_view_scale(pose, engine.options().device.viewport);
    for (const gl::DrawItem& item : engine.drawn()) {
        float pixels = 0;
        model::ItemCost cost = item_costs.of(item.rep, engine.model().nodes[item.node].box, pose.position, scale, pixels);
        pixels = std::min(pixels, model::max_pixels);
        const float price_us = 1e-3F * engine.costs().ns_per_pixel * pixels;
        cost.raster_us -= price_us;
        sample.raster_us -= static_cast<double>(price_us);
        sample.items.submit_us += static_cast<double>(cost.submit_us);
        sample.items.raster_us += static_cast<double>(cost.raster_us);
        sample.items.larger_us += static_cast<double>(std::max(cost.submit_us, cost.raster_us));
        sample.pixels += static_cast<double>(pixels);
    }
}

/// Of the passes over the whole picture, which an engine adds to the fixed time of any table.
double passes_us(const Engine& engine) {
    const model::CostModel& costs = engine.costs();
    return static_cast<double>(costs.combine_at(1, engine.options().device.viewport).fixed_us - costs.combine.fixed_us);
}

/// Drawn twice: the second finds warm caches, as a walk's frames do.
measure::FrameSample measured(Engine& engine, const model::ItemCosts& item_costs, const Pose& pose) {
    SubmitLimits limits;
    limits.limit_us = 1e12;
    if (engine.options().device.kind != gl::BackendKind::null) limits.now_ns = [](void*) { return rt::monotonic_ns(); };
    engine.submit(pose, limits);
    const SubmitReport report = engine.submit(pose, limits);
    measure::FrameSample sample{static_cast<double>(report.predicted.submit_us), static_cast<double>(report.predicted.raster_us),
                                report.finished_us - passes_us(engine)};
    add_items(engine, item_costs, pose, sample);
    return sample;
}

}  // namespace

Result<ModelFit> fit_to_model(model::Model model, const Path& path, const model::CostModel& table, const ModelFitOptions& options,
                              const Progress& progress) {
    const auto begun = rt::monotonic_ns();
    EngineOptions engine_options;
    engine_options.device = options.device;
    engine_options.in_frame_check = false;  // whole cuts are timed
    engine_options.resolution = 0;          // smaller pictures come too, for their blur; without hints none is chosen
    auto opened = Engine::open(std::move(model), table, engine_options);
    if (!opened) return opened.error();
    Engine& engine = **opened;
    if (options.opened) options.opened();
    engine.device().bind();
    const model::ItemCosts item_costs(engine.model(), engine.costs());
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    std::vector<std::vector<measure::FrameSample>> drawn(options.poses);
    const std::uint32_t a_round = options.poses + warm_up, rounds = std::max(1U, options.rounds);
    for (std::uint32_t round = 0; round < rounds; ++round) {
        Random random(options.seed);  // the same views again
        for (std::uint32_t i = 0; i < a_round; ++i) {
            if (progress.stopped())
                return Error{"calibration", "The calibration was stopped: nothing was written", "Run it again",
                             ErrorKind::stopped};
            const Pose pose = random_pose(path, random);
            const double budget_us = random.range(0.1, 0.85) * options.frame_us;
            engine.prepare({pose, 0, 0}, 0, 0, 0, prepared);
            engine.select(prepared, budget_us, {}, 0);
            const measure::FrameSample sample = measured(engine, item_costs, pose);
            if (i >= warm_up) drawn[i - warm_up].push_back(sample);
            progress.update("frames", (round + static_cast<double>(i) / a_round) / rounds);
        }
    }
    const measure::FrameTimes frame_times = measure::robust_frame_times(drawn);
    std::vector<measure::FrameSample> taught, held_out;
    for (std::size_t i = 0; i < frame_times.frames.size(); ++i) (i % 2 == 0 ? taught : held_out).push_back(frame_times.frames[i]);
    ModelFit fit;
    fit.costs = table;
    const measure::FrameFit found = measure::fit_frames(taught, table.combine);
    const std::vector<measure::FrameSample> judged = measure::priced(held_out, found.ns_per_pixel);
    fit.costs.combine = found.combine;
    fit.costs.ns_per_pixel = found.ns_per_pixel;
    fit.costs.headroom = static_cast<float>(std::max(1.0, measure::ratio(judged, found.combine, 0.9)));
    fit.before = measure::cost_errors(measure::priced(held_out, table.ns_per_pixel), table.combine);
    fit.after = measure::cost_errors(judged, found.combine);
    fit.published = measure::published_costs(taught, held_out);
    fit.frames = options.poses;
    fit.repeated = frame_times.repeated;
    fit.slowdown = frame_times.slowdown;
    fit.machine = measure::machine_identity(engine.device().renderer(), options.device.rasterisers);
    if (options.blur_poses > 0 && options.device.kind != gl::BackendKind::null) {
        const std::vector<Pose> poses = poses_along(path, options.blur_poses);
        const auto blur = measure_blur(engine, poses, progress);
        if (!blur) return blur.error();
        fit.costs.blur_loss = *blur;
        fit.costs.blur_measured = true;
        fit.blur_poses = poses.size();
    }
    fit.seconds = static_cast<double>(rt::monotonic_ns() - begun) * 1e-9;
    return fit;
}

}  // namespace surefoot::walk
