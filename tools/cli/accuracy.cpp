// surefoot accuracy: what accuracy costs in time on this model and machine, as a chart, a table and a page.
#include <cmath>

#include <fmt/format.h>

#include "render/gl/device.hpp"
#include "render/select/registry.hpp"
#include "tools/accuracy/sweep.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/report/report.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {
struct AccuracyArguments {
    accuracy::AccuracyRequest request;
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    std::string out = "accuracy";
    bool json = false;
};

void print_points(const accuracy::AccuracyRun& run) {
    fmt::print("{} at {} poses, {}x{}; full detail takes {:.1f} ms a frame\n", run.model, run.poses, run.width, run.height,
               run.full_frame_ms);
    const report::Columns columns({{"selector", 18},
                                   {"budget ms", -10},
                                   {"p50 ms", -10},
                                   {"p90 ms", -10},
                                   {"accuracy 1/r", -12},
                                   {"exact", -6},
                                   {"SNR dB", -8},
                                   {"SSIM", -7},
                                   {"triangles", -11}});
    fmt::print("{}\n", columns.heading());
    const auto text = [](double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); };
    for (const accuracy::AccuracyPoint& p : run.points)
        fmt::print("{}\n", columns.row({p.selector, text(p.budget_ms, 2), text(p.frame_ms_p50, 2), text(p.frame_ms_p90, 2),
                                        std::isfinite(p.accuracy_mean) ? text(p.accuracy_mean, 1) : "exact",
                                        std::to_string(p.exact), text(p.snr_db, 2), text(p.ssim, 4), text(p.triangles, 0)}));
}

std::string per_rad(double accuracy) { return std::isfinite(accuracy) ? fmt::format("{:.1f}", accuracy) : "exact"; }

std::string decibels(const accuracy::AccuracyPoint& p) {
    return p.psnr_db < report::max_psnr_db ? fmt::format("{:.2f} dB", p.psnr_db) : "equal";
}

void print_one_more_ms(const accuracy::AccuracyRun& run) {
    if (run.one_more_ms.empty()) return;
    fmt::print("One more millisecond than {:.1f} ms ({:g} Hz) buys:\n", run.working_ms, run.rate_hz);
    for (const accuracy::OneMoreMs& m : run.one_more_ms)
        fmt::print("  {:<16} worst accuracy {} to {} rad^-1, mean {} to {}, PSNR {} to {}, value {:.2f} to {:.2f} %\n",
                   m.now.selector, per_rad(m.now.accuracy_worst), per_rad(m.more.accuracy_worst), per_rad(m.now.accuracy_mean),
                   per_rad(m.more.accuracy_mean), decibels(m.now), decibels(m.more), 100 * m.now.value, 100 * m.more.value);
}

void print_changes(const accuracy::AccuracyRun& run) {
    if (run.changes.empty()) return;
    fmt::print("One setting changed, {} at {:.1f} ms:\n", run.changes.front().point.selector, run.working_ms);
    for (const accuracy::ChangeMark& mark : run.changes)
        fmt::print("  {:<24} frame {:.1f} ms, worst accuracy {} rad^-1, PSNR {}, FLIP {:.4f}\n", mark.change,
                   mark.point.frame_ms_p50, per_rad(mark.point.accuracy_worst), decibels(mark.point), mark.point.flip);
}

void put_settings(const config::Settings& s, accuracy::AccuracyRequest& r) {
    r.width = s.width;
    r.height = s.height;
    r.shift_x = s.shift_x;
    r.shift_y = s.shift_y;
    r.lift_m = s.lift_m;
    r.rate_hz = s.rate_hz;
    r.workers = s.workers;
    r.rasterisers = s.rasterisers;
}

Result<void> check_selectors(const accuracy::AccuracyRequest& request) {
    for (const std::string& name : request.selectors)
        if (const auto entry = select::selector_named(name); entry && (*entry)->follows_time)
            return Error{"--selector " + name, "This selector follows the time of the frame before, and single places have none",
                         "Use surefoot compare, which walks", ErrorKind::misuse};
    return check_benefit(request.benefit, request.selectors);
}

int run_accuracy_command(AccuracyArguments& a, const Context& context) {
    const auto read = read_settings(*a.settings);
    if (!read) return misuse(read.error());
    put_settings(read->values, a.request);
    if (auto ok = check_selectors(a.request); !ok) return misuse(ok.error());
    gl::prepare_process(a.request.rasterisers);
    if (auto ok = accuracy::probe_accuracy_page(a.out); !ok) return fail(ok.error());
    auto run = accuracy::run_accuracy(a.request, terminal_progress(context));
    end_progress(context);
    if (!run) return fail(run.error());
    if (!run->uncalibrated.empty()) notify("The figures are uncalibrated: " + run->uncalibrated + ".");
    if (auto w = accuracy::write_accuracy_page(a.out, *run); !w) return fail(w.error());
    if (a.json) {
        fmt::print("{}\n", accuracy::accuracy_json(*run));
    } else {
        print_points(*run);
        print_one_more_ms(*run);
        print_changes(*run);
        fmt::print("page: {}/index.html\n", a.out);
    }
    return exit_success;
}
}  // namespace

void add_accuracy(CLI::App& app, Context& context) {
    auto a = std::make_shared<AccuracyArguments>();
    CLI::App* c = add_command(
        app, "accuracy", "Measure accuracy, SNR and SSIM against frame time over a range of budgets",
        "surefoot accuracy town.walk --path town.path.csv -o accuracy\n\n"
        "The accuracy of a point is the mean over its poses. Poses drawn exactly have no finite accuracy: they are left out\n"
        "of the mean and counted apart. A point with only such poses is 'exact'.\n"
        "The page also has the worst accuracy, PSNR, FLIP, and what one more millisecond buys at the budget of --rate.\n"
        "There it also draws without occlusion culling, without focus, with gestalt, and at 75 % resolution.",
        a->json);
    accuracy::AccuracyRequest& r = a->request;
    c->add_option("model", r.model_file, "The .walk model")->required();
    c->add_option("--path", r.path_file, "CSV file of the path along which poses are taken (else MODEL.path.csv, else a tour)");
    c->add_option("-o,--out", a->out, "Output folder for index.html, accuracy.svg, accuracy-worst.svg and accuracy.csv")
        ->capture_default_str();
    c->add_option("--size", a->settings->size, "Size of the picture in pixels [1280x720]");
    add_setting(c, a->settings, "--shift-x", "shift_x");
    add_setting(c, a->settings, "--shift-y", "shift_y");
    c->add_option("--poses", r.poses, "Number of poses along the path, 1 to 256")
        ->check(whole_number_within(1, 256))
        ->capture_default_str();
    c->add_option("--repeats", r.repeats, "Timed repetitions per pose; the median is used")
        ->check(whole_number_within(1, 100))
        ->capture_default_str();
    c->add_option("--selector", r.selectors, "Selectors to compare")
        ->check(one_of(select::compared_names()))
        ->capture_default_str();
    add_benefit(c, r.benefit);
    c->add_option("--budget", r.budgets_ms, "Frame budgets in ms (else eight fractions of the time of a full frame)")
        ->check(number_within(0.001, 1e5, "ms"));
    add_time(c, r.time_s);
    add_setting(c, a->settings, "--lift", "lift_m");
    add_setting(c, a->settings, "--rate", "rate_hz", "Frame rate at whose budget one more millisecond is bought.");
    c->add_option("--backend", r.backend, "Backend that draws: " + gl::drawing_backends())
        ->check(drawing_backend())
        ->capture_default_str();
    add_setting(c, a->settings, "--workers", "workers", "Threads that prepare frames; 0: one per core.");
    add_setting(c, a->settings, "--rasterisers", "rasterisers", "Threads of a software renderer; 0: the measured default.");
    c->add_option("--state", r.state_dir, "Folder of the calibrated cost table");
    c->callback([&context, a] { context.run = [a, &context] { return run_accuracy_command(*a, context); }; });
}

}  // namespace surefoot::cli
