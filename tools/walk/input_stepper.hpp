// One step of the input: read waiting reports, steer, act on buttons, publish. Real time runs it on a thread of its own
// (input_thread.hpp); the virtual clock runs it inline up to each frame's start. Both run this body.
//
//   ReportSource ─drain─► Steering ─tick─► TourController ─follow─► SteeredSample ─► triple buffer ─► steered_poses.hpp
#pragma once

#include <atomic>
#include <cstdint>

#include "input/report_source.hpp"
#include "input/safety/stop_memory.hpp"
#include "input/steering.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "tools/walk/prepare_thread.hpp"
#include "tools/walk/tour_controller.hpp"
#include "tools/walk/walking.hpp"

namespace surefoot::walk {

/// Longest time between two steps. Every report causes a step. Without reports, steps go on for filters and limits.
constexpr std::int64_t input_tick_ns = 2'000'000;

/// What the frame thread reads, newest wins.
struct SteeredSample {
    input::NavigationSample nav;
    std::int64_t time_ns = 0;   ///< of the step: nav.pose is the pose then
    std::uint64_t reports = 0;  ///< accepted, up to and with this sample
    std::uint32_t jumps = 0;    ///< of the tour controller and of the walker
    bool touring = false;
    bool on_schedule = false;  ///< nobody has left the path since the walk began
    bool on_foot = false;      ///< a step of a walker led to nav.pose, with its feet at `feet`
    dvec3 feet{0.0};
    bool walking = false;                            ///< else the eye flies
    model::Barrier barrier = model::Barrier::clear;  ///< what stops the walker
};

/// One step of the input: drains the source, steps the walker, publishes the sample. One thread calls all members.
class InputStepper {
public:
    /// All of them must outlive this; `steering` is placed at the tour's start.
    /// `keeper`, if given, is notified at each step whether an emergency stop is latched.
    /// `jump_poses` is notified of jumps: poses that the eye does not walk to.
    InputStepper(input::ReportSource& source, input::Steering& steering, TourController& tour_controller, Walking& walking,
                 rt::TripleBuffer<SteeredSample>& samples, JumpBuffer& jump_poses, input::StopKeeper* keeper = nullptr);

    /// Publishes the start, and attaches connected devices. On a neutral thread, before the first step; allocates.
    void begin(std::int64_t start_ns);
    /// When the next step is due at the latest.
    [[nodiscard]] std::int64_t next_ns() const;
    /// Sleeps until then, or until something can be read.
    void wait(rt::Clock& clock) { source_.wait(clock, next_ns()); }
    /// One step at `now_ns`; does not allocate, lock or read a clock.
    void step(std::int64_t now_ns);
    /// Every step that is due by `now_ns`, each at its own time: the same whenever it is called (virtual clock).
    void advance_to(std::int64_t now_ns);
    /// For any thread: when the walk's time would have been 0, as of the newest frame. Pictures and steps show what moves as it
    /// is at that time. Frames know it best: a display moves the grid, and a control stops the walk for a while.
    void set_zero(std::int64_t zero_ns) { zero_ns_.store(zero_ns, std::memory_order_relaxed); }
    /// For any thread: whether a report has come, or nobody is led along the path, as of the last step.
    [[nodiscard]] bool shown_used() const { return shown_used_.load(std::memory_order_relaxed); }

private:
    void publish(const input::NavigationSample& sample, std::int64_t now_ns);

    input::ReportSource& source_;
    input::Steering& steering_;
    TourController& tour_controller_;
    Walking& walking_;
    rt::TripleBuffer<SteeredSample>& samples_;
    JumpBuffer& jump_poses_;
    input::StopKeeper* keeper_;
    std::uint32_t jumps_reported_ = 0;
    std::int64_t tick_at_ns_ = 0;
    std::atomic<std::int64_t> zero_ns_{0};
    std::atomic<bool> shown_used_{false};
};

}  // namespace surefoot::walk
