// surefoot calibrate: measures this machine's cost table, its plot, and whether a timer query is honest.
#include <array>
#include <filesystem>
#include <future>
#include <optional>

#include <fmt/format.h>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "tools/accuracy/keep_costs.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/report/report.hpp"
#include "tools/report/terminal.hpp"
#include "tools/walk/model_costs.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/settings_request.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::cli {

namespace {
struct CalibrateArguments {
    std::string model, path, state, backend{gl::usual_backend}, plot, keep{"better"};
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    bool quick = false, json = false;
};

constexpr std::array<std::string_view, 3> kept_costs{"better", "fit", "table"};

nlohmann::ordered_json to_json(const model::CostModel& costs) {
    const model::FrameCombine& k = costs.combine;
    return {{"fixed_us", k.fixed_us},
            {"submit_weight", k.submit_weight},
            {"raster_weight", k.raster_weight},
            {"max_weight", k.max_weight},
            {"upper_factor", costs.headroom},
            {"slice_us", costs.slice_us},
            {"ns_per_pixel", costs.ns_per_pixel}};
}

void print_frame(const model::FrameCombine& k) {
    fmt::print("  frame = {:.0f} us + {:.2f} submit + {:.2f} raster + {:.2f} max(submit, raster)\n", k.fixed_us, k.submit_weight,
               k.raster_weight, k.max_weight);
}

/// By resolution, the whole one left out.
nlohmann::ordered_json blur_json(const model::CostModel& costs, std::size_t poses) {
    auto steps = nlohmann::ordered_json::array();
    for (std::size_t step = 1; step < costs.blur_loss.size(); ++step)
        steps.push_back({{"resolution", model::resolution_steps[step]}, {"loss", costs.blur_loss[step]}});
    return {{"measured", costs.blur_measured}, {"poses", poses}, {"steps", steps}};
}

void print_blur(const model::CostModel& costs, std::size_t poses) {
    std::string resolutions, losses;
    for (std::size_t step = 1; step < costs.blur_loss.size(); ++step) {
        const char* const between = step > 1 ? ", " : "";
        resolutions += fmt::format("{}{:g}", between, 100 * model::resolution_steps[step]);
        losses += fmt::format("{}{:.2f}", between, 100 * costs.blur_loss[step]);
    }
    fmt::print("  a resolution of {} % loses {} % of the value{}\n", resolutions, losses,
               costs.blur_measured ? fmt::format(", at {} poses of the path", poses) : ": built-in figures");
}

nlohmann::ordered_json to_json(const measure::Calibration& c, const std::string& file, const std::string& plot) {
    return {{"table", file},
            {"plot", plot},
            {"machine", c.costs.machine},
            {"seconds", c.seconds},
            {"points", c.points.size()},
            {"frame", to_json(c.costs)},
            {"enlarge", {{"measured", c.costs.enlarge_measured}, {"ns_per_pixel", c.costs.enlarge_ns_per_pixel}}},
            {"samples",
             {{"measured", c.costs.samples_measured},
              {"share_of_raster_time", c.costs.sample_share},
              {"pass_ns_per_pixel", c.costs.sample_pass_ns_per_pixel}}},
            {"background", {{"measured", c.costs.background_measured}, {"ns_per_pixel", c.costs.background_ns_per_pixel}}},
            {"pictures",
             {{"measured", c.costs.pictures_measured},
              {"picture_us", c.costs.picture_us},
              {"picture_ns_per_pixel", c.costs.picture_ns_per_pixel},
              {"capture_us", c.costs.capture_us},
              {"capture_ns_per_texel", c.costs.capture_ns_per_texel}}},
            {"trilinear", {{"measured", c.costs.trilinear_measured}, {"factor", c.costs.trilinear_factor}}},
            {"frame_error", {{"p50", c.frame_error_p50}, {"p90", c.frame_error_p90}, {"p99", c.frame_error_p99}}},
            {"timer_query",
             {{"available", c.timer.available},
              {"honest", c.timer.honest},
              {"query_ms", c.timer.query_ms},
              {"wall_ms", c.timer.wall_ms}}}};
}

/// Measured as it will be spent: threads where the walk puts them, memory kept and locked.
Result<std::function<void()>> placed_as_walked() {
    rt::raise_limits(walk::WalkRequest{}.frame_priority);
    const rt::Capabilities capable = rt::probe_capabilities(walk::WalkRequest{}.frame_priority);
    auto plan = walk::plan_placing({}, capable.fifo_priority >= walk::WalkRequest{}.frame_priority);
    if (!plan) return plan.error();
    if (!plan->fifo)
        notify("This run is not fully real-time: SCHED_FIFO is refused. The figures are measured with ordinary scheduling.");
    if (rt::guard_active()) (void)rt::prepare_memory({});
    return std::function<void()>([plan = *plan]() mutable {
        if (auto placed = walk::place_rasterisers(plan); !placed) notify(placed.error().text());
        if (auto placed = rt::place_thread(0, walk::frame_placement(plan)); !placed) notify(placed.error().text());
    });
}

Result<void> make_folder(const std::string& dir) {
    std::error_code error;
    std::filesystem::create_directories(dir, error);
    if (error)
        return Error{dir, "The folder cannot be made: " + error.message(), "Name another folder with --state",
                     ErrorKind::unwritable};
    return {};
}

nlohmann::ordered_json to_json(const measure::CostErrors& e) {
    return {{"p50", e.p50}, {"p90", e.p90}, {"p99", e.p99}, {"bias", e.bias}, {"r2", e.r2}};
}

nlohmann::ordered_json to_json(const std::vector<measure::PublishedCost>& published) {
    auto json = nlohmann::ordered_json::object();
    for (const measure::PublishedCost& p : published)
        json[std::string(p.name)] = {{"formula", p.formula},
                                     {"source", p.source},
                                     {"frame_error", to_json(p.as_published)},
                                     {"factor", p.factor},
                                     {"frame_error_with_factor", to_json(p.with_factor)}};
    return json;
}

/// Errors of held-out frames: the fit, the table, and published formulas as they are and with their factor.
void print_errors(const walk::ModelFit& fit) {
    const report::Columns columns(
        {{"", 36}, {"p50 %", -6}, {"p90 %", -6}, {"p99 %", -6}, {"bias %", -7}, {"R²", -5}, {"source", 20, 2}});
    const auto row = [&](const std::string& name, const measure::CostErrors& e, std::string_view source) {
        const auto percent = [](double share) { return fmt::format("{:.0f}", 100 * share); };
        fmt::print("  {}\n",
                   columns.row({name, percent(e.p50), percent(e.p90), percent(e.p99), fmt::format("{:+.0f}", 100 * e.bias),
                                fmt::format("{:.2f}", e.r2), std::string(source)}));
    };
    fmt::print("  {}\n", columns.heading());
    row("fitted to this model", fit.after, "");
    row("the machine's table", fit.before, "");
    for (const measure::PublishedCost& p : fit.published) {
        row(std::string(p.formula), p.as_published, p.source);
        row(fmt::format("{:.2f} * ({})", p.factor, p.formula), p.with_factor, "");
    }
}

nlohmann::ordered_json to_json(const accuracy::CostTrial& t) {
    return {{"psnr_db", t.psnr_db},
            {"psnr_db_rounds", t.of_rounds},
            {"worst_psnr_db", t.worst_psnr_db},
            {"ssim", t.ssim},
            {"unused_ms", t.unused_ms},
            {"frames", t.frames},
            {"own_misses", t.own_misses}};
}

nlohmann::ordered_json to_json(const accuracy::KeptCosts& kept) {
    return {{"reason", accuracy::name_of(kept.reason)}, {"fit", to_json(kept.of_fit)}, {"table", to_json(kept.of_table)}};
}

void print_kept(const accuracy::KeptCosts& kept) {
    fmt::print("  {} is kept, by {}: PSNR {:.1f} dB by the fit, {:.1f} dB by the table; own misses {} of {}, {} of {}\n",
               kept.fit ? "the fit" : "the table", accuracy::name_of(kept.reason), kept.of_fit.psnr_db, kept.of_table.psnr_db,
               kept.of_fit.own_misses, kept.of_fit.frames, kept.of_table.own_misses, kept.of_table.frames);
}

/// The caller's thread stays where it is: the walks' threads inherit from it.
Result<walk::ModelFit> fit_on_own_thread(model::Model model, const Path& path, const model::CostModel& table,
                                         const walk::ModelFitOptions& options, const Context& context) {
    return std::async(std::launch::async,
                      [&] { return walk::fit_to_model(std::move(model), path, table, options, terminal_progress(context)); })
        .get();
}

/// Short walks by the fit and by the table, with the settings of later walks.
Result<accuracy::KeptCosts> walk_both(const CalibrateArguments& a, const config::Configuration& settings,
                                      const walk::ModelFit& fit, const model::CostModel& table, const Path& path,
                                      const Context& context) {
    accuracy::KeepRequest request;
    walk::apply_settings(settings, request.walk);
    request.walk.model_file = a.model;
    request.walk.state_dir = a.state;
    request.walk.backend = a.backend;
    request.walk.pictures = 7;
    request.walk.seconds = a.quick ? 4 : 8;
    request.walk.given_path = std::make_shared<const Path>(accuracy::path_in_pieces(path, request.walk.seconds));
    request.fit = std::make_shared<const model::CostModel>(fit.costs);
    request.table = std::make_shared<const model::CostModel>(table);
    request.fit_error = fit.after.p50 + fit.after.p90;
    request.table_error = fit.before.p50 + fit.before.p90;
    if (a.quick) request.rounds = 1;
    return accuracy::keep_costs(
        request, [](const walk::WalkRequest& one, const Progress& progress) { return walk::run_walk(one, progress); },
        terminal_progress(context));
}

void print_fit(const CalibrateArguments& a, const walk::ModelFit& fit, const std::optional<accuracy::KeptCosts>& kept,
               bool keeps_fit, const std::string& file, const std::string& path_source) {
    const model::FrameCombine& k = fit.costs.combine;
    if (a.json) {
        print_json({{"model", a.model},
                    {"table", file},
                    {"frames", fit.frames},
                    {"repeated", fit.repeated},
                    {"slowdown", fit.slowdown},
                    {"seconds", fit.seconds},
                    {"frame", to_json(fit.costs)},
                    {"blur", blur_json(fit.costs, fit.blur_poses)},
                    {"frame_error_before", to_json(fit.before)},
                    {"frame_error", to_json(fit.after)},
                    {"published", to_json(fit.published)},
                    {"kept", keeps_fit ? "fit" : "table"},
                    {"trial", kept ? to_json(*kept) : nlohmann::ordered_json(nullptr)}});
        return;
    }
    fmt::print("{}: {} frames near {}, {:.0f} s\n  fit {}\n", a.model, fit.frames, path_source, fit.seconds, file);
    print_frame(k);
    if (fit.costs.ns_per_pixel > 0)
        fmt::print("  raster: every rasterised pixel takes {:.2f} ns more than the table has\n", fit.costs.ns_per_pixel);
    fmt::print(
        "  the budget spends x{:.2f}; a frame's median time is {:.2f} of its best here ({} of {} frames were drawn alike)\n",
        fit.costs.headroom, fit.slowdown, fit.repeated, fit.frames);
    fmt::print("  errors of the {} frames that were held out:\n", fit.frames / 2);
    print_errors(fit);
    print_blur(fit.costs, fit.blur_poses);
    if (kept) print_kept(*kept);
}

/// One model: the table stays, the weights of a frame's sums are fitted.
int run_fit(const CalibrateArguments& a, const config::Configuration& settings, const Context& context) {
    const config::Settings& s = settings.values;
    const auto backend = gl::backend_named(a.backend);
    if (!backend) return misuse(backend.error());
    if (!a.plot.empty())
        return misuse({"--plot", "A plot is made of the machine's table, not of a model's fit", "Remove the model or --plot",
                       ErrorKind::misuse});
    const std::string dir = walk::state_directory(a.state);
    std::string lacking;
    auto table = walk::load_costs(dir, "", lacking);
    if (!table) return fail(table.error());
    if (!lacking.empty())
        return fail({a.model, "The model cannot be fitted: there is no cost table in " + dir, "Run `surefoot calibrate` first",
                     ErrorKind::not_found});
    model::WalkFileInfo info;
    auto model = model::read_walk(a.model, &info);
    if (!model) return fail(model.error());
    auto path = walk::choose_path(a.path, a.model, *model, s.lift_m);
    if (!path) return fail(path.error());
    const walk::FitConditions conditions{info.hash, s.width, s.height, a.backend};
    const std::string file = walk::model_costs_file(dir, *table, conditions);
    if (auto made = make_folder(dir + "/models"); !made) return fail(made.error());
    if (auto ok = probe_writable(file); !ok) return fail(ok.error());
    auto placed = placed_as_walked();
    if (!placed) return fail(placed.error());
    walk::ModelFitOptions options;
    options.device.kind = (*backend)->kind;
    options.device.viewport = {s.width, s.height};
    options.device.rasterisers = s.rasterisers;
    options.frame_us = 1e6 / s.rate_hz;
    if (a.quick) {
        options.poses = 80;
        options.blur_poses = 6;
    }
    options.opened = *placed;
    auto fit = fit_on_own_thread(std::move(*model), path->path, *table, options, context);
    end_progress(context);
    if (!fit) return fail(fit.error());
    if (fit->machine != table->machine) {
        return fail({a.model,
                     "The model was drawn on \"" + fit->machine + "\", but the table was measured on \"" + table->machine + "\"",
                     "First run `surefoot calibrate` with the same backend and rasterisers", ErrorKind::misuse});
    }
    model::CostModel weights_of_table = *table;  // pictures were measured, whichever weights are kept
    weights_of_table.blur_loss = fit->costs.blur_loss;
    weights_of_table.blur_measured = fit->costs.blur_measured;
    std::optional<accuracy::KeptCosts> kept;
    if (a.keep == "better") {
        auto decided = walk_both(a, settings, *fit, weights_of_table, path->path, context);
        end_progress(context);
        if (!decided) return fail(decided.error());
        kept = std::move(*decided);
    }
    const bool keeps_fit = kept ? kept->fit : a.keep == "fit";
    if (!keeps_fit) fit->costs = std::move(weights_of_table);
    if (auto written = measure::write_costs(file, fit->costs); !written) return fail(written.error());
    print_fit(a, *fit, kept, keeps_fit, file, path->source);
    return exit_success;
}

int run_calibrate(const CalibrateArguments& a, const Context& context) {
    const auto read = read_settings(*a.settings);
    if (!read) return misuse(read.error());
    const config::Settings& s = read->values;
    const config::Settings& defaults = walk::settings_schema().defaults();
    gl::prepare_process(s.rasterisers);
    if (!a.model.empty()) return run_fit(a, *read, context);
    for (const auto& [given, option] : {std::pair{!a.path.empty(), "--path"},
                                        {s.lift_m != defaults.lift_m, "--lift"},
                                        {s.rate_hz != defaults.rate_hz, "--rate"},
                                        {a.keep != "better", "--keep"}}) {
        if (given)
            return misuse(
                {option, "This option needs a model", "Name the model: surefoot calibrate MODEL.walk ...", ErrorKind::misuse});
    }
    const auto backend = gl::backend_named(a.backend);
    if (!backend) return misuse(backend.error());
    const std::string dir = walk::state_directory(a.state);
    const std::string file = walk::cost_table_file(dir);
    const std::string plot = a.plot.empty() ? dir + "/costs.svg" : a.plot;
    if (auto ok = probe_writable(file, true); !ok) return fail(ok.error());
    if (auto ok = probe_writable(plot, a.plot.empty()); !ok) return fail(ok.error());
    measure::CalibrateOptions options;
    options.device.kind = (*backend)->kind;
    options.device.viewport = {s.width, s.height};
    options.device.rasterisers = s.rasterisers;
    options.quick = a.quick;
    auto placed = placed_as_walked();
    if (!placed) return fail(placed.error());
    options.opened = *placed;
    auto c = measure::calibrate(options, terminal_progress(context));
    end_progress(context);
    if (!c) return fail(c.error());
    if (auto made = make_folder(dir); !made) return fail(made.error());
    if (auto written = measure::write_costs(file, c->costs); !written) return fail(written.error());
    if (const std::size_t old = walk::drop_old_fits(dir, c->costs); old > 0) {
        notify(fmt::format("{} to the old table {} removed. Fit again with `surefoot calibrate MODEL.walk`.",
                           old == 1 ? "The fit" : fmt::format("{} fits", old), old == 1 ? "is" : "are"));
    }
    std::vector<report::CostPoint> points;
    for (const measure::CalibrationPoint& p : c->points) {
        points.push_back({effects::effects_text(p.effects, " + "), p.triangles, p.pixels, p.submit_us + p.raster_us});
    }
    if (auto written = write_text(plot, report::cost_plot_svg(c->costs.machine, points)); !written) return fail(written.error());
    if (a.json) return print_json(to_json(*c, file, plot)), exit_success;
    fmt::print("{}\n  table {} ({} points, {:.0f} s), plot {}\n", c->costs.machine, file, c->points.size(), c->seconds, plot);
    print_frame(c->costs.combine);
    fmt::print("  enlarging a smaller picture: {:.2f} ns a pixel of the whole one{}\n", c->costs.enlarge_ns_per_pixel,
               c->costs.enlarge_measured ? "" : ", a built-in figure");
    fmt::print("  each sample of a pixel beyond the first: {:.0f} % of the raster time, and {:.2f} ns a pixel{}\n",
               100 * c->costs.sample_share, c->costs.sample_pass_ns_per_pixel,
               c->costs.samples_measured ? "" : ", built-in figures");
    fmt::print("  a sky: {:.2f} ns a pixel{}\n", c->costs.background_ns_per_pixel,
               c->costs.background_measured ? "" : ", a built-in figure");
    fmt::print("  a picture of the image cache: {:.1f} us and {:.2f} ns a pixel; a new one {:.0f} us and {:.2f} ns a texel{}\n",
               c->costs.picture_us, c->costs.picture_ns_per_pixel, c->costs.capture_us, c->costs.capture_ns_per_texel,
               c->costs.pictures_measured ? "" : ", built-in figures");
    fmt::print("  trilinear textures: x{:.2f} of the raster time{}\n", c->costs.trilinear_factor,
               c->costs.trilinear_measured ? "" : ", a built-in figure");
    fmt::print("  held-out frames: error p50 {:.0f} %, p90 {:.0f} %, p99 {:.0f} %; the budget spends x{:.2f}\n",
               100 * c->frame_error_p50, 100 * c->frame_error_p90, 100 * c->frame_error_p99, c->costs.headroom);
    fmt::print("  timer query: {} (reports {:.3f} ms where {:.3f} ms pass): {}\n",
               !c->timer.available ? "absent"
               : c->timer.honest   ? "honest"
                                   : "lies",
               c->timer.query_ms, c->timer.wall_ms, c->timer.honest ? "could be used" : "fence and wall time are used");
    return exit_success;
}
}  // namespace

void add_calibrate(CLI::App& app, Context& context) {
    auto a = std::make_shared<CalibrateArguments>();
    CLI::App* c = add_command(app, "calibrate", "Measure what drawing costs on this machine, and write the cost table",
                              "surefoot calibrate && surefoot calibrate town.walk", a->json);
    c->add_option("MODEL", a->model, "Fit the cost table to this model. Later walks of the model use the fit");
    c->add_option("--path", a->path, "With a model: CSV file of the path to draw along (else MODEL.path.csv, else a tour)");
    add_setting(c, a->settings, "--lift", "lift_m", "With a model: height added to every pose of the path.");
    add_setting(c, a->settings, "--rate", "rate_hz", "With a model: frame rate of later walks.");
    c->add_option("--state", a->state, "Folder for costs.toml and costs.svg (else $STATE_DIRECTORY, else the XDG state folder)");
    c->add_option("--backend", a->backend, "Backend that draws: " + gl::drawing_backends())
        ->check(drawing_backend())
        ->capture_default_str();
    add_setting(c, a->settings, "--rasterisers", "rasterisers", "Threads of a software renderer; 0: the measured default.");
    add_setting(c, a->settings, "--width", "width");
    add_setting(c, a->settings, "--height", "height");
    c->add_option("--plot", a->plot, "SVG file for the plot of costs (else costs.svg in the state folder)");
    c->add_option(
         "--keep", a->keep,
         "With a model: what later walks use. `better` walks 6 * 8 s (--quick: 2 * 4 s) along the path by the fit and by\n"
         "the table, and keeps the one with fewer misses, else with better pictures; this takes a minute and a half")
        ->check(one_of(kept_costs))
        ->capture_default_str();
    c->add_flag("--quick", a->quick, "Measure fewer frames and classes: faster, with larger errors");
    c->callback([&context, a] { context.run = [a, &context] { return run_calibrate(*a, context); }; });
}

}  // namespace surefoot::cli
