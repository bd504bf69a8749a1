// Live devices for a session: the source, the emergency stop's memory, and what both have to tell the user.
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

class LiveInput {
public:
    /// Looks for devices from now on, and recalls the stop where one is configured. Errors: no udev; a state folder in which
    /// the stop cannot be remembered. `notes`: what else the user should know.
    static Result<LiveInput> open(const WalkRequest& request, const input::SteeringFile& steering,
                                  std::vector<std::string>& notes);

    [[nodiscard]] bool stop_latched() const { return stop_latched_; }
    [[nodiscard]] int steering_now() const { return live_->steering_now(); }
    /// Once, for the stepper; it stays valid while the source lives.
    [[nodiscard]] std::unique_ptr<input::ReportSource> take_source() { return std::move(source_); }
    /// Null where nothing can stop for good.
    [[nodiscard]] input::StopKeeper* keeper() { return keeper_.get(); }

    /// Every few milliseconds from a thread that may wait: writes the stop's memory, and says what there is to say.
    void attend(const Progress& progress, std::vector<std::string>& notes);
    /// After the input thread's end: the last of it. How the stop was left.
    void finish(bool latched, const Progress& progress, std::vector<std::string>& notes);

private:
    LiveInput() = default;
    std::unique_ptr<input::LiveSource> source_;
    input::LiveSource* live_ = nullptr;
    std::unique_ptr<input::StopKeeper> keeper_;
    std::string unwritten_;      ///< why the stop could not be written, as it was said
    bool stop_latched_ = false;  ///< as it was said last
};

}  // namespace surefoot::walk
