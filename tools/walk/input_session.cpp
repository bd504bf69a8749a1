// Opening, wiring, summing up.
#include "tools/walk/input_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "input/replay/replay_source.hpp"
#include "rt/base/text.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::walk {

namespace {

void warn_of_ignored_input(const input::SteeringFile& steering, const input::RecordedDevice& recorded, const WalkRequest& request,
                           std::vector<std::string>& notes) {
    if (!steering.lines.empty()) {
        notes.push_back(fmt::format("{}: Its {} GPIO lines are not read, because a recording steers.", request.steering_file,
                                    steering.lines.size()));
    }
    if (recorded.recording.other_devices > 0) {
        notes.push_back(fmt::format("{}: {} reports of other devices are ignored, because only one device steers.",
                                    request.input_file, recorded.recording.other_devices));
    }
    for (const std::string& left_out : recorded.mapper.messages) notes.push_back(request.input_file + ": " + left_out);
}

}  // namespace

Result<std::unique_ptr<InputSession>> InputSession::open(const WalkRequest& request, std::int64_t period_ns,
                                                         std::vector<std::string>& notes) {
    input::SteeringFile steering;
    if (!request.steering_file.empty()) {
        auto read = input::read_steering(request.steering_file);
        if (!read) return read.error();
        steering = std::move(*read);
    }
    std::unique_ptr<InputSession> session(new InputSession());
    session->source_name_ = request.input_file;
    session->period_ns_ = period_ns;
    session->mode_ = request.walking;
    session->still_ = !request.motion;
    session->body_ = {request.eye_height_m, request.body_radius_m, request.step_height_m,
                      request.max_slope_deg * std::numbers::pi / 180, request.edge_m};
    session->motion_ = steering.motion;
    session->motion_.frame_s = static_cast<double>(period_ns) * 1e-9;
    if (window_steers(request)) {
        session->window_feed_ = std::make_shared<input::WindowFeed>();
        session->window_stop_keys_ = input::stop_keys(input::window_mapping(steering.devices, request.pointer_turn_deg));
    }
    if (is_steered_live(request)) {
        session->begins_touring_ = request.input_file.empty();
        if (request.input_file.empty()) session->source_name_ = window_input;
        auto live = LiveInput::open(request, steering, session->window_feed_, notes);
        if (!live) return live.error();
        session->live_.emplace(std::move(*live));
        session->source_ = session->live_->take_source();
        session->steering_ = std::make_unique<input::Steering>(session->motion_, steering.safety, session->live_->stop_latched());
        return session;
    }
    auto recorded = input::open_recorded(request.input_file, steering, request.steering_file);
    if (!recorded) return recorded.error();
    warn_of_ignored_input(steering, *recorded, request, notes);
    session->duration_s_ = recorded->duration_s() + after_recording_s;
    session->source_ = std::make_unique<input::ReplaySource>(std::move(*recorded));
    session->steering_ = std::make_unique<input::Steering>(session->motion_, steering.safety);
    return session;
}

void InputSession::begin(const Path& path, const model::Ground& ground, std::int64_t start_ns, bool real_clock,
                         const rt::Placement& placement, PathPoses* path_poses) {
    walking_ = std::make_unique<Walking>(ground, body_, mode_);
    begin_walking(path, ground, start_ns, real_clock, placement, path_poses);
}

void InputSession::begin(const Path& path, const model::Model& model, std::int64_t start_ns, bool real_clock,
                         const rt::Placement& placement, PathPoses* path_poses) {
    walking_ = std::make_unique<Walking>(model.ground, body_, mode_, &model);
    if (still_) walking_->hold_still();
    begin_walking(path, model.ground, start_ns, real_clock, placement, path_poses);
}

void InputSession::begin_walking(const Path& path, const model::Ground& ground, std::int64_t start_ns, bool real_clock,
                                 const rt::Placement& placement, PathPoses* path_poses) {
    tour_controller_ = std::make_unique<TourController>(path);
    if (begins_touring_) tour_controller_->begin_tour(start_ns);
    stepper_ = std::make_unique<InputStepper>(*source_, *steering_, *tour_controller_, *walking_, samples_, jump_poses_,
                                              live_ ? live_->keeper() : nullptr);
    if (walking_->walker() != nullptr) clip_.emplace(ground, body_);
    poses_ = std::make_unique<SteeredPoses>(samples_, motion_, period_ns_, real_clock ? nullptr : stepper_.get(), path_poses,
                                            stepper_.get());
    stepper_->begin(start_ns);
    if (real_clock) thread_ = std::make_unique<InputThread>(*stepper_, placement);
}

void InputSession::poll(const Progress& progress, std::vector<std::string>& notes) {
    if (live_) live_->poll_live(progress, notes);
    if (freed_told_ || !walking_ || !walking_->shown_freed()) return;
    freed_told_ = true;
    notify(progress, notes,
           "The visitor was inside something solid, or could get no further, and was put to a free place. This is told once; "
           "`--json` counts it as `freed`.");
}

rt::InputState InputSession::now() const {
    rt::InputState state;
    if (live_) state = {true, live_->steering_now(), live_->stop_latched(), false, {}, {}};
    if (!walking_) return state;
    state.walking = walking_->shown_walks();
    const model::Barrier barrier = walking_->shown_barrier();
    if (barrier == model::Barrier::clear) return state;
    state.barrier = model::barriers[static_cast<std::size_t>(barrier)].name;
    state.barrier_help = model::barriers[static_cast<std::size_t>(barrier)].help;
    return state;
}

std::optional<Error> InputSession::end(const Progress& progress, std::vector<std::string>& notes) {
    if (!thread_) {
        poll(progress, notes);
        return {};
    }
    thread_->stop();
    guard_violations_ = thread_->guard_violations();
    steering_->steers.plays();  // its thread has ended
    if (live_) live_->finish(steering_->safety().latched, progress, notes);
    poll(progress, notes);
    return thread_->misplaced();
}

report::InputSummary InputSession::summary(std::span<const rt::FrameRecord> records) const {
    steering_->steers.plays();  // its thread has ended
    report::InputSummary s;
    s.given = true;
    s.source = source_name_;
    for (const rt::SteeringDevice& d : source_->devices())
        s.devices.push_back({printable(d.name), d.device_class, printable(d.mapping)});
    s.reports = source_->log().count();
    s.refused = source_->refused();
    s.illegal_encoder_steps = source_->illegal_encoder_steps();
    const std::vector<double> ages = report_ages_ms(records, source_->log().stamps());
    // Of a long live walk the first reports' ages are kept, not all.
    s.reports_shown = records.empty() ? 0 : std::max<std::uint64_t>(ages.size(), records.back().input_reports);
    s.age_ms = quantiles(ages);
    s.to_shown_ms = quantiles(reports_to_shown_ms(records, source_->log().stamps()));
    const input::SafetyState& safety = steering_->safety();
    s.stops = safety.stops;
    s.stop_latched = safety.latched;
    s.timeouts = safety.timeouts;
    s.overflows = safety.overflows;
    s.losses = safety.losses;
    for (const rt::FrameRecord& r : records) s.stopped_frames += r.stopped ? 1 : 0;
    const input::PressCounts& presses = steering_->motion().presses;
    s.next_viewpoint = presses.next_viewpoint;
    s.reset = presses.reset;
    s.tour = presses.tour;
    s.pause = presses.pause;
    s.switches = presses.light;
    s.jumps = tour_controller_->jumps() + walking_->jumps();
    if (const model::Walker* walker = walking_->walker()) {
        s.walked = walking_->walked();
        s.returns = walker->returns();
        s.freed = walker->freed();
        s.put_aside = walker->put_aside();
        s.passed_through = walker->passed_through();
    }
    s.filter_lag_ms = steering_->worst_lag_s() * 1e3;
    s.guard_violations = guard_violations_;
    return s;
}

namespace {

/// From each report's stamp to that time of the first frame that holds it; of frames where it is 0, none.
std::vector<double> until_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns,
                             std::int64_t rt::FrameRecord::*time_ns) {
    std::vector<double> times;
    std::size_t seen = 0;
    for (const rt::FrameRecord& r : records) {
        const std::size_t until = std::min<std::size_t>(r.input_reports, stamps_ns.size());
        for (; seen < until; ++seen)
            if (r.*time_ns != 0) times.push_back(static_cast<double>(r.*time_ns - stamps_ns[seen]) * 1e-6);
    }
    return times;
}

}  // namespace

std::vector<double> report_ages_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns) {
    return until_ms(records, stamps_ns, &rt::FrameRecord::submitted_ns);
}

std::vector<double> reports_to_shown_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns) {
    return until_ms(records, stamps_ns, &rt::FrameRecord::shown_ns);
}

}  // namespace surefoot::walk
