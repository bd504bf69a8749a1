// Opening, recalling, telling.
#include "tools/walk/live_input.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "tools/walk/settings_request.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::walk {

void notify(const Progress& progress, std::vector<std::string>& notes, std::string text) {
    if (progress.notify)
        progress.notify(text);
    else
        notes.push_back(std::move(text));
}

namespace {

/// The folder is there, and the file can be written: else a stop would be forgotten, and nobody would know.
Result<void> check_memory(const std::string& file, bool latched) {
    std::error_code problem;
    std::filesystem::create_directories(std::filesystem::path(file).parent_path(), problem);
    auto stored = input::store_stop(file, latched);
    if (stored) return stored;
    return Error{stored.error().place, "The emergency stop cannot be stored. " + stored.error().what,
                 "Name a folder that can be written with --state DIR", ErrorKind::unwritable};
}

}  // namespace

bool may_latch_stop(const WalkRequest& request) {
    if (request.input_file == live_input) return true;
    if (!window_steers(request) || request.steering_file.empty()) return false;
    const auto steering = input::read_steering(request.steering_file);
    return !steering || input::has_stop(*steering);
}

Result<LiveInput> LiveInput::open(const WalkRequest& request, const input::SteeringFile& steering,
                                  std::shared_ptr<input::WindowFeed> window, std::vector<std::string>& notes) {
    LiveInput live;
    if (input::has_stop(steering)) {
        const std::string file = stop_file(state_directory(request.state_dir));
        const input::RememberedStop remembered = input::load_stop(file);
        if (!remembered.note.empty()) notes.push_back(remembered.note);
        live.stop_latched_ = remembered.latched && !request.clear_stop;
        if (auto ok = check_memory(file, live.stop_latched_); !ok) return ok.error();
        live.keeper_ = std::make_unique<input::StopKeeper>(file, live.stop_latched_);
        if (live.stop_latched_)
            notes.push_back(
                file +
                ": The emergency stop of an earlier walk is still latched. Press the control for `stop_reset`, or start "
                "with --clear-stop.");
        else if (remembered.latched)
            notes.push_back(file + ": The emergency stop of an earlier walk is released by --clear-stop.");
    } else if (request.clear_stop) {
        return Error{"--clear-stop", "This option releases a latched stop, and no control can stop this walk",
                     "Name a stop in the --steering file, or remove --clear-stop", ErrorKind::misuse};
    }
    input::LiveOptions options;
    options.mappings = steering.devices;
    options.lines = steering.lines;
    options.devices = request.input_file == live_input;
    options.window = std::move(window);
    options.window_deg_per_px = request.pointer_turn_deg;
    auto source = input::LiveSource::open(std::move(options));
    if (!source) return source.error();
    live.source_ = std::move(*source);
    live.live_ = live.source_.get();
    return live;
}

void LiveInput::poll_live(const Progress& progress, std::vector<std::string>& notes) {
    for (input::MessageLine message; live_->next_message(message);) notify(progress, notes, std::string(message.view()));
    if (!keeper_) return;
    if (const bool latched = keeper_->latched(); latched != stop_latched_) {
        stop_latched_ = latched;
        notify(progress, notes,
               latched ? "Emergency stop: the walk stands still until the control for `stop_reset` is pressed."
                       : "Emergency stop: released.");
    }
    const auto written = keeper_->flush();
    const std::string why = written ? std::string() : written.error().text();
    if (why != unwritten_ && !why.empty()) notify(progress, notes, "The emergency stop cannot be stored. " + why);
    unwritten_ = why;
}

void LiveInput::finish(bool latched, const Progress& progress, std::vector<std::string>& notes) {
    if (keeper_) keeper_->set(latched);
    poll_live(progress, notes);
    if (live_->lost_messages() > 0)
        notify(progress, notes,
               fmt::format("{} more messages about devices came too fast and are not shown.", live_->lost_messages()));
}

}  // namespace surefoot::walk
