// The input of a walk, a recording or live devices: opened at the start, run on the input thread, summed up at the end.
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
#include "tools/walk/region_clip.hpp"
#include "tools/walk/steered_poses.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// How long a walk goes on after the end of its recording: enough for the eye to come to rest.
constexpr double after_recording_s = 1.0;

/// The input of one walk. The session's main thread calls all members, except those of poses() and jump_poses().
class InputSession {  // NOLINT(clang-analyzer-optin.performance.Padding): members stand by what they are for
public:
    /// Reads the steering file, then the recording; without a recording, starts to look for devices. Errors name file and line.
    /// Adds warnings for the user to `notes`.
    static Result<std::unique_ptr<InputSession>> open(const WalkRequest& request, std::int64_t period_ns,
                                                      std::vector<std::string>& notes);

    /// Length of the walk by this input; 0: the input sets none.
    [[nodiscard]] double duration_s() const { return duration_s_; }

    /// The walk's time begins at start_ns, at the start of `path`, which must outlive this. real_clock: starts the thread.
    /// A visitor walks on `ground`. `path_poses` are those of the walk if nobody steers. Both must outlive this too.
    void begin(const Path& path, const model::Ground& ground, std::int64_t start_ns, bool real_clock,
               const rt::Placement& placement, PathPoses* path_poses = nullptr);
    /// The same on the ground of a model, of which something may move; the model must outlive this.
    void begin(const Path& path, const model::Model& model, std::int64_t start_ns, bool real_clock,
               const rt::Placement& placement, PathPoses* path_poses = nullptr);
    /// For the frame thread; after begin().
    [[nodiscard]] PoseSource& poses() { return *poses_; }
    /// For the prepare thread: poses that the eye jumps to by a button.
    [[nodiscard]] JumpBuffer* jump_poses() { return &jump_poses_; }
    /// For the thread that prepares; null where nobody can walk. After begin().
    [[nodiscard]] RegionClip* clip() { return clip_ ? &*clip_ : nullptr; }
    /// Call it every few milliseconds during the walk, from a thread that may wait. Reports what devices do, stores an emergency
    /// stop, and tells once that a visitor was put out of something solid.
    void poll(const Progress& progress, std::vector<std::string>& notes);
    [[nodiscard]] bool live() const { return live_.has_value(); }
    /// Where the window's keyboard and mouse are to be pushed to; null where they do not steer.
    [[nodiscard]] const std::shared_ptr<input::WindowFeed>& window_feed() const { return window_feed_; }
    /// The keys that stop: see input::WindowReports.
    [[nodiscard]] std::uint64_t window_stop_keys() const { return window_stop_keys_; }
    /// As of the last step: somebody pressed or moved something. After begin().
    [[nodiscard]] bool used() const { return stepper_ && stepper_->shown_used(); }
    /// Devices as of the last poll(); what stops the walker as of the last step.
    [[nodiscard]] rt::InputState now() const;
    /// Ends the input thread. Returns the error if the thread could not be placed.
    std::optional<Error> end(const Progress& progress, std::vector<std::string>& notes);

    /// After end().
    [[nodiscard]] report::InputSummary summary(std::span<const rt::FrameRecord> records) const;

private:
    InputSession() = default;
    void begin_walking(const Path& path, const model::Ground& ground, std::int64_t start_ns, bool real_clock,
                       const rt::Placement& placement, PathPoses* path_poses);

    std::string source_name_;
    std::optional<LiveInput> live_;
    std::shared_ptr<input::WindowFeed> window_feed_;
    std::uint64_t window_stop_keys_ = 0;
    bool begins_touring_ = false;  ///< the path is followed until a hand moves
    double duration_s_ = 0;
    std::int64_t period_ns_ = 0;
    input::MotionLimits motion_;
    std::unique_ptr<input::ReportSource> source_;
    std::unique_ptr<input::Steering> steering_;
    rt::TripleBuffer<SteeredSample> samples_;
    JumpBuffer jump_poses_;
    rt::WalkingMode mode_ = rt::WalkingMode::automatic;
    bool still_ = false;  // nothing moves by itself
    model::Body body_;
    std::unique_ptr<Walking> walking_;
    std::optional<RegionClip> clip_;
    std::unique_ptr<TourController> tour_controller_;
    std::unique_ptr<InputStepper> stepper_;
    std::unique_ptr<SteeredPoses> poses_;
    std::unique_ptr<InputThread> thread_;
    std::uint64_t guard_violations_ = 0;
    bool freed_told_ = false;
};

/// Ages of reports, ms: from a report's stamp until the first frame whose pose includes it was submitted. Pure. stamps_ns[i] is
/// that of report i + 1. Reports that no frame includes, because they came after the last one, are left out.
std::vector<double> report_ages_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns);
/// The same until it was shown; nothing of frames that were not.
std::vector<double> reports_to_shown_ms(std::span<const rt::FrameRecord> records, std::span<const std::int64_t> stamps_ns);

}  // namespace surefoot::walk
