// surefoot walk: a real-time walk through a model, with its figures.
#include <fmt/format.h>

#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/monitor/monitor.hpp"
#include "tools/report/verdict.hpp"
#include "tools/walk/settings_request.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::cli {

namespace {

constexpr std::uint64_t unset = ~0ULL;

/// Who may look on while it walks.
struct MonitorArguments {
    std::string address;        ///< empty: nobody
    std::string incidents_dir;  ///< empty: none are written
};

/// What the command line says.
struct WalkArguments {
    walk::WalkRequest request;
    MonitorArguments watch;
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    bool no_correction = false, json = false;
    const CLI::Option* control_pairs = nullptr;
};

/// An empty variable of a script is no wish for no output.
const CLI::Validator names_something(
    [](const std::string& given) {
        return given.empty() ? std::string("names nothing: leave it out, or give a name") : std::string();
    },
    "");

/// Options whose value does not tell whether they were given.
struct Given {
    bool every = false, capture_frame = false, control_pairs = false;
};

/// Options that say nothing without another one, or the same twice, where a request as such is clear: frames go before seconds.
Result<void> check_given(const walk::WalkRequest& r, const Given& given) {
    if (r.frames > 0 && r.seconds > 0) return Error{"--seconds", "and --frames say the length twice", "leave one of them out"};
    if (given.control_pairs && !r.control)
        return Error{"--control-pairs", "says how long the control is, and there is none", "add --control"};
    if (given.every && r.snap_dir.empty())
        return Error{"--every", "says how often pictures are taken, and none are", "add --snap DIR"};
    if (given.capture_frame && r.capture_file.empty())
        return Error{"--capture-frame", "needs a file to go to", "add --capture FILE"};
    return {};
}

Result<walk::WalkRequest> to_request(WalkArguments& a) {
    auto read = read_settings(*a.settings);
    if (!read) return read.error();
    config::Configuration& c = *read;
    c.values.strict = c.values.strict || a.request.strict;
    c.values.control = c.values.control || a.request.control;
    if (auto ok = config::check(c); !ok) return ok.error();
    walk::WalkRequest r = a.request;
    walk::apply_settings(c, r);
    if (r.model_file.empty())
        return Error{"MODEL.walk", "is not named", "surefoot walk MODEL.walk, or `model = ...` in the --config file"};
    r.correct_costs = !a.no_correction;
    r.config_file = a.settings->config_file;
    const Given given{r.snap_every > 0, r.capture_frame != unset, a.control_pairs->count() > 0};
    if (auto ok = walk::check_request(r); !ok) return ok.error();
    if (auto ok = check_given(r, given); !ok) return ok.error();
    if (!r.snap_dir.empty() && r.snap_every == 0) r.snap_every = 30;
    if (r.capture_frame == unset) r.capture_frame = 0;
    return r;
}

/// Null where nothing is asked for.
Result<std::unique_ptr<monitor::Monitor>> open_monitor(const MonitorArguments& a) {
    if (a.address.empty() && a.incidents_dir.empty()) return std::unique_ptr<monitor::Monitor>();
    monitor::MonitorOptions options;
    options.address = a.address;
    options.incidents_dir = a.incidents_dir;
    options.version = SUREFOOT_VERSION;
    options.say = [](std::string_view text) { note(std::string(text)); };
    auto monitor = monitor::Monitor::open(std::move(options));
    if (monitor && !a.address.empty()) note(fmt::format("look at it with: surefoot top --socket {}", (*monitor)->address()));
    return monitor;
}

int run_walk_command(WalkArguments& a, const Context& context) {
    auto request = to_request(a);
    if (!request) return misuse(request.error());
    walk::prepare_process(*request);
    if (!a.watch.address.empty()) {
        if (const auto address = monitor::parse_address(a.watch.address); !address) return misuse(address.error());
    }
    auto monitor = open_monitor(a.watch);
    if (!monitor) return fail(monitor.error());
    walk::WalkWatch watch;
    Progress progress = terminal_progress(context);
    if (*monitor) {
        monitor::watch_with(**monitor, *request, watch);
        progress.note = [tell = progress.note, m = monitor->get()](std::string_view text) {
            tell(text);
            m->add_note(text);
        };
    }
    auto outcome = walk::run_walk(*request, progress, watch);
    monitor->reset();  // what waits to be written is, before the figures are
    end_progress(context);
    if (!outcome) return fail(outcome.error());
    for (const std::string& text : outcome->notes) note(text);
    if (a.json) {
        fmt::print("{}\n", report::to_json(outcome->summary));
        // The table says these itself.
        if (!outcome->summary.uncalibrated.empty()) note("uncalibrated: " + outcome->summary.uncalibrated);
        for (const rt::Lack& d : outcome->summary.degraded) note("not fully real-time: " + d.what + " (" + d.remedy + ")");
        for (const std::string& problem : outcome->summary.census_problems) note("thread census: " + problem);
    } else {
        fmt::print("{}", report::to_table(outcome->summary, context.colour));
        if (!outcome->report_page.empty()) fmt::print("report: {}\n", outcome->report_page);
    }
    for (const Error& error : outcome->failures) fail(error);
    if (outcome->stopped)
        note(fmt::format("stopped by the user after {} frames; the figures are of these", outcome->summary.frames));
    const bool broken = report::rule_broken(outcome->summary.control);
    if (broken) note("the deadline rule is broken: see the control's figures");
    return outcome->failures.empty() && !outcome->stopped && !broken ? exit_success : exit_failure;
}

}  // namespace

void add_walk(CLI::App& app, Context& context) {
    auto a = std::make_shared<WalkArguments>();
    walk::WalkRequest& r = a->request;
    r.capture_frame = unset;
    CLI::App* c =
        add_command(app, "walk", "Walk through a model in real time, and show the figures",
                    "surefoot walk town.walk --seconds 30 --report report\n"
                    "  surefoot walk town.walk --input devices --seconds 600             (a gamepad or 3D mouse steers)\n"
                    "  surefoot walk town.walk --input pad.hid --steering pad.toml       (a recorded visitor steers)\n"
                    "  surefoot walk town.walk --clock virtual --backend null --json     (deterministic, no GL)\n"
                    "  surefoot walk town.walk --monitor 127.0.0.1:9464 --incidents incidents\n"
                    "  surefoot walk town.walk --control                                 (six minutes: the deadline rule)",
                    a->json);
    c->add_option("model", r.model_file, "The .walk model (else the one that --config names)");
    c->add_option("--path", r.path_file,
                  "Poses over time, CSV (else MODEL.path.csv, else a tour). With --input it is not followed: "
                  "its first pose is the start, poses at equal times are the viewpoints, and `tour` follows it");
    c->add_option(
         "--input", r.input_file,
         "Who steers in place of the path. `devices`: what is plugged in, and what will be (a file of that name is ./devices); "
         "ends with --seconds or --frames, else after the path's length; needs the real clock. Else a file: a device's reports "
         "in "
         "hid-recorder's text format, each in its recorded time; ends a second after the last report, or with --seconds or "
         "--frames. Check it with `surefoot devices describe`")
        ->check(names_something);
    c->add_option("--steering", r.steering_file,
                  "How --input steers, TOML: [motion], [safety], [[device]], [[gpio]] (else the default of the device's class)");
    c->add_flag("--clear-stop", r.clear_stop,
                "--input devices: take off an emergency stop that an earlier walk left latched (else: what does stop_reset)");
    c->add_option("--frames", r.frames,
                  "Frames to walk (else --seconds, else the recording and a second, else as long as the path)")
        ->check(whole_number_within(1, 4'000'000));
    c->add_option("--seconds", r.seconds, "Seconds to walk; the path is walked forth and back")
        ->check(number_within(0.001, 1e6, "s"));
    add_settings(c, a->settings, {{"--accuracy", "accuracy"}, {"--cost-scale", "cost_scale"}},
                 {{"--slice", "slice_us"}, {"--hysteresis", "hysteresis"}});
    c->add_option("--cost-noise", r.cost_noise, "Virtual clock: relative noise on costs")->check(number_within(0, 10));
    for (const char* experiment : {"--slice", "--hysteresis", "--cost-noise"}) c->get_option(experiment)->group(hidden_group);
    c->add_flag("--strict", r.strict,
                "Do not start where anything that real time needs is refused: FIFO, locked memory, an isolated core, "
                "placing, a cost table");
    c->add_flag("--no-check", a->settings->no_check, "Without the in-frame check, to see what it is worth");
    c->add_flag("--no-occlusion", a->settings->no_occlusion, "Keep what other things hide, to see what leaving it out is worth");
    c->add_flag("--no-correction", a->no_correction, "Predictions are not corrected online");
    c->add_flag("--control", r.control, "Alternate blocks of the walk and of a bare loop, and judge by the deadline rule");
    a->control_pairs = c->add_option("--control-pairs", r.control_pairs, "Pairs of blocks; the rule wants 90")
                           ->check(whole_number_within(1, 100000))
                           ->capture_default_str();
    c->add_option("--state", r.state_dir, "Folder with the calibrated cost table");
    c->add_option("--ledger", r.ledger_file, "CSV, a row a frame")->check(names_something);
    c->add_option("--trace", r.trace_file, "A trace that ui.perfetto.dev opens")->check(names_something);
    c->add_option("--report", r.report_dir, "A page to look at: DIR/index.html")->check(names_something);
    c->add_option("--monitor", a->watch.address,
                  "Serve live figures while it walks, for `surefoot status`, `surefoot top` and Prometheus (/metrics): "
                  "unix:PATH, or 127.0.0.1:PORT (port 0: any)");
    c->add_option("--incidents", a->watch.incidents_dir,
                  "Folder in which bursts of misses are written down as they happen: the last minute's ledger and trace; "
                  "the newest 20, at most 256 MiB")
        ->check(names_something);
    c->add_option("--snap", r.snap_dir, "Pictures of what the walk drew: DIR/00000.png, ...; what 256 MiB of memory hold")
        ->check(names_something);
    c->add_option("--every", r.snap_every, "A picture every N frames [30]")->check(whole_number_within(1, 1'000'000'000));
    c->add_option("--capture", r.capture_file, "One frame's prepared arrays and cut, for `surefoot replay`")
        ->check(names_something);
    c->add_option("--capture-frame", r.capture_frame, "Which frame to capture [0]")->check(whole_number_within(0, 4'000'000));
    c->callback([&context, a] { context.run = [a, &context] { return run_walk_command(*a, context); }; });
}

}  // namespace surefoot::cli
