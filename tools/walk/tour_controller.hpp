// Acts on the visitor's buttons: next viewpoint, reset, tour and pause.
//
//   steered ──tour──► touring (follows the path from where the tour was left) ──the hand moves, or a stop──► steered
//   pause: stands still until pressed again; the other three go on from a pause. A stop lets nothing through but pause.
#pragma once

#include <cstdint>
#include <vector>

#include "input/steering.hpp"
#include "rt/base/path.hpp"

namespace surefoot::walk {

constexpr int viewpoint_count = 8;  ///< along the path, at equal times

/// The pose at a time: the path forth and back again for as long as the walk lasts (a jump back would be a teleport).
Pose pose_at(const Path& path, double time_s);

/// Follows the buttons: next viewpoint, reset, tour and pause.
class TourController {
public:
    /// Starts where the path does. The path must outlive this.
    explicit TourController(const Path& path);

    [[nodiscard]] const Pose& start() const { return viewpoints_.front(); }
    /// Tours from the start, from `start_ns` on, until the hand moves. Before the first step.
    void begin_tour(std::int64_t start_ns) {
        touring_ = true;
        last_ns_ = start_ns_ = start_ns;
    }
    /// Call it after every tick of `steering`, on its thread. Moves the eye where a button demands it, and puts the result into
    /// `sample` for the frame thread. Edges are taken from the tick, so none is lost and none is taken twice.
    void follow(input::NavigationSample& sample, input::Steering& steering, std::int64_t now_ns) REQUIRES(steering.steers);

    /// Still on the tour that began with the walk: the pose is the path's at the walk's time.
    [[nodiscard]] bool on_schedule() const { return start_ns_ >= 0; }
    [[nodiscard]] bool touring() const { return touring_; }
    [[nodiscard]] bool paused() const { return paused_; }
    /// How often the eye was put elsewhere without walking there.
    [[nodiscard]] std::uint32_t jumps() const { return jumps_; }

private:
    void press_buttons(input::NavigationSample& sample, input::Steering& steering) REQUIRES(steering.steers);
    /// zooms: as of Steering::place().
    void put(const Pose& pose, input::NavigationSample& sample, input::Steering& steering, bool zooms = false)
        REQUIRES(steering.steers);
    void tour(input::NavigationSample& sample, input::Steering& steering, double to_s) REQUIRES(steering.steers);

    const Path& path_;
    std::vector<Pose> viewpoints_;
    std::size_t viewpoint_ = 0;
    double tour_s_ = 0;
    bool touring_ = false, paused_ = false;
    bool hand_rested_ = false;  ///< since the tour began: a hand that held on while it was pressed does not end it
    std::uint32_t jumps_ = 0;
    std::int64_t last_ns_ = -1;
    std::int64_t start_ns_ = -1;  ///< of the tour that began with the walk; -1: there is none, or it was left
    Pose last_;
};

}  // namespace surefoot::walk
