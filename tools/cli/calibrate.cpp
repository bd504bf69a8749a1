// surefoot calibrate: measures this machine's cost table, its plot, and whether a timer query is honest.
#include <filesystem>

#include <fmt/format.h>

#include "render/measure/calibrate.hpp"
#include "rt/base/file.hpp"
#include "rt/threads/capability.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "tools/app/placing.hpp"
#include "tools/app/state.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/report.hpp"

namespace surefoot::cli {

namespace {
struct CalibrateArguments {
    std::string state, backend = "egl", plot;
    int rasterisers = 0;
    std::uint32_t width = 1280, height = 720;
    bool quick = false, json = false;
};

std::string state_name(model::EffectMask mask) {
    std::string name;
    for (int e = 0; e < model::effect_count; ++e) {
        if ((mask >> static_cast<unsigned>(e) & 1U) != 0)
            name += (name.empty() ? "" : " + ") + std::string(model::effect_names[e]);
    }
    return name.empty() ? "bare" : name;
}

nlohmann::ordered_json to_json(const measure::Calibration& c, const std::string& file, const std::string& plot) {
    const model::FrameCombine& k = c.costs.combine;
    return {{"table", file},
            {"plot", plot},
            {"machine", c.costs.machine},
            {"seconds", c.seconds},
            {"points", c.points.size()},
            {"frame",
             {{"fixed_us", k.fixed_us},
              {"submit_weight", k.submit_weight},
              {"raster_weight", k.raster_weight},
              {"max_weight", k.max_weight},
              {"upper_factor", c.costs.upper_factor},
              {"slice_us", c.costs.slice_us}}},
            {"frame_error", {{"p50", c.frame_error_p50}, {"p90", c.frame_error_p90}, {"p99", c.frame_error_p99}}},
            {"timer_query",
             {{"available", c.timer.available},
              {"honest", c.timer.honest},
              {"query_ms", c.timer.query_ms},
              {"wall_ms", c.timer.wall_ms}}}};
}

int run_calibrate(const CalibrateArguments& a, const Context& context) {
    auto kind = gl::parse_backend(a.backend);
    if (!kind) return misuse(kind.error());
    const std::string dir = app::state_directory(a.state);
    const std::string file = app::cost_table_file(dir);
    const std::string plot = a.plot.empty() ? dir + "/costs.svg" : a.plot;
    if (auto ok = probe_writable(file, true); !ok) return fail(ok.error());
    if (auto ok = probe_writable(plot, a.plot.empty()); !ok) return fail(ok.error());
    measure::CalibrateOptions options;
    options.device.kind = *kind;
    options.device.viewport = {a.width, a.height};
    options.device.rasterisers = a.rasterisers;
    options.quick = a.quick;
    // Measured as it will be spent: threads where the walk puts them, memory kept and locked.
    rt::raise_limits(app::WalkRequest{}.frame_priority);
    const rt::Capabilities capable = rt::probe_capabilities(app::WalkRequest{}.frame_priority);
    auto plan = app::plan_placing({}, capable.fifo_priority >= app::WalkRequest{}.frame_priority);
    if (!plan) return fail(plan.error());
    if (!plan->fifo) note("not fully real-time: SCHED_FIFO is refused; the table will be of ordinary scheduling");
    if (rt::guard_active()) (void)rt::prepare_memory({});
    options.opened = [&plan] {
        if (auto placed = app::place_rasterisers(*plan); !placed) note(placed.error().text());
        if (auto placed = rt::place_thread(0, app::frame_placement(*plan)); !placed) note(placed.error().text());
    };
    auto c = measure::calibrate(options, terminal_progress(context));
    end_progress(context);
    if (!c) return fail(c.error());

    std::error_code error;
    std::filesystem::create_directories(dir, error);
    if (error) return fail({dir, "cannot be made: " + error.message(), "name another folder with --state"});
    if (auto written = measure::write_costs(file, c->costs); !written) return fail(written.error());
    std::vector<report::CostPoint> points;
    for (const measure::CalibrationPoint& p : c->points) {
        points.push_back({state_name(p.effects), p.triangles, p.pixels, p.submit_us + p.raster_us});
    }
    if (auto written = write_text(plot, report::cost_plot_svg(c->costs.machine, points)); !written) return fail(written.error());
    if (a.json) return print_json(to_json(*c, file, plot)), exit_success;
    const model::FrameCombine& k = c->costs.combine;
    fmt::print("{}\n  table {} ({} points, {:.0f} s), plot {}\n", c->costs.machine, file, c->points.size(), c->seconds, plot);
    fmt::print("  frame = {:.0f} us + {:.2f} submit + {:.2f} raster + {:.2f} max(submit, raster)\n", k.fixed_us, k.submit_weight,
               k.raster_weight, k.max_weight);
    fmt::print("  held-out frames: error p50 {:.0f} %, p90 {:.0f} %, p99 {:.0f} %; the budget spends x{:.2f}\n",
               100 * c->frame_error_p50, 100 * c->frame_error_p90, 100 * c->frame_error_p99, c->costs.upper_factor);
    fmt::print("  timer query: {} (says {:.3f} ms where {:.3f} ms pass): {}\n",
               !c->timer.available ? "absent"
               : c->timer.honest   ? "honest"
                                   : "lies",
               c->timer.query_ms, c->timer.wall_ms, c->timer.honest ? "could be used" : "fence and wall time are used");
    return exit_success;
}
}  // namespace

void add_calibrate(CLI::App& app, Context& context) {
    auto a = std::make_shared<CalibrateArguments>();
    CLI::App* c = add_command(app, "calibrate", "Measure what drawing costs on this machine: the table that budgets are spent by",
                              "surefoot calibrate --state /var/lib/surefoot", a->json);
    c->add_option("--state", a->state, "Folder for costs.toml and costs.svg (else $STATE_DIRECTORY, else XDG state)");
    c->add_option("--backend", a->backend, "egl, device, osmesa or window")->check(drawing_backend())->capture_default_str();
    c->add_option("--rasterisers", a->rasterisers, "Software GL threads; 0: the measured default")
        ->check(whole_number_within(0, 64));
    c->add_option("--width", a->width, "Picture width, pixels")->check(whole_number_within(16, 8192))->capture_default_str();
    c->add_option("--height", a->height, "Picture height, pixels")->check(whole_number_within(16, 8192))->capture_default_str();
    c->add_option("--plot", a->plot, "Where the plot goes (Maciel's figure 3.4 for this machine)");
    c->add_flag("--quick", a->quick, "Under 20 s instead of under 2 minutes; a wider error");
    c->callback([&context, a] { context.run = [a, &context] { return run_calibrate(*a, context); }; });
}

}  // namespace surefoot::cli
