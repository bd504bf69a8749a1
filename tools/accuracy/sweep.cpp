// What accuracy costs in time: budgets swept over poses of a path, a line a selector, against full detail.
#include "tools/accuracy/sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "render/effects/effects.hpp"
#include "render/engine.hpp"
#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/statistics.hpp"
#include "rt/clock/clock.hpp"
#include "tools/accuracy/effect_ways.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/frame_share.hpp"
#include "tools/walk/path_source.hpp"

namespace surefoot::accuracy {

namespace {

/// dB. Every picture equal to full detail is infinite; none that defines a ratio is no number.
double mean_snr(double sum_db, std::uint32_t finite, std::uint32_t infinite) {
    if (finite > 0) return sum_db / finite;
    return infinite > 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
}

/// One pose, its full-detail picture, and its prepared arrays.
struct Station {
    Pose pose;
    std::vector<std::uint8_t> full;
    prepare::PreparedFrame prepared;
};

/// Over the places of a point.
struct PictureSums {
    double snr = 0, ssim = 0, mse = 0, flip = 0;
    std::uint32_t with_snr = 0;
};

struct Sweep {
    Engine& engine;
    std::vector<Station> stations;
    int repeats;
    double time_s;  ///< of the model's animations

    double time_full(const Station& station, const std::vector<gl::DrawItem>& items);
    void prepare();
    /// Draws each place once: the first frames of an engine take longer than later ones.
    void warm_up(double budget_us);
    Result<AccuracyPoint> measure(const std::string& selector, double budget_us, double target_error_rad);
    /// Pictures of the last submission against the station's full detail.
    Result<void> compare(const Station& station, AccuracyPoint& point, PictureSums& sums);
};

double Sweep::time_full(const Station& station, const std::vector<gl::DrawItem>& items) {
    std::vector<double> ms;
    for (int i = 0; i < repeats; ++i) {
        const std::int64_t begun = rt::monotonic_ns();
        engine.refresh_shadow(station.pose);
        engine.draw_unbudgeted(station.pose, items);
        ms.push_back(static_cast<double>(rt::monotonic_ns() - begun) * 1e-6);
    }
    return quantile_of(ms, 0.5);
}

/// On this clock, without an end.
SubmitLimits no_limits() {
    SubmitLimits limits;
    limits.now_ns = [](void*) { return rt::monotonic_ns(); };
    limits.limit_us = 1e12;
    return limits;
}

void Sweep::prepare() {
    PrepareHints hints;
    hints.time_s = time_s;
    for (Station& station : stations) engine.prepare({station.pose, 0.0, 0.0}, 0, 0.0, 0.0, station.prepared, hints);
}

void Sweep::warm_up(double budget_us) {
    engine.device().draws.plays();
    for (const Station& station : stations) {
        engine.select(station.prepared, budget_us, {}, 0.0);
        engine.submit(station.pose, no_limits());
    }
}

Result<void> Sweep::compare(const Station& station, AccuracyPoint& point, PictureSums& sums) {
    engine.device().draws.plays();
    auto image = engine.device().read_pixels();
    if (!image) return image.error();
    const measure::Snr snr = measure::snr(image->rgba, station.full);
    if (!snr.defined) {
        ++point.snr_undefined;
    } else if (std::isinf(snr.db)) {
        ++point.snr_infinite;
    } else {
        sums.snr += snr.db;
        ++sums.with_snr;
    }
    sums.mse += snr.mse;
    sums.ssim += measure::ssim(image->rgba, station.full, image->width, image->height);
    if (snr.mse > 0) sums.flip += measure::flip(image->rgba, station.full, image->width, image->height);
    return {};
}

/// The largest geometric error of a cut, in metres, wherever it is drawn.
double geometric_error_m(const model::Model& model, const select::Cut& cut) {
    double error_m = 0;
    for (const select::CutItem& item : cut.items) error_m = std::max(error_m, double{model.reps[item.rep].error_m});
    return error_m;
}

Result<AccuracyPoint> Sweep::measure(const std::string& selector, double budget_us, double target_error_rad) {
    AccuracyPoint point;
    point.selector = selector;
    point.budget_ms = budget_us * 1e-3;
    std::vector<double> frame_ms, all_ms;
    double accuracy = 0, triangles = 0, cost = 0, worst_rad = 0;
    PictureSums sums;
    engine.device().draws.plays();
    const SubmitLimits limits = no_limits();
    const auto n = static_cast<double>(stations.size());
    for (const Station& station : stations) {
        engine.forget_shadow();  // another place or budget has paid for it
        const select::Cut& cut = engine.select(station.prepared, budget_us, {}, target_error_rad);
        worst_rad = std::max(worst_rad, double{cut.worst_error_rad});
        if (cut.worst_error_rad > model::exact_up_to_rad) {
            accuracy += 1.0 / cut.worst_error_rad;
        } else {
            ++point.exact;  // no finite accuracy: left out of the mean, as in a walk's summary
        }
        triangles += static_cast<double>(cut.triangles);
        cost += cut.predicted_us;
        point.error_m += geometric_error_m(engine.model(), cut) / n;
        point.value += (station.prepared.full_value > 0 ? cut.value / station.prepared.full_value : 1) / n;
        std::vector<double> ms;
        ms.reserve(static_cast<std::size_t>(repeats));
        for (int i = 0; i < repeats; ++i) {
            engine.forget_shadow();  // if it was bought, each of them draws it
            const SubmitReport report = engine.submit(station.pose, limits);
            ms.push_back(report.finished_us * 1e-3);
            if (i == 0) point.estimated_gain += report.one_more_ms / n;
        }
        all_ms.insert(all_ms.end(), ms.begin(), ms.end());
        frame_ms.push_back(quantile_of(ms, 0.5));
        if (auto ok = compare(station, point, sums); !ok) return ok.error();
    }
    const Quantiles q = quantiles(frame_ms);
    point.frame_ms_p50 = q.p50;
    point.frame_ms_p90 = q.p90;
    point.frame_ms_p99 = quantile_of(all_ms, 0.99);
    const auto inexact = static_cast<double>(stations.size() - point.exact);
    point.accuracy_mean = inexact > 0 ? accuracy / inexact : std::numeric_limits<double>::infinity();
    point.accuracy_worst = worst_rad > model::exact_up_to_rad ? 1.0 / worst_rad : std::numeric_limits<double>::infinity();
    point.snr_db = mean_snr(sums.snr, sums.with_snr, point.snr_infinite);
    point.psnr_db = report::psnr_db(sums.mse / n);
    point.ssim = sums.ssim / n;
    point.flip = sums.flip / n;
    point.triangles = triangles / n;
    point.cost_us = cost / n;
    point.frames = static_cast<std::uint32_t>(stations.size());
    return point;
}

Result<std::unique_ptr<Engine>> open_engine(const AccuracyRequest& request, model::Model model, std::uint64_t model_hash,
                                            EngineOptions options, AccuracyRun& run) {
    options.benefit = request.benefit;
    auto opened = open_engine_of_places(request, std::move(model), model_hash, options);
    if (!opened) return opened.error();
    run.machine = std::move(opened->machine);
    run.uncalibrated = std::move(opened->uncalibrated);
    return std::move(opened->engine);
}

}  // namespace

std::vector<std::string> compared_selectors() {
    std::vector<std::string> names;
    for (const select::SelectorEntry& entry : select::selectors())
        if (entry.compared) names.emplace_back(entry.name);
    return names;
}

std::string changed_selector(const std::vector<std::string>& swept) {
    if (std::find(swept.begin(), swept.end(), select::usual_selector) != swept.end()) return std::string(select::usual_selector);
    for (const std::string& name : swept) {
        const auto entry = select::selector_named(name);
        if (entry && (*entry)->goes_by == select::GoesBy::budget && !name.ends_with(published_ending)) return name;
    }
    return {};
}

namespace {

/// How far one selector is.
struct PartProgress {
    const Progress& whole;
    std::function<void(double share)> update;
};

/// All points of a selector, then what one more millisecond buys.
Result<void> sweep_selector(Sweep& sweep, const AccuracyRequest& request, const std::string& selector,
                            const PartProgress& progress, AccuracyRun& run) {
    Engine& engine = sweep.engine;
    if (auto set = engine.set_selector(selector); !set) return set;
    sweep.prepare();  // `flat` needs the leaves, the others do not
    std::vector<double> budgets = request.budgets_ms;
    if (budgets.empty())
        for (const double share : {0.12, 0.18, 0.25, 0.35, 0.5, 0.7, 1.0, 1.4}) budgets.push_back(share * run.full_frame_ms);
    const select::SelectorEntry& entry = **select::selector_named(selector);
    const bool by_threshold = entry.goes_by == select::GoesBy::threshold;
    const double pixel = model::pixel_angle(sweep.stations[0].pose, request.viewport());
    const auto stopped = [&] { return Error{request.model_file, "The sweep was stopped by the user", "", ErrorKind::stopped}; };
    for (std::size_t b = 0; b < budgets.size(); ++b) {
        if (progress.whole.stopped()) return stopped();
        progress.update(static_cast<double>(b) / static_cast<double>(budgets.size() + 2));
        const double threshold = pixel * 32.0 * std::pow(0.5, static_cast<double>(b));  // 32 pixels down to a quarter
        auto point = sweep.measure(selector, by_threshold ? 1e12 : budgets[b] * 1e3, by_threshold ? threshold : 0.0);
        if (!point) return point.error();
        if (by_threshold) point->budget_ms = 0;
        run.points.push_back(*point);
        if (entry.goes_by == select::GoesBy::nothing) break;
    }
    if (entry.goes_by != select::GoesBy::budget || selector.ends_with(published_ending)) return {};
    OneMoreMs more;
    for (AccuracyPoint* point : {&more.now, &more.more}) {
        if (progress.whole.stopped()) return stopped();
        auto measured = sweep.measure(selector, (run.working_ms + (point == &more.more ? 1 : 0)) * 1e3, 0.0);
        if (!measured) return measured.error();
        *point = std::move(*measured);
    }
    run.one_more_ms.push_back(std::move(more));
    return {};
}

/// One option of the sweep's engine, set otherwise.
struct Change {
    std::string_view name;
    void (*set)(EngineOptions&);
};
constexpr std::array<Change, 4> changes = {{
    {"no occlusion culling", [](EngineOptions& o) { o.prepare.occlusion = false; }},
    {"no focus on the middle", [](EngineOptions& o) { o.prepare.focus_strength = 0; }},
    {"gestalt 1", [](EngineOptions& o) { o.prepare.gestalt = 1; }},
    {"resolution 75 %", [](EngineOptions& o) { o.resolution = 0.75F; }},
}};

/// Prepares and draws all places by `selector` at the budget of the rate.
Result<void> mark_change(Sweep& sweep, std::string_view change, const std::string& selector, AccuracyRun& run) {
    if (auto set = sweep.engine.set_selector(selector); !set) return set;
    sweep.prepare();
    sweep.warm_up(run.working_ms * 1e3);
    auto measured = sweep.measure(selector, run.working_ms * 1e3, 0.0);
    if (!measured) return measured.error();
    run.changes.push_back({std::string(change), std::move(*measured)});
    return {};
}

/// One engine with something set otherwise.
struct ChangedEngine {
    std::string name;
    EngineOptions options;
    model::EffectMask hidden = 0;
};

/// The options above, then each effect of the model that has a price of its own, off.
std::vector<ChangedEngine> changed_engines(model::EffectMask effects_of_model) {
    std::vector<ChangedEngine> out;
    for (const Change& change : changes) {
        out.push_back({std::string(change.name), {}});
        change.set(out.back().options);
    }
    for (const effects::EffectModule& module : effects::all_effects()) {
        if (module.priced_on == 0 || (effects_of_model & module.bit) == 0) continue;
        out.push_back({"no " + std::string(module.name), {}, module.bit});
        out.back().options.device.switches = {module.bit};
    }
    return out;
}

/// As swept, then with one option at a time set otherwise. Each has an engine of its own, since options are fixed when one is
/// opened.
Result<void> sweep_changes(Sweep& as_swept, const AccuracyRequest& request, const Progress& progress, AccuracyRun& run) {
    const std::string selector = changed_selector(request.selectors);
    if (selector.empty()) return {};
    if (auto ok = mark_change(as_swept, "as swept", selector, run); !ok) return ok;
    const std::vector<ChangedEngine> engines = changed_engines(effects_of_materials(as_swept.engine.model()));
    for (std::size_t i = 0; i < engines.size(); ++i) {
        if (progress.stopped()) return Error{request.model_file, "The sweep was stopped by the user", "", ErrorKind::stopped};
        progress.update(engines[i].name, static_cast<double>(i) / static_cast<double>(engines.size()));
        model::WalkFileInfo file;
        auto model = model::read_walk(request.model_file, &file);
        if (!model) return model.error();
        auto engine = open_engine(request, std::move(*model), file.hash, engines[i].options, run);
        if (!engine) return engine.error();
        (*engine)->device().bind();
        (*engine)->hide_effects(engines[i].hidden);
        Sweep sweep{**engine, std::vector<Station>(as_swept.stations.size()), as_swept.repeats, as_swept.time_s};
        for (std::size_t s = 0; s < sweep.stations.size(); ++s) {
            sweep.stations[s].pose = as_swept.stations[s].pose;
            sweep.stations[s].full = as_swept.stations[s].full;
            (*engine)->reserve(sweep.stations[s].prepared);
        }
        auto marked = mark_change(sweep, engines[i].name, selector, run);
        (*engine)->device().release();
        if (!marked) return marked;
    }
    return {};
}

}  // namespace

Result<AccuracyRun> run_accuracy(const AccuracyRequest& request, const Progress& progress) {
    model::WalkFileInfo file;
    auto model = model::read_walk(request.model_file, &file);
    if (!model) return model.error();
    auto chosen = walk::choose_path(request.path_file, request.model_file, *model, request.lift_m);
    if (!chosen) return chosen.error();
    AccuracyRun run;
    run.model = request.model_file;
    run.path = chosen->source;
    run.width = request.width;
    run.height = request.height;
    run.shift_x = request.shift_x;
    run.shift_y = request.shift_y;
    run.poses = request.poses;
    auto opened = open_engine(request, std::move(*model), file.hash, {}, run);
    if (!opened) return opened.error();
    Engine& engine = **opened;
    engine.device().bind();
    run.renderer = engine.device().renderer();

    Sweep sweep{engine, std::vector<Station>(request.poses), std::max(1, request.repeats), request.time_s};
    std::vector<double> full_ms;
    const std::vector<Pose> poses = poses_along(chosen->path, request.poses);
    for (std::uint32_t i = 0; i < request.poses; ++i) {
        if (progress.stopped()) return Error{request.model_file, "The sweep was stopped by the user", "", ErrorKind::stopped};
        progress.update("full detail", static_cast<double>(i) / request.poses);
        Station& station = sweep.stations[i];
        station.pose = poses[i];
        full_ms.push_back(sweep.time_full(station, engine.full_detail(station.pose)));
        auto image = engine.device().read_pixels();
        if (!image) return image.error();
        station.full = std::move(image->rgba);
        engine.reserve(station.prepared);
    }
    run.full_frame_ms = quantile_of(full_ms, 0.5);

    run.rate_hz = request.rate_hz;
    run.working_ms = walk::frame_share * 1e3 / request.rate_hz;
    for (std::size_t i = 0; i < request.selectors.size(); ++i) {
        const double done = static_cast<double>(i), all = static_cast<double>(request.selectors.size());
        const auto part = [&](double share) { progress.update(request.selectors[i], (done + share) / all); };
        if (auto ok = sweep_selector(sweep, request, request.selectors[i], {progress, part}, run); !ok) return ok.error();
    }
    mark_fronts(run.points);
    if (auto ok = sweep_changes(sweep, request, progress, run); !ok) return ok.error();
    return run;
}

}  // namespace surefoot::accuracy
