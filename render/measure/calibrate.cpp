// Calibration: measures cells in interleaved order, then whole frames, and fits how items add up. Source: Maciel 1994, 3.3.1, for
// the measured table; here sums replace the larger of two costs.
#include "render/measure/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "render/gl/backends.hpp"
#include "render/measure/calibrate_fit.hpp"
#include "render/measure/calibrate_run.hpp"
#include "render/measure/calibrate_scene.hpp"
#include "render/model/item_costs.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::measure {

namespace {

constexpr double slice_target_us = 1000;  // the engine's

double now_s() { return 1e-9 * static_cast<double>(rt::monotonic_ns()); }

const Error stopped{"calibration", "The calibration was stopped; nothing was written", "Run it again", ErrorKind::stopped};

/// A random order of n things.
std::vector<std::size_t> shuffled(std::size_t n, Random& random) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    return order;
}

double min_of(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

class Run {
public:
    Run(gl::Device& device, const CalibrateOptions& options, const Progress& progress)
        : device_(device),
          options_(options),
          progress_(progress),
          random_(options.seed),
          scene_(make_calibration_scene(options.device.viewport, options.quick, options.seed)) {}

    Result<void> load() {
        device_.draws.plays();  // opened on this thread
        return device_.load(scene_.model, effects::assemble_program);
    }
    void timer(Calibration& out);
    void slices(Calibration& out);
    void enlarging(Calibration& out);
    Result<void> cells(Calibration& out);
    Result<void> frames(Calibration& out);

private:
    /// The frame twice: the second finds warm caches, as a walk's frames do.
    FrameTiming timed(const Pose& pose, std::span<const gl::DrawItem> items, std::size_t slice_items, float resolution = 1) {
        device_.draws.plays();
        run_frame(device_, clocks_, pose, items, slice_items, resolution);
        return run_frame(device_, clocks_, pose, items, slice_items, resolution);
    }
    [[nodiscard]] int repeats() const { return options_.quick ? 3 : 5; }
    FrameSample predict(const TownView& view, const model::ItemCosts& costs) const;

    gl::Device& device_;
    const CalibrateOptions& options_;
    const Progress& progress_;
    Random random_;
    CalibrationScene scene_;
    RasteriserClocks clocks_;
    FrameTiming empty_;
};

/// The heaviest cells of the bare class, once by query and once by the wall.
void Run::timer(Calibration& out) {
    std::vector<gl::DrawItem> items;
    for (const CalibrationCell& cell : scene_.cells) {
        if (cell.effects == 0 && cell.pixels > 5000) items.insert(items.end(), cell.items.begin(), cell.items.end());
    }
    device_.draws.plays();
    check_timer(device_, Pose{}, items);
    out.timer = check_timer(device_, Pose{}, items);
    out.costs.timer_query_honest = out.timer.honest;
}

/// The same items as one slice and as many, both front to back, by the frame thread's CPU time; and the empty frame, which
/// every cell's time contains.
void Run::slices(Calibration& out) {
    const CalibrationCell* small = &scene_.cells.front();
    for (const CalibrationCell& cell : scene_.cells) {
        if (cell.effects == 0 && cell.triangles < 100 && cell.pixels < 2000) small = &cell;
    }
    const std::span<const gl::DrawItem> items = small->items;
    constexpr std::size_t parts = 16;
    const std::size_t part = (items.size() + parts - 1) / parts;
    std::vector<double> whole, sliced, empty_submit, empty_raster, empty_wall;
    for (int i = 0; i < 5 * repeats(); ++i) {
        whole.push_back(timed(Pose{}, items, items.size()).submit_us);
        sliced.push_back(timed(Pose{}, items, part).submit_us);
        const FrameTiming empty = timed(Pose{}, {}, 1);
        empty_submit.push_back(empty.submit_us);
        empty_raster.push_back(empty.raster_us);
        empty_wall.push_back(empty.wall_us);
    }
    out.costs.slice_us =
        static_cast<float>(std::clamp((min_of(sliced) - min_of(whole)) / static_cast<double>(parts - 1), 0.0, 500.0));
    empty_ = {min_of(empty_submit), min_of(empty_raster), min_of(empty_wall)};
}

/// Nothing is drawn, so what a frame at 50 % takes longer than one at 100 % is the enlarging. Its smaller clear is in the figure:
/// the fixed time of a frame holds a whole one.
void Run::enlarging(Calibration& out) {
    std::vector<EmptyPair> pairs;
    for (int i = 0; i < 10 * repeats(); ++i) pairs.push_back({timed(Pose{}, {}, 1).wall_us, timed(Pose{}, {}, 1, 0.5F).wall_us});
    const std::optional<float> ns = enlarge_ns_of(pairs, options_.device.viewport);
    out.costs.enlarge_measured = ns.has_value();
    if (ns) out.costs.enlarge_ns_per_pixel = *ns;
}

Result<void> Run::cells(Calibration& out) {
    const std::size_t n = scene_.cells.size();
    std::vector<std::vector<FrameTiming>> timings(n);
    for (int round = 0; round < repeats(); ++round) {
        std::size_t done = 0;
        for (const std::size_t c : shuffled(n, random_)) {
            if (progress_.stopped()) return stopped;
            const auto& items = scene_.cells[c].items;
            timings[c].push_back(timed(Pose{}, items, std::max<std::size_t>(1, (items.size() + 2) / 3)));
            progress_.update("items", (round + static_cast<double>(done++) / static_cast<double>(n)) / repeats());
        }
    }
    for (std::size_t c = 0; c < n; ++c) {
        const CalibrationCell& cell = scene_.cells[c];
        const auto count = static_cast<double>(cell.items.size());
        std::vector<double> submit, raster, wall;
        for (const FrameTiming& t : timings[c]) {
            submit.push_back(std::max(0.0, t.submit_us - empty_.submit_us) / count);
            raster.push_back(std::max(0.0, t.raster_us - empty_.raster_us) / count);
            wall.push_back(std::max(0.0, t.wall_us - empty_.wall_us) / count);
        }
        CalibrationPoint point{cell.effects, cell.triangles, cell.pixels, min_of(submit), min_of(raster), min_of(wall), 0};
        point.spread = (quantile_of(wall, 0.9) - quantile_of(wall, 0.1)) / std::max(1e-3, quantile_of(wall, 0.5));
        out.points.push_back(point);
    }
    for (const model::EffectMask effects : calibration_classes(options_.quick)) {
        std::vector<CalibrationPoint> points;
        for (const CalibrationPoint& p : out.points) {
            if (p.effects == effects) points.push_back(p);
        }
        out.costs.grids.push_back(fill_grid(effects, points));
    }
    return {};
}

FrameSample Run::predict(const TownView& view, const model::ItemCosts& costs) const {
    const model::ViewScale scale = model::make_view_scale(view.pose, options_.device.viewport);
    FrameSample sample;
    for (const gl::DrawItem& item : view.items) {
        const model::ItemCost cost = costs.of(item.rep, scene_.model.nodes[item.node].box, view.pose.position, scale);
        sample.submit_us += static_cast<double>(cost.submit_us);
        sample.raster_us += static_cast<double>(cost.raster_us);
    }
    return sample;
}

/// Random views of the town, drawn in rounds: every other one teaches the weights, the rest judge them.
Result<void> Run::frames(Calibration& out) {
    const int wanted = options_.quick ? 80 : 240, rounds = options_.quick ? 3 : 5;
    const model::ItemCosts item_costs(scene_.model, out.costs, scene_.estimator);
    std::vector<TownView> views;
    std::vector<FrameSample> samples;
    std::vector<std::size_t> slice_items;
    for (int i = 0; i < wanted; ++i) {
        TownView view = random_town_view(scene_, options_.device.viewport, random_);
        if (view.items.empty()) continue;
        FrameSample sample = predict(view, item_costs);
        const double slices = std::max(1.0, std::round((sample.submit_us + sample.raster_us) / slice_target_us));
        slice_items.push_back(static_cast<std::size_t>(std::ceil(static_cast<double>(view.items.size()) / slices)));
        sample.submit_us += slices * static_cast<double>(out.costs.slice_us);
        samples.push_back(sample);
        views.push_back(std::move(view));
    }
    std::vector<std::vector<FrameSample>> drawn(views.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t v = 0; v < views.size(); ++v) {
            if (progress_.stopped()) return stopped;
            samples[v].actual_us = timed(views[v].pose, views[v].items, slice_items[v]).wall_us;
            drawn[v].push_back(samples[v]);
            progress_.update("frames", (round + static_cast<double>(v) / static_cast<double>(views.size())) / rounds);
        }
    }
    const FrameTimes frame_times = robust_frame_times(drawn);
    std::vector<FrameSample> taught, held_out;
    for (std::size_t v = 0; v < views.size(); ++v) (v % 2 == 0 ? taught : held_out).push_back(frame_times.frames[v]);
    out.costs.combine =
        fit_combine(taught, {static_cast<float>(empty_.wall_us), 0.5F, 0.5F, 0.5F});  // half way from sum to larger
    out.costs.headroom = static_cast<float>(std::max(1.0, ratio(held_out, out.costs.combine, 0.9)));
    out.frame_error_p50 = relative_error(held_out, out.costs.combine, 0.5);
    out.frame_error_p90 = relative_error(held_out, out.costs.combine, 0.9);
    out.frame_error_p99 = relative_error(held_out, out.costs.combine, 0.99);
    return {};
}

}  // namespace

Result<Calibration> calibrate(const CalibrateOptions& options, const Progress& progress) {
    if (options.device.kind == gl::BackendKind::null) {
        return Error{"calibration", "The null backend draws nothing", "Use one of: " + gl::drawing_backends(), ErrorKind::misuse};
    }
    const double start_s = now_s();
    progress.update("opening", 0);
    auto device = gl::open_device(options.device);
    if (!device) return device.error();
    (*device)->draws.plays();
    Run run(**device, options, progress);
    if (auto loaded = run.load(); !loaded) return loaded.error();
    if (options.opened) options.opened();
    Calibration out;
    out.costs.machine = machine_identity((*device)->renderer(), options.device.rasterisers);
    out.costs.calibrated = true;
    run.timer(out);
    run.slices(out);
    run.enlarging(out);
    if (auto done = run.cells(out); !done) return done.error();
    if (auto done = run.frames(out); !done) return done.error();
    if ((*device)->lost())
        return Error{"calibration", "The device was lost, so its times mean nothing", "Restart the driver, and try again",
                     ErrorKind::no_device};
    out.seconds = now_s() - start_s;
    progress.update("done", 1);
    return out;
}

}  // namespace surefoot::measure
