// surefoot walk: a real-time walk through a model, with its figures.
#include <fmt/format.h>

#include <array>
#include <memory>

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

/// Options whose value does not tell whether they were given.
struct Given {
    bool every = false, capture_frame = false, control_pairs = false;
};

/// Options that say nothing without another one, or the same twice, where a request as such is clear: frames go before seconds.
Result<void> check_given(const walk::WalkRequest& r, const Given& given) {
    if (r.frames > 0 && r.seconds > 0)
        return Error{"--seconds", "--seconds and --frames both set the length", "Remove one of them", ErrorKind::misuse};
    if (given.control_pairs && !r.control)
        return Error{"--control-pairs", "This option sets the control's length, and there is no control", "Add --control",
                     ErrorKind::misuse};
    if (given.every && r.snap_dir.empty())
        return Error{"--every", "This option sets how often pictures are taken, and none are taken", "Add --snap DIR",
                     ErrorKind::misuse};
    if (given.capture_frame && r.capture_file.empty())
        return Error{"--capture-frame", "A captured frame needs a file", "Add --capture FILE", ErrorKind::misuse};
    return {};
}

Result<walk::WalkRequest> to_request(WalkArguments& a) {
    auto read = read_settings(*a.settings);
    if (!read) return read.error();
    config::Configuration& c = *read;
    c.values.strict = c.values.strict || a.request.strict;
    c.values.control = c.values.control || a.request.control;
    c.values.fullscreen = c.values.fullscreen || a.request.fullscreen;
    if (auto ok = config::check(c); !ok) return ok.error();
    walk::WalkRequest r = a.request;
    walk::apply_settings(c, r);
    r.may_leave = r.may_steer = true;  // no other command's figures depend on who stands at the window
    if (r.model_file.empty())
        return Error{"MODEL.walk", "The model is not named",
                     "Run: surefoot walk MODEL.walk, or set `model = ...` in the --config file", ErrorKind::misuse};
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
    options.notify = [](std::string_view text) { notify(std::string(text)); };
    auto monitor = monitor::Monitor::open(std::move(options));
    if (monitor && !a.address.empty())
        notify(fmt::format("Watch the walk live: run `surefoot top --socket {}`.", (*monitor)->address()));
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
    walk::WalkObserver watch;
    Progress progress = terminal_progress(context);
    if (*monitor) {
        monitor::attach_monitor(**monitor, *request, watch);
        progress.notify = [notify_terminal = progress.notify, m = monitor->get()](std::string_view text) {
            notify_terminal(text);
            m->add_note(text);
        };
    }
    auto outcome = walk::run_walk(*request, progress, watch);
    monitor->reset();  // what waits to be written is, before the figures are
    end_progress(context);
    if (!outcome) return fail(outcome.error());
    for (const std::string& text : outcome->notes) notify(text);
    if (a.json) {
        fmt::print("{}\n", report::to_json(outcome->summary));
        // The table says these itself.
        if (!outcome->summary.uncalibrated.empty())
            notify("The figures are uncalibrated: " + outcome->summary.uncalibrated + ".");
        for (const rt::Lack& d : outcome->summary.degraded) notify("The walk was not fully real-time: " + d.text());
        for (const std::string& problem : outcome->summary.census_problems)
            notify("The thread census found a difference: " + problem + ".");
    } else {
        fmt::print("{}", report::to_table(outcome->summary, context.colour));
        if (!outcome->report_page.empty()) fmt::print("report: {}\n", outcome->report_page);
    }
    for (const Error& error : outcome->failures) fail(error);
    if (outcome->stopped)
        notify(
            fmt::format("The walk was stopped by the user after {} frames. The figures cover these.", outcome->summary.frames));
    if (outcome->left)
        notify(fmt::format("The visitor left by the window after {} frames. The figures cover these.", outcome->summary.frames));
    const bool broken = report::rule_broken(outcome->summary.control);
    if (broken) notify("The deadline rule is broken. See the control's figures.");
    return outcome->failures.empty() && !outcome->stopped && !broken ? exit_success : exit_failure;
}

/// What the walk follows: a path, devices or a recording.
void add_sources(CLI::App* c, walk::WalkRequest& r) {
    c->add_option("--path", r.path_file,
                  "CSV file of poses over time (else MODEL.path.csv, else the model's default path); `none`: around its box. "
                  "With --input the path is not followed: "
                  "its first pose is the start, poses at equal times are viewpoints, and the action `tour` follows it");
    c->add_option(
         "--input", r.input_file,
         "Source of steering, instead of the path: `devices`, `window` or a recording. `devices` uses all devices, plugged now "
         "or later. It needs the real clock, and ends with --seconds, --frames, or the path's length. "
         "`window` is the keyboard and mouse of --backend window, and ends with --seconds, --frames, or Escape. "
         "A recording is in hid-recorder's text format, and ends a second after its last report. "
         "Check it with `surefoot devices describe`. A file named devices is ./devices")
        ->check(names_something());
    c->add_flag("--fullscreen", r.fullscreen, "With --backend window: fill the screen at first. F11 changes that");
    c->add_option(
        "--steering", r.steering_file,
        "TOML file with [motion], [safety], [[device]] and [[gpio]] for --input (else the default of the device's class)");
    c->add_flag("--clear-stop", r.clear_stop,
                "With --input devices: release an emergency stop that an earlier walk left latched");
}

/// What of the light is not drawn at first, and the hour.
void add_light(CLI::App* c, const std::shared_ptr<SettingArguments>& a) {
    constexpr std::array<const char*, rt::switch_count> without = {
        "Colours as they are, without sun and sky light; key L of a window switches it, and the action sunlight of any device",
        "The sun everywhere, as if nothing hid it; switched by key J and the action shadows",
        "No light of any lamp, nor of what glows, by night with --hour; switched by key K and the action lamps",
        "What is far keeps its colours; switched by key H and the action fog",
    };
    for (std::size_t i = 0; i < without.size(); ++i)
        c->add_flag(fmt::format("--no-{}", rt::light_switches[i].name), a->no_light[i], without[i]);
    add_setting(c, a, "--hour", "hour");
    add_setting(c, a, "--hour-speed", "hour_speed");
    c->add_flag("--no-motion", a->no_motion, "What animations move stands as at their start");
    c->add_flag(
        "--buy-effects", a->buy_effects,
        "Leave parts of the light out of frames in which forms show more for their time. A part stays away for 3 s at 30 Hz "
        "or longer");
    c->add_flag(
        "--cache", a->cache,
        "Draw what is far as pictures that are made while walking, each right to a pixel. New ones are bought where they pay. "
        "--cache=surround keeps those all round the eye, so that a turn needs no new ones; --cache=off: none");
}

/// What real time must have, and what is switched off or measured for comparison.
void add_comparisons(CLI::App* c, WalkArguments& a) {
    c->add_flag("--strict", a.request.strict,
                "Do not start if real time lacks anything: SCHED_FIFO, locked memory, an isolated core, thread placement or a "
                "cost table");
    c->add_flag("--no-check", a.settings->no_check, "Disable the in-frame check (for comparison)");
    c->add_flag("--no-occlusion", a.settings->no_occlusion, "Disable occlusion culling (for comparison)");
    c->add_flag("--no-correction", a.no_correction, "Disable the online correction of predicted costs (for comparison)");
    c->add_flag("--control", a.request.control,
                "Alternate blocks of the walk with blocks of a bare loop, and apply the deadline rule");
    a.control_pairs =
        c->add_option("--control-pairs", a.request.control_pairs, "Number of pairs of blocks; the deadline rule needs 90")
            ->check(whole_number_within(1, 100000))
            ->capture_default_str();
}

/// What the walk reads from the state folder, and every file that it writes.
void add_outputs(CLI::App* c, WalkArguments& a) {
    walk::WalkRequest& r = a.request;
    c->add_option("--state", r.state_dir, "Folder of the calibrated cost table");
    c->add_option("--ledger", r.ledger_file, "CSV file with one row per frame")->check(names_something());
    c->add_option("--trace", r.trace_file, "Trace file for ui.perfetto.dev")->check(names_something());
    c->add_option("--report", r.report_dir, "Folder for a report: index.html, with pictures and the forms that cost them most")
        ->check(names_something());
    c->add_option(
         "--pictures", r.pictures,
         "Number of frames that are compared with full detail after the walk, evenly spread. They give PSNR, SSIM and FLIP "
         "[7 with --report, else 0]")
        ->check(whole_number_within(1, 100));
    c->add_option(
        "--monitor", a.watch.address,
        "Address for live figures: unix:PATH, or 127.0.0.1:PORT (port 0: any free port). `surefoot status`, `surefoot top` "
        "and Prometheus (/metrics) read them");
    c->add_option("--incidents", a.watch.incidents_dir,
                  "Folder for bursts of misses: the ledger and trace of the last minute. The newest 20 are kept, at most 256 MiB")
        ->check(names_something());
    c->add_option("--snap", r.snap_dir,
                  "Folder for pictures of the walk: 00000.png and so on, as many as fit in 256 MiB of memory")
        ->check(names_something());
    c->add_option("--every", r.snap_every, "Take a picture every N frames [30]")->check(whole_number_within(1, 1'000'000'000));
    c->add_option("--capture", r.capture_file, "File for the prepared arrays and cut of one frame, for `surefoot replay`")
        ->check(names_something());
    c->add_option("--capture-frame", r.capture_frame, "Number of the frame to capture [0]")
        ->check(whole_number_within(0, 4'000'000));
}

}  // namespace

void add_walk(CLI::App& app, Context& context) {
    auto a = std::make_shared<WalkArguments>();
    walk::WalkRequest& r = a->request;
    r.capture_frame = unset;
    CLI::App* c = add_command(
        app, "walk", "Walk through a model in real time, and print the figures",
        "surefoot walk town.walk --seconds 30 --report report\n"
        "  surefoot walk town.walk --input devices --seconds 600             (a gamepad or 3D mouse steers)\n"
        "  surefoot walk town.walk --input pad.hid --steering pad.toml       (a recorded visitor steers)\n"
        "  surefoot walk town.walk --backend window                          (keyboard and mouse steer, see below)\n"
        "  surefoot walk town.walk --clock virtual --backend null --json     (deterministic, no GL)\n"
        "  surefoot walk town.walk --monitor 127.0.0.1:9464 --incidents incidents\n"
        "  surefoot walk town.walk --control                                 (six minutes: the deadline rule)\n\n"
        "In a window, W A S D or the arrow keys walk, and Shift runs. E and Q or Page Up and Down fly up and down.\n"
        "Z looks closer, as through binoculars, and X back. L, J, K and H switch sunlight, shadows, lamps and fog.\n"
        "Drag with the left mouse button to look around, or press the right one to capture the pointer. T follows the\n"
        "path, N goes to the next viewpoint, Home back to the start, and P pauses. F11 fills the screen. Escape releases\n"
        "a captured pointer, else it ends the walk with all figures and exit code 0, as closing the window does.\n"
        "Without --input the path is followed until a key or the mouse steers. The walk then lasts until Escape.\n"
        "With --input devices both steer.\n\n"
        "In --json, `coarse_frames` counts frames with coarser slices. `floor_frames` counts frames where over half of the\n"
        "picture fell to the coarsest forms, although the forms of the frame before would have been drawn in time.\n"
        "Where the eye stands still, full detail is drawn over several frames, then smoothed by 64 samples. In --json,\n"
        "`rest` counts the frames at rest, those that show full detail, and the samples of the smoothest picture.",
        a->json);
    c->add_option("model", r.model_file, "The .walk model (else `model` in the --config file)");
    add_sources(c, r);
    c->add_option("--frames", r.frames,
                  "Frames to walk (else --seconds, else the recording and one second, else the path's length)")
        ->check(whole_number_within(1, 4'000'000));
    c->add_option("--seconds", r.seconds, "Seconds to walk; the path is walked back and forth")
        ->check(number_within(0.001, 1e6, "s"));
    add_settings(c, a->settings,
                 {{"--accuracy", "accuracy"},
                  {"--min-accuracy", "min_accuracy"},
                  {"--resolution", "resolution"},
                  {"--samples", "samples"},
                  {"--walking", "walking"},
                  {"--eye-height", "eye_height_m"},
                  {"--body-radius", "body_radius_m"},
                  {"--step-height", "step_height_m"},
                  {"--max-slope", "max_slope_deg"},
                  {"--edge", "edge_m"},
                  {"--pointer-turn", "pointer_turn_deg"},
                  {"--filter", "filter"},
                  {"--rest-after", "rest_after_ms"},
                  {"--reserve", "reserve"},
                  {"--cost-scale", "cost_scale"}},
                 {{"--slice", "slice_us"}, {"--hysteresis", "hysteresis"}});
    c->add_option("--cost-noise", r.cost_noise, "With --clock virtual: relative noise of the costs")->check(number_within(0, 10));
    for (const char* experiment : {"--slice", "--hysteresis", "--cost-noise"}) c->get_option(experiment)->group(hidden_group);
    add_light(c, a->settings);
    add_comparisons(c, *a);
    add_outputs(c, *a);
    c->callback([&context, a] { context.run = [a, &context] { return run_walk_command(*a, context); }; });
}

}  // namespace surefoot::cli
