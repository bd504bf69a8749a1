// Opening a walk: everything that can be wrong is found here, before a frame is due.
#include "tools/walk/walk_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/seat.hpp"
#include "render/gl/backends.hpp"
#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "render/select/registry.hpp"
#include "tools/walk/light.hpp"
#include "tools/walk/pose_source.hpp"
#include "tools/walk/real_time.hpp"
#include "tools/walk/settings_request.hpp"
#include "tools/walk/state.hpp"
#include "tools/walk/walk_results.hpp"

namespace surefoot::walk {

namespace {

Result<void> read_request(Session& s) {
    auto period = rt::period_of_rate_ns(s.request.rate_hz);
    if (!period) return period.error();
    s.grid.period_ns = *period;
    if (s.observer.display != nullptr && !s.virtual_clock) {
        auto refreshes = rt::refreshes_per_slot(s.observer.display->refreshes, s.request.rate_hz);
        if (!refreshes) return refreshes.error();
        s.display.emplace(s.observer.display->refreshes, *refreshes);
    }
    return check_request(s.request);
}

bool window_of(const WalkRequest& r) {
    const auto backend = gl::backend_named(r.backend);
    return backend && (*backend)->kind == gl::BackendKind::window;
}

/// Read first of all: a wrong steering file is found before a large model is opened.
Result<void> open_input(Session& s) {
    if (s.request.input_file.empty() && !window_steers(s.request)) return {};
    notify_step(s, WalkStep::input);
    auto input = InputSession::open(s.request, s.grid.period_ns, s.notes);
    if (!input) return input.error();
    s.input = std::move(*input);
    return {};
}

/// Real time and the cost table, or what they lack; with --strict a lack is an error.
Result<void> claim(Session& s) {
    const WalkRequest& r = s.request;
    notify_step(s, WalkStep::real_time);
    auto plan = claim_real_time(r, !s.virtual_clock, s.facts);
    if (!plan) return plan.error();
    s.plan = *plan;
    s.plan.input = s.input != nullptr;
    s.plan.devices = s.input && r.input_file == live_input;
    s.plan.window = window_of(r);
    notify_step(s, WalkStep::input);
    if (r.given_costs) {
        s.costs = *r.given_costs;
    } else {
        auto costs = load_costs(state_directory(r.state_dir), "", s.facts.uncalibrated);
        if (!costs) return costs.error();
        s.costs = std::move(*costs);
    }
    if (!r.strict) return {};
    notify_step(s, WalkStep::real_time);
    std::vector<rt::Lack> lacks = s.facts.degraded;
    if (!s.facts.uncalibrated.empty()) lacks.push_back({rt::LackKind::cost_table, s.facts.uncalibrated, ""});
    return require_real_time(lacks);
}

/// Waits for a screen that another program has; without an end for any screen, as a kiosk's may be off when it starts.
bool wait_for_screen(const Error& why, bool held, bool endless, const Progress& progress, std::string& notified) {
    if (progress.stopped() || (!held && !(endless && why.kind == ErrorKind::no_device))) return false;
    std::string text = fmt::format("{}: {}. {}. The walk waits for it.", why.place, why.what, why.remedy);
    if (text != notified && progress.notify) progress.notify(text);
    notified = std::move(text);
    return true;
}

/// The grid follows a display that tells when it shows, where the rate divides its refresh.
void follow_display(Session& s) {
    gl::Device& device = s.engine->device();
    const rt::Refreshes refreshes = device.refreshes();
    if (s.virtual_clock || s.observer.display != nullptr || s.engine->options().device.kind != gl::BackendKind::kms) return;
    if (refreshes.period_ns == 0) {
        device.wait_for_flips(false);
        s.notes.emplace_back("screen: Its card counts no refreshes. Pictures are shown by this machine's clock.");
        return;
    }
    auto per_slot = rt::refreshes_per_slot(refreshes, s.request.rate_hz);
    if (per_slot) {
        s.display.emplace(refreshes, *per_slot);
        return;
    }
    device.wait_for_flips(false);
    s.notes.push_back(
        fmt::format("screen: {}. Pictures are shown up to a refresh late. {}.", per_slot.error().what, per_slot.error().remedy));
}

/// Of the image cache, 256 KiB each.
constexpr std::uint32_t cache_layers = 256;

/// `others`: cores beside the frame thread's. `called_for`: the model's effects.
Result<EngineOptions> engine_options(const WalkRequest& r, int others, model::EffectMask called_for) {
    const auto backend = gl::backend_named(r.backend);
    if (!backend) return backend.error();
    EngineOptions options;
    options.device.kind = (*backend)->kind;
    options.device.viewport = {r.width, r.height, r.shift_x, r.shift_y};
    options.device.rasterisers = r.rasterisers;
    options.device.samples = r.samples;
    options.device.filter = r.filter == rt::TextureFilter::adaptive ? rt::TextureFilter::automatic : r.filter;
    options.device.second_filter = r.filter == rt::TextureFilter::adaptive;
    options.device.screen = {r.screen, r.mode, r.rotation_deg, r.endless, {}};
    options.device.sky = config::colour_of(r.sky);
    options.device.fullscreen = r.fullscreen;
    const bool may_switch = !r.input_file.empty() || (r.may_steer && r.backend == window_input);
    options.device.switches = switch_groups(r, may_switch || r.buy_effects, called_for);
    options.buys_effects = r.buy_effects;
    options.device.picture_layers = r.cache != rt::ImageCache::off ? cache_layers : 0;
    options.pictures_all_round = r.cache == rt::ImageCache::surround;
    options.motion = r.motion;
    options.effect_hours = effect_hours(r);
    options.device.null.cost_scale = r.cost_scale;
    options.device.null.noise = r.cost_noise;
    options.prepare.workers = r.workers > 0 ? r.workers : std::max(1, others);
    options.prepare.occlusion = r.occlusion;
    options.prepare.gestalt = r.gestalt;
    options.prepare.acuity_rad = config::acuity_rad(r);
    if (const auto seat = config::seat_of(r)) options.prepare.acuity_fov_y_rad = seat->fov_y_rad;
    options.selector = r.selector;
    options.slice_us = r.slice_us;
    options.hysteresis = static_cast<float>(r.hysteresis);
    options.reserve_share = static_cast<float>(r.reserve_pct * 0.01);
    // A cut that stops at an accuracy leaves time, and no other selector buys by value: a softer picture would gain nothing.
    const bool may_choose = r.accuracy == 0 && r.selector == select::usual_selector;
    options.resolution = r.resolution_pct == 0 && !may_choose ? 1.0F : static_cast<float>(r.resolution_pct * 0.01);
    options.max_error_rad = r.min_accuracy > 0 ? 1.0 / r.min_accuracy : 0;
    options.in_frame_check = r.in_frame_check;
    options.benefit = r.benefit;
    options.rest_after_ms = r.rest_after_ms;
    return options;
}

/// Says where the resolution that was asked for is below the least one.
void add_resolution_message(Session& s) {
    const double min_pct = 100.0 * static_cast<double>(model::resolution_steps.back());
    if (s.request.resolution_pct > 0 && s.request.resolution_pct < min_pct)
        s.notes.push_back(
            fmt::format("resolution: {:g} % is below the least. {:g} % is drawn.", s.request.resolution_pct, min_pct));
}

/// Says where there are no pictures of the image cache.
void add_cache_message(Session& s) {
    if (s.request.cache != rt::ImageCache::off && !s.engine->has_pictures())
        s.notes.push_back("cache: There can be no pictures, so that all is drawn as forms. " + s.engine->picture_reason());
}

/// Says where the driver draws another number of samples.
void add_samples_message(Session& s) {
    const std::uint32_t drawn = s.engine->device().samples();
    if (drawn != s.request.samples)
        s.notes.push_back(fmt::format("samples: The driver cannot draw {} a pixel. It draws {}.", s.request.samples, drawn));
}

/// Says what of a picture at rest the driver cannot draw.
void add_rest_message(Session& s) {
    if (!(s.request.rest_after_ms > 0)) return;
    s.engine->device().draws.plays();
    const gl::RestSupport support = s.engine->device().rest_support();
    if (support == gl::RestSupport::none)
        s.notes.emplace_back(
            "rest_after_ms: The driver has no second target for a picture at rest. The last picture of the walk stays.");
    if (support == gl::RestSupport::picture)
        s.notes.emplace_back("rest_after_ms: The driver has no float target. The picture at rest is not smoothed.");
}

Result<void> open_engine(Session& s, const Progress& progress) {
    const WalkRequest& r = s.request;
    notify_step(s, WalkStep::model);
    progress.update("open", 0.1);
    model::WalkFileInfo file;
    auto model = model::read_walk(r.model_file, &file);
    if (!model) return model.error();
    if (!r.given_costs) {
        auto costs = fitted_costs(state_directory(r.state_dir), s.costs, {file.hash, r.width, r.height, r.backend});
        if (!costs) return costs.error();
        s.costs = std::move(*costs);
    }
    if (!s.virtual_clock) s.costs = with_overhead(std::move(s.costs), r.cost_scale);
    if (r.given_path) {
        s.path = {*r.given_path, "parts of a path"};
    } else {
        auto path = choose_path(r.path_file, r.model_file, *model, r.lift_m);
        if (!path) return path.error();
        s.path = std::move(*path);
    }
    apply_seat(r, s.path.path);

    if (s.input && r.walking != rt::WalkingMode::fly) {
        if (model->ground.empty() && model->moving_ground.empty())
            s.notes.push_back(r.model_file +
                              ": The model holds nothing that blocks, so visitors fly. An older model must be baked again.");
        if (std::string warning = path_warning(model->ground, s.path.path); !warning.empty())
            s.notes.push_back(s.path.source + ": " + warning);
    }

    const int others = s.plan.all.count() - (s.plan.all.has(s.plan.frame_core) ? 1 : 0);
    auto options = engine_options(r, others, model->called_for());
    if (!options) return options.error();
    s.plan.workers = options->prepare.workers;
    options->prepare.worker_hooks = s.worker_places.emplace(s.plan).hooks();
    notify_step(s, WalkStep::device);
    progress.update("open", 0.5);
    options->device.screen.on_wait = [&, notified = std::string()](const Error& why, bool held) mutable {
        return wait_for_screen(why, held, r.endless, progress, notified);
    };
    auto engine = Engine::open(std::move(*model), s.costs, *options);
    if (!engine) return engine.error();
    s.engine = std::move(*engine);
    follow_display(s);
    if (const auto refused = s.worker_places->refused())
        s.facts.degraded.push_back({rt::LackKind::placing, "a worker: " + refused->what, refused->remedy});
    s.facts.worker_problems = s.worker_places->problems();
    s.facts.renderer = s.engine->device().renderer();
    s.facts.machine = measure::machine_identity(s.facts.renderer, r.rasterisers);
    if (s.costs.calibrated && options->device.kind != gl::BackendKind::null && s.costs.machine != s.facts.machine) {
        s.facts.uncalibrated = "the cost table was measured on \"" + s.costs.machine + "\", but this is \"" + s.facts.machine +
                               "\". Run `surefoot calibrate` here";
        if (r.strict) {
            notify_step(s, WalkStep::real_time);
            return require_real_time(std::vector<rt::Lack>{{rt::LackKind::cost_table, s.facts.uncalibrated, ""}});
        }
    }
    add_resolution_message(s);
    add_cache_message(s);
    add_samples_message(s);
    add_rest_message(s);
    for (std::size_t i = 0; i < 3; ++i) s.engine->reserve(s.prepared.slot(i));
    if (!r.capture_file.empty() || s.observer.on_missed_frame) s.kept.reserve(*s.engine);
    return {};
}

/// How many frames to walk; 0: until stopped. Where each leaves a record in memory, there is an end to them.
Result<std::uint64_t> frames_wanted(const Session& s) {
    if (s.request.endless) return std::uint64_t{0};
    const double period_s = static_cast<double>(s.grid.period_ns) * 1e-9;
    const bool recorded = s.input && !s.input->live();
    const double own_s = recorded ? s.input->duration_s() : std::max(s.path.path.duration_s(), 1.0);
    const double seconds = s.request.seconds > 0 ? s.request.seconds : own_s;
    const double frames = s.request.control      ? static_cast<double>(s.control.slots())
                          : s.request.frames > 0 ? static_cast<double>(s.request.frames)
                                                 : std::max(1.0, std::round(seconds / period_s));
    if (s.request.keep_records && !(frames <= static_cast<double>(s.request.max_kept_frames))) {
        const bool limited = s.request.frames > 0 || s.request.seconds > 0 || s.request.control;
        return Error{limited    ? "walk"
                     : recorded ? s.request.input_file
                                : s.path.source,
                     fmt::format("The walk takes {:.4g} frames, and at most {} are kept ({:.0f} hours at this rate)", frames,
                                 s.request.max_kept_frames, static_cast<double>(s.request.max_kept_frames) * period_s / 3600.0),
                     "Give a smaller --frames or --seconds", ErrorKind::out_of_limits};
    }
    if (!s.request.capture_file.empty() && static_cast<double>(s.request.capture_frame) >= frames) {
        return Error{fmt::format("--capture-frame {}", s.request.capture_frame),
                     fmt::format("The walk has {:.0f} frames, counted from 0", frames),
                     "Choose one of them, or walk longer with --frames", ErrorKind::misuse};
    }
    return static_cast<std::uint64_t>(frames);
}

}  // namespace

model::CostModel with_overhead(model::CostModel costs, double factor) {
    const auto f = static_cast<float>(factor);
    costs.combine.fixed_us *= f;
    costs.combine.submit_weight *= f;
    costs.combine.raster_weight *= f;
    costs.combine.max_weight *= f;
    for (float* of_passes : {&costs.enlarge_ns_per_pixel, &costs.sample_pass_ns_per_pixel, &costs.rest_pass_ns_per_pixel,
                             &costs.background_ns_per_pixel})
        *of_passes *= f;
    return costs;
}

Session::~Session() {
    window.reset();
    if (engine) {
        {
            const ScopedWorkerPriority at_worker_priority(plan);
            engine->end_workers();
        }
        engine.reset();  // at its own priority: a large model takes longer than a real-time thread may run in one piece
    }
    if (!virtual_clock && rt::guard_active()) rt::release_memory();
}

void notify_step(const Session& s, WalkStep step) {
    if (s.observer.on_step) s.observer.on_step(step);
}

Result<void> open_session(Session& s, const Progress& progress) {
    notify_step(s, WalkStep::request);
    if (auto ok = read_request(s); !ok) return ok;
    if (auto ok = check_outputs(s.request); !ok) return ok;
    if (auto ok = open_input(s); !ok) return ok;
    if (auto ok = claim(s); !ok) return ok;
    if (auto ok = open_engine(s, progress); !ok) return ok;
    s.control = rt::control_schedule(s.grid.period_ns, s.request.control_block_s, s.request.control_pairs);
    auto frames = frames_wanted(s);
    if (!frames) return frames.error();
    s.frames = *frames;
    const WalkRequest& r = s.request;
    s.may_be_prolonged = window_steers(r) && r.input_file != live_input && r.frames == 0 && r.seconds == 0 && !r.endless;
    s.prolonged.store(s.may_be_prolonged && r.input_file == window_input);
    return {};
}

void open_window_thread(Session& s) {
    auto window = s.engine->device().window();
    if (!window) return;
    const WindowThreadOptions options{s.input ? s.input->window_feed() : nullptr, s.request.may_leave,
                                      s.input ? s.input->window_stop_keys() : 0};
    rt::Placement placement = window_placement(s.plan);
    if (s.virtual_clock) placement = {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = placement.name};
    s.window = std::make_unique<WindowThread>(std::move(window), options, placement);
    if (const auto& refused = s.window->misplaced())
        s.facts.degraded.push_back({rt::LackKind::placing, refused->what, refused->remedy});
}

namespace {

void prepare_at_worker_priority(Session& s, const prepare::Region& region, prepare::PreparedFrame& out,
                                const PrepareHints& hints = {}) {
    const ScopedWorkerPriority at_worker_priority(s.plan);
    s.engine->prepare(region, 0, 0, 0, out, hints);
}

/// What a frame may take before any has been drawn: by the cost table alone.
PrepareHints first_hints(const Session& s) {
    const double period_us = static_cast<double>(s.grid.period_ns) * 1e-3;
    const double asked_us = s.request.budget_ms > 0 ? 1e3 * s.request.budget_ms : frame_share * period_us;
    const double budget_us = s.request.in_frame_check ? std::min(asked_us, frame_share * period_us) : asked_us;
    PrepareHints hints;
    hints.planned_us.fill(budget_us / static_cast<double>(s.engine->costs().headroom));
    hints.span_s = span_s(1e-6 * period_us);
    return hints;
}

}  // namespace

void warm_up(Session& s) {
    Engine& engine = *s.engine;
    engine.device().bind();
    SubmitLimits limits;
    limits.limit_us = 1e9;
    const double period_us = static_cast<double>(s.grid.period_ns) * 1e-3;
    for (int i = 0; i < 12; ++i) {
        const Pose pose = pose_at(s.path.path, i * s.path.path.duration_s() / 12.0);
        prepare::PreparedFrame& set = s.prepared.slot(0);
        prepare_at_worker_priority(s, {pose, 0.1, 0.05}, set);
        engine.select(set, frame_share * period_us, {}, 0);
        engine.submit(pose, limits);
        engine.select_last();
        engine.submit(pose, limits);
        engine.submit(pose, {});  // no time: its stand-ins
    }
    engine.device().release();
    // Ready for the first frame: a complete set for where the path begins, at a resolution that was compared with all others.
    const double period_s = period_us * 1e-6;
    const FramePose first = PathPoses(s.path.path, s.grid.period_ns, engine.options().device.viewport).sample({});
    prepare::Region region = predict_region(first.before, first.pose, period_s, horizon_s(period_s));
    region.radius_m = std::max(region.radius_m, 0.5);
    region.angle_rad = std::max(region.angle_rad, 0.2);
    const PrepareHints hints = first_hints(s);
    const std::size_t sets = engine.options().resolution > 0 ? 1 : model::resolution_steps.size();
    for (std::size_t i = 0; i < sets; ++i) prepare_at_worker_priority(s, region, s.prepared.back(), hints);
    s.prepared.publish();
}

}  // namespace surefoot::walk
