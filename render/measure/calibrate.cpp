// Calibration: measures cells in interleaved order, then whole frames, and fits how items add up. Source: Maciel 1994, 3.3.1, for
// the measured table; here sums replace the larger of two costs.
#include "render/measure/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "render/gl/backends.hpp"
#include "render/measure/calibrate_fit.hpp"
#include "render/measure/calibrate_run.hpp"
#include "render/measure/calibrate_scene.hpp"
#include "render/model/item_costs.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::measure {

namespace {

constexpr double slice_target_us = 1000;  // as the engine's shortest

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
    Result<void> levers(Calibration& out);
    Result<void> prices(Calibration& out);

private:
    /// The frame twice: the second finds warm caches, as a walk's frames do.
    FrameTiming timed(const Pose& pose, std::span<const gl::DrawItem> items, std::size_t slice_items, float resolution = 1) {
        device_.draws.plays();
        run_frame(device_, clocks_, pose, items, slice_items, resolution);
        return run_frame(device_, clocks_, pose, items, slice_items, resolution);
    }
    [[nodiscard]] int repeats() const { return options_.quick ? 3 : 5; }
    FrameSample predict(const TownView& view, const model::ItemCosts& costs) const;
    Result<void> samples(Calibration& out);
    Result<void> filter(Calibration& out);
    void background(Calibration& out);
    void pictures(Calibration& out);
    Result<std::unique_ptr<gl::Device>> open_other(const gl::DeviceOptions& how);
    std::vector<WorkPair> compare(gl::Device& other, bool textured);
    std::vector<EmptyPair> empty_frames(gl::Device& other);

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
    pairs.reserve(10 * static_cast<std::size_t>(repeats()));
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

/// A second device beside the first, with the same scene. Neither is bound to a thread. Its callers keep the constants where it
/// cannot be opened, as on a bare screen.
Result<std::unique_ptr<gl::Device>> Run::open_other(const gl::DeviceOptions& how) {
    device_.draws.plays();
    device_.release();
    auto other = gl::open_device(how);
    if (!other) return other.error();
    (*other)->draws.plays();
    if (auto loaded = (*other)->load(scene_.model, effects::assemble_program); !loaded) return loaded.error();
    (*other)->release();
    return other;
}

/// Cells with many pixels, drawn by both devices in turns; the least of the rounds counts.
std::vector<WorkPair> Run::compare(gl::Device& other, bool textured) {
    constexpr double min_pixels = 500;
    RasteriserClocks clocks;  // of both devices
    const auto draw = [&](gl::Device& device, std::span<const gl::DrawItem> items, double& min_us) {
        device.bind();
        const std::size_t slice = std::max<std::size_t>(1, (items.size() + 2) / 3);
        for (int i = 0; i < 2; ++i) min_us = std::min(min_us, run_frame(device, clocks, Pose{}, items, slice).raster_us);
        device.release();
    };
    const auto pair_of = [&](std::span<const gl::DrawItem> items) {
        WorkPair pair{1e12, 1e12};
        for (int round = 0; round < repeats(); ++round) {
            draw(device_, items, pair.plain_us);
            draw(other, items, pair.dearer_us);
        }
        return pair;
    };
    const WorkPair empty = pair_of({});
    std::vector<WorkPair> pairs;
    for (const CalibrationCell& cell : scene_.cells) {
        if (cell.pixels < min_pixels || (textured && (cell.effects & model::effect_texture) == 0)) continue;
        const WorkPair pair = pair_of(cell.items);
        const WorkPair work{pair.plain_us - empty.plain_us, pair.dearer_us - empty.dearer_us};
        if (work.plain_us > 0 && work.dearer_us > 0) pairs.push_back(work);  // else it drowns in the empty frame
    }
    return pairs;
}

/// Frames without items by both devices, in turns.
std::vector<EmptyPair> Run::empty_frames(gl::Device& other) {
    const auto empty_us = [&](gl::Device& device) {
        device.bind();
        run_frame(device, clocks_, Pose{}, {}, 1);
        const double us = run_frame(device, clocks_, Pose{}, {}, 1).wall_us;
        device.release();
        return us;
    };
    std::vector<EmptyPair> pairs;
    for (int i = 0; i < 10 * repeats(); ++i) {
        const double plain_us = empty_us(device_);
        pairs.push_back({plain_us, empty_us(other)});
    }
    return pairs;
}

/// What is behind everything adds to an empty frame. Where no second device opens, the constant stays.
void Run::background(Calibration& out) {
    if (options_.device.kind == gl::BackendKind::null) return;  // charges what the table says
    const std::vector<model::EffectFinding> before = scene_.model.effects;
    model::EffectFinding sky;
    sky.bit = model::effect_sky;
    sky.called_for = true;
    scene_.model.effects.push_back(sky);
    auto other = open_other(options_.device);
    scene_.model.effects = before;
    if (!other) return;
    const std::optional<float> ns = enlarge_ns_of(empty_frames(**other), options_.device.viewport);
    out.costs.background_measured = ns.has_value();
    if (ns) out.costs.background_ns_per_pixel = *ns;
}

/// A picture of a wall that faces Pose{}, at a depth of 15 m.
gl::CachePicture wall_picture(std::uint32_t texels, const dvec2& low_m, const dvec2& high_m) {
    constexpr double depth_m = 15;
    gl::CachePicture picture;
    picture.place.texels = static_cast<std::uint16_t>(texels);
    picture.plane_m = depth_m;
    picture.low_m = low_m;
    picture.side_m = std::max(high_m.x - low_m.x, high_m.y - low_m.y);
    picture.box = {dvec3(low_m * depth_m, -1.001 * depth_m), dvec3(high_m * depth_m, -depth_m)};
    picture.low_m *= depth_m;
    picture.side_m *= depth_m;
    return picture;
}

/// Pictures that fill a frame several times, about a texel a pixel at usual sizes.
std::vector<gl::CachePicture> wall_of_pictures(const model::Viewport& viewport) {
    constexpr int columns = 5, rows = 3;
    static_assert(columns * rows * PictureTimes::fills == PictureTimes::wide);
    const double up = std::tan(0.5 * Pose{}.fov_y_rad), right = up * viewport.width / viewport.height;
    std::vector<gl::CachePicture> all;
    for (int i = 0; i < PictureTimes::wide; ++i) {
        const dvec2 size(2 * right / columns, 2 * up / rows);
        const dvec2 low = dvec2(-right, -up) + size * dvec2(i % columns, i / columns % rows);
        all.push_back(wall_picture(PictureTimes::large_texels, low, low + size));
        all.back().place.layer = static_cast<std::uint16_t>(i % (columns * rows));
    }
    return all;
}

/// What pictures of the image cache add to an empty frame: by their number and pixels, and new ones by their number and texels.
/// Where no second device has them, the constants stay.
void Run::pictures(Calibration& out) {
    if (options_.device.kind == gl::BackendKind::null) return;  // charges what the table says
    gl::DeviceOptions how = options_.device;
    how.picture_layers = PictureTimes::captures;
    auto opened = open_other(how);
    if (!opened || (*opened)->picture_layers() == 0) return;
    gl::Device& other = **opened;
    other.bind();
    other.draws.plays();
    const gl::CachePicture small = wall_picture(PictureTimes::small_texels, dvec2(-1e-3), dvec2(1e-3));
    const std::vector<gl::CachePicture> many(PictureTimes::count, small), wide = wall_of_pictures(options_.device.viewport);
    const auto beyond_empty = [&](std::span<const gl::CachePicture> drawn, std::uint32_t captured_texels) {
        other.draws.plays();
        const auto frame = [&](bool with) {
            other.draws.plays();
            gl::CachePicture made = wall_picture(captured_texels, dvec2(-0.1), dvec2(0.1));
            for (int i = 0; with && captured_texels > 0 && i < PictureTimes::captures; ++i) {
                made.place.layer = static_cast<std::uint16_t>(i);
                other.capture_picture(made, {});
            }
            return run_frame(other, clocks_, Pose{}, {}, 1, 1, with ? drawn : std::span<const gl::CachePicture>()).wall_us;
        };
        const double empty_us = frame(false);
        return frame(true) - empty_us;
    };
    PictureTimes times;
    for (int i = 0; i < 10 * repeats(); ++i) {
        times.many_us.push_back(beyond_empty(many, 0));
        times.wide_us.push_back(beyond_empty(wide, 0));
        times.small_us.push_back(beyond_empty({}, PictureTimes::small_texels));
        times.large_us.push_back(beyond_empty({}, PictureTimes::large_texels));
    }
    other.release();
    (void)price_pictures(times, options_.device.viewport, out.costs);
}

/// What each sample of a pixel beyond the first adds: to items, and to an empty frame. A driver without keeps the constants.
Result<void> Run::samples(Calibration& out) {
    gl::DeviceOptions how = options_.device;
    how.samples = 4;
    auto other = open_other(how);
    if (!other) return {};
    const auto more = static_cast<float>((*other)->samples() - 1);
    if (!(more > 0)) return {};
    const auto factor = dearer_factor_of(compare(**other, false), 1.0 + max_sample_share * static_cast<double>(more));
    const std::optional<float> pass_ns = enlarge_ns_of(empty_frames(**other), options_.device.viewport);
    if (!factor || !pass_ns) return {};
    out.costs.sample_share = (*factor - 1) / more;
    out.costs.sample_pass_ns_per_pixel = std::min(*pass_ns / more, static_cast<float>(max_sample_pass_ns));
    out.costs.samples_measured = true;
    return {};
}

/// What the dearer texture filter adds to textured items.
Result<void> Run::filter(Calibration& out) {
    gl::DeviceOptions how = options_.device;
    const bool automatic = device_.filter() == rt::TextureFilter::trilinear;
    how.filter = automatic ? rt::TextureFilter::bilinear : rt::TextureFilter::trilinear;
    auto other = open_other(how);
    if (!other) return {};
    std::vector<WorkPair> pairs = compare(**other, true);
    if (automatic)
        for (WorkPair& pair : pairs) std::swap(pair.plain_us, pair.dearer_us);
    const auto factor = dearer_factor_of(pairs, max_trilinear_factor);
    out.costs.trilinear_measured = factor.has_value();
    if (factor) out.costs.trilinear_factor = *factor;
    return {};
}

Result<void> Run::levers(Calibration& out) {
    progress_.update("samples", 0);
    if (auto done = samples(out); !done) return done;
    if (progress_.stopped()) return stopped;
    progress_.update("filter", 0.5);
    if (auto done = filter(out); !done) return done;
    if (progress_.stopped()) return stopped;
    progress_.update("background", 0.9);
    background(out);
    if (progress_.stopped()) return stopped;
    progress_.update("pictures", 0.95);
    pictures(out);
    device_.bind();
    return {};
}

/// With and without each effect in turns; which one comes first changes as well. The median of the pairs' differences counts, and
/// the median of five rounds: some seconds show half of what an effect takes, and others twice as much.
Result<void> Run::prices(Calibration& out) {
    const int pairs = options_.quick ? 5 : 13;
    constexpr std::size_t rounds = 5;
    const std::size_t cells = scene_.prices.size();
    std::vector<std::array<double, rounds>> submits(cells), rasters(cells);
    for (std::size_t c = 0; c < rounds * cells; ++c) {
        const PriceCell& cell = scene_.prices[c % cells];
        if (progress_.stopped()) return stopped;
        progress_.update("effects", static_cast<double>(c) / static_cast<double>(rounds * cells));
        constexpr std::size_t slice = 1;  // far to near: what hides another's pixels would hide its price
        const auto count = static_cast<double>(cell.with.size());
        std::vector<double> submit, raster;
        for (int i = 0; i < pairs; ++i) {
            std::array<FrameTiming, 2> of{};
            for (const bool second : {false, true}) {
                const bool with = second == (i % 2 == 0);
                of[with ? 1 : 0] = timed(Pose{}, with ? cell.with : cell.without, slice);
            }
            submit.push_back((of[1].submit_us - of[0].submit_us) / count);
            raster.push_back((of[1].raster_us - of[0].raster_us) / count);
        }
        submits[c % cells][c / cells] = median_of(std::move(submit));
        rasters[c % cells][c / cells] = median_of(std::move(raster));
    }
    const auto typical = [](const std::array<double, rounds>& of) { return std::max(0.0, median_of({of.begin(), of.end()})); };
    std::vector<PricePoint> points;
    for (std::size_t c = 0; c < cells; ++c) {
        const PriceCell& cell = scene_.prices[c];
        points.push_back({cell.effect, cell.triangles, cell.pixels, typical(submits[c]), typical(rasters[c])});
    }
    out.costs.prices = fit_prices(points);
    out.costs.prices_measured = !out.costs.prices.empty();
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
    out.costs.filter = (*device)->filter();
    out.costs.calibrated = true;
    run.timer(out);
    run.slices(out);
    run.enlarging(out);
    if (auto done = run.cells(out); !done) return done.error();
    if (auto done = run.frames(out); !done) return done.error();
    if (auto done = run.prices(out); !done) return done.error();
    if (auto done = run.levers(out); !done) return done.error();
    if ((*device)->lost())
        return Error{"calibration", "The device was lost, so its times mean nothing", "Restart the driver, and try again",
                     ErrorKind::no_device};
    out.seconds = now_s() - start_s;
    progress.update("done", 1);
    return out;
}

}  // namespace surefoot::measure
