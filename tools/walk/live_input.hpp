// Live devices for a session: the source, the stored emergency stop, and the messages of both.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "input/live_source.hpp"
#include "input/map/steering_file.hpp"
#include "input/safety/stop_memory.hpp"
#include "rt/base/progress.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Shows the user a message at once, or adds it to `notes` where nobody listens.
void notify(const Progress& progress, std::vector<std::string>& notes, std::string text);

/// Whether an emergency stop may latch. With `input = devices` it always may. A window alone needs a steering file that names a
/// stop, or cannot be read.
bool may_latch_stop(const WalkRequest& request);

/// Live devices of a walk, with their messages and the stored stop.
class LiveInput {
public:
    /// Starts to look for devices, and loads the stored stop if one is configured. Errors: no udev; a state folder in which
    /// the stop cannot be stored. `notes`: messages for the user.
    /// `window`: of its keyboard and mouse, if they steer.
    static Result<LiveInput> open(const WalkRequest& request, const input::SteeringFile& steering,
                                  std::shared_ptr<input::WindowFeed> window, std::vector<std::string>& notes);

    [[nodiscard]] bool stop_latched() const { return stop_latched_; }
    [[nodiscard]] int steering_now() const { return live_->steering_now(); }
    /// Once, for the stepper; it stays valid while the source lives.
    [[nodiscard]] std::unique_ptr<input::ReportSource> take_source() { return std::move(source_); }
    /// Null if no control can latch a stop.
    [[nodiscard]] input::StopKeeper* keeper() { return keeper_.get(); }

    /// Call every few milliseconds from a thread that may wait: stores the stop, and passes on messages.
    void poll_live(const Progress& progress, std::vector<std::string>& notes);
    /// After the input thread's end: the last messages. Returns whether the stop is latched.
    void finish(bool latched, const Progress& progress, std::vector<std::string>& notes);

private:
    LiveInput() = default;
    std::unique_ptr<input::LiveSource> source_;
    input::LiveSource* live_ = nullptr;
    std::unique_ptr<input::StopKeeper> keeper_;
    std::string unwritten_;      ///< the last reported reason why the stop cannot be stored
    bool stop_latched_ = false;  ///< as last reported
};

}  // namespace surefoot::walk
