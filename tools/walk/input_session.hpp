// What steers a walk: opened and checked at the start, wired to its thread, and summed up at the end.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "input/map/steering_file.hpp"
#include "input/report_source.hpp"
#include "rt/frame/record.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/input_stepper.hpp"
#include "tools/walk/input_thread.hpp"
#include "tools/walk/live_input.hpp"
#include "tools/walk/steered_poses.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// How long a walk goes on after its recording has ended: the visitor comes to rest, and is seen to.
constexpr double after_recording_s = 1.0;

/// The source is a recording, or live devices.
class InputSession {
public:
    /// Reads the steering file and the recording, or looks for devices from now on; errors name file and line. `notes`: what else
    /// the user should know.
    static Result<std::unique_ptr<InputSession>> open(const WalkRequest& request, std::int64_t period_ns,
                                                      std::vector<std::string>& notes);

    /// Length of the walk by this input; 0: the input sets none.
    [[nodiscard]] double duration_s() const { return duration_s_; }

    /// The walk's time begins at start_ns, at the start of `path`, which must outlive this. real_clock: starts the thread.
    void begin(const Path& path, std::int64_t start_ns, bool real_clock, const rt::Placement& placement);
    /// For the frame thread; after begin().
    [[nodiscard]] PoseSource& poses() { return *poses_; }
    /// For the prepare thread: poses that the eye jumps to by a button.
    [[nodiscard]] JumpBuffer* jump_poses() { return &jump_poses_; }
    /// Live: call it every few milliseconds during the walk. Reports what devices do, and stores an emergency stop.
    void poll_live(const Progress& progress, std::vector<std::string>& notes) {
        if (live_) live_->poll_live(progress, notes);
    }
    [[nodiscard]] bool live() const { return live_.has_value(); }
    /// As of the last poll_live().
    [[nodiscard]] rt::InputState now() const {
        return live_ ? rt::InputState{true, live_->steering_now(), live_->stop_latched()} : rt::InputState{};
    }
    /// The thread ends. What kept it from its place, if anything did.
    std::optional<Error> end(const Progress& progress, std::vector<std::string>& notes);

    /// After end().
    [[nodiscard]] report::InputSummary summary(std::span<const rt::FrameRecord> records) const;

private:
    InputSession() = default;

    std::string source_name_;
    std::optional<LiveInput> live_;
    double duration_s_ = 0;
    std::int64_t period_ns_ = 0;
    input::MotionLimits motion_;
    std::unique_ptr<input::ReportSource> source_;
    std::unique_ptr<input::Steering> steering_;
    rt::TripleBuffer<SteeredSample> samples_;
    JumpBuffer jump_poses_;
    std::unique_ptr<TourController> tour_controller_;
    std::unique_ptr<InputStepper> stepper_;
    std::unique_ptr<SteeredPoses> poses_;
    std::unique_ptr<InputThread> thread_;
    std::uint64_t guard_violations_ = 0;
};

/// Pure: of every report that a frame's pose holds, from its stamp until the first such frame was submitted; ms. stamps[i] is the
/// (i+1)th report's. Reports that no frame holds (they came after the last one) are not in it.
std::vector<double> report_ages_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns);

}  // namespace surefoot::walk
