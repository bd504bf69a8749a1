// surefoot soak: hours of a walk under a rotating mix of load, with a verdict.
#include <fmt/format.h>

#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/soak/soak.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

namespace {

/// 90 pairs of blocks, and ten minutes of memory from the first sample after the warm-up to the last; they are 10 s apart.
constexpr double judged_from_s = 780;

struct SoakArguments {
    soak::SoakRequest request;
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    std::string mix;
    double seconds = 0, hours = 0;
    bool strict = false, no_control = false, json = false;
};

Result<soak::SoakRequest> to_soak_request(const SoakArguments& a) {
    soak::SoakRequest r = a.request;
    if (a.seconds > 0 && a.hours > 0)
        return Error{"--hours", "--hours and --seconds both set the length", "Remove one of them", ErrorKind::misuse};
    if (a.seconds > 0) r.seconds = a.seconds;
    if (a.hours > 0) r.seconds = a.hours * 3600;
    if (!a.mix.empty()) {
        auto mix = soak::parse_mix(a.mix);
        if (!mix) return mix.error();
        r.mix = *mix;
    }
    auto settings = read_settings(*a.settings);
    if (!settings) return settings.error();
    settings->values.strict = settings->values.strict || a.strict;
    if (auto ok = config::check(*settings); !ok) return ok.error();
    walk::apply_settings(*settings, r.walk);
    r.walk.config_file = a.settings->config_file;
    r.control = !a.no_control;
    if (auto ok = walk::check_request(r.walk); !ok) return ok.error();
    return r;
}

int run_soak_command(const SoakArguments& a, const Context& context) {
    auto request = to_soak_request(a);
    if (!request) return misuse(request.error());
    walk::prepare_process(request->walk);
    if (request->seconds < judged_from_s) {
        notify(fmt::format("A verdict needs at least {:.1f} minutes. In {:.0f} s some rules cannot be judged.",
                           judged_from_s / 60, request->seconds));
    }
    auto outcome = soak::run_soak(*request, terminal_progress(context));
    end_progress(context);
    if (!outcome) return fail(outcome.error());
    const soak::SoakSummary& s = outcome->summary;
    for (const std::string& text : outcome->notes) notify(text);
    if (a.json) {
        fmt::print("{}", soak::soak_json(s));
        if (!s.walk.uncalibrated.empty()) notify("The figures are uncalibrated: " + s.walk.uncalibrated + ".");
        for (const rt::Lack& d : s.walk.degraded) notify("The soak was not fully real-time: " + d.text());
    } else {
        fmt::print("{}", soak::soak_table(s, context.colour));
        if (!outcome->report_page.empty()) fmt::print("report: {}\n", outcome->report_page);
    }
    for (const Error& error : outcome->failures) fail(error);
    if (s.stopped)
        notify(fmt::format("The soak was stopped by the user after {:.0f} of {:.0f} s. The figures cover this time.", s.ran_s,
                           s.requested_s));
    const bool holds = soak::verdict_of(s) == soak::Judged::holds;
    return holds && outcome->failures.empty() && !s.stopped ? exit_success : exit_failure;
}

}  // namespace

void add_soak(CLI::App& app, Context& context) {
    auto a = std::make_shared<SoakArguments>();
    soak::SoakRequest& r = a->request;
    CLI::App* c =
        add_command(app, "soak", "Walk for hours under changing load, and judge the result",
                    "surefoot soak town.walk --rate 60 --size 640x480 --report soak\n"
                    "  surefoot soak town.walk --hours 8 --mix cpu,memory,io,forks,devices,reloads,caches\n"
                    "  surefoot soak town.walk --hours 1 --clock virtual --backend null --json      (seconds: for CI)\n\n"
                    "The exit status is 0 only if every rule of the verdict holds. The load runs in child processes,\n"
                    "which always end with this command.",
                    a->json);
    c->add_option("model", r.walk.model_file, "The .walk model")->required();
    c->add_option("--path", r.walk.path_file,
                  "CSV file of poses over time (else MODEL.path.csv, else a tour); walked back and forth");
    c->add_option("--seconds", a->seconds, "Duration in seconds; with the control, whole pairs of blocks fit in it [1200]")
        ->check(number_within(1, 1e6, "s"));
    c->add_option("--hours", a->hours, "Duration in hours")->check(number_within(0.001, 240, "h"));
    c->add_option(
        "--mix", a->mix,
        "Loads, separated by commas [cpu,memory,io,forks,devices,reloads,caches]. `caches` drops the machine's page cache, if "
        "permitted. `clock` steps the machine's time of day and back, and is never a default. On the virtual clock only "
        "`reloads` runs");
    c->add_option("--clock-step", r.clock_step_s, "Seconds by which the load `clock` steps the time of day")
        ->check(number_within(0.001, 86400, "s"))
        ->capture_default_str();
    c->add_option("--seed", r.seed, "Random seed; the same seed gives the same order of loads")->capture_default_str();
    c->add_option("--report", r.report_dir, "Folder for a report: index.html and soak.json");
    add_settings(c, a->settings);
    c->add_flag("--no-control", a->no_control,
                "Run the walk without its control: twice the frames, judged by the own misses only");
    c->add_flag("--strict", a->strict,
                "Do not start if real time lacks anything: SCHED_FIFO, locked memory, an isolated core, thread placement or a "
                "cost table");
    c->add_option("--state", r.walk.state_dir, "Folder of the calibrated cost table");
    c->callback([&context, a] { context.run = [a, &context] { return run_soak_command(*a, context); }; });
}

}  // namespace surefoot::cli
