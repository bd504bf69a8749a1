// Where the moving nodes of a model are at a time: their boxes, and views of them as if they stood at rest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/pixels.hpp"

namespace surefoot::model {

/// A moving node over a span of time. What is computed at rest from the eye moved back holds for what is drawn.
struct MovingNode {
    Box rest;                 ///< world
    RigidPose pose;           ///< in the middle of the span
    double drift_m = 0;       ///< no point is farther from there within the span
    double speed_mps = 0;     ///< of the fastest point, in the mean of the span
    bool everywhere = false;  ///< it may jump within the span: only Node::box holds it
    /// The world's box of the node within the span.
    [[nodiscard]] Box box() const;
};

/// The poses of all motions at one time, for one thread: each is worked out once, at its first use. After it is made, nothing
/// allocates.
class MotionPoses {
public:
    MotionPoses() = default;
    /// The model must outlive it.
    explicit MotionPoses(const Model& model);
    /// Takes the same time whatever moves.
    void set_time(double time_s);
    /// pose_at() of a motion, bit for bit; not of none.
    [[nodiscard]] const RigidPose& at(Index motion);

private:
    const Model* model_ = nullptr;
    double time_s_ = 0;
    std::uint64_t moment_ = 1;           // grows with each time
    std::vector<RigidPose> poses_;       // by motion
    std::vector<std::uint64_t> worked_;  // moment of each pose
};

/// The moving nodes. After it is made, nothing allocates. Empty and free of cost where all stands still. Any thread may ask,
/// while none sets the span.
class MovingNodes {
public:
    MovingNodes() = default;
    /// Passes over the full detail of all that moves. The model must outlive it.
    explicit MovingNodes(const Model& model);

    [[nodiscard]] bool any() const { return !slot_of_node_.empty(); }
    /// From one time to a later one; no later than that: one moment. What is no number is 0.
    void set_span(double from_s, double to_s);
    /// Nothing: the node stands still. Takes a microsecond.
    [[nodiscard]] std::optional<MovingNode> find(Index node) const;
    /// Contains the node within the span; Node::box where it stands still.
    [[nodiscard]] Box box(Index node) const;
    /// At the time of the poses, whatever the span: no drift, and no speed is worked out.
    [[nodiscard]] std::optional<MovingNode> find(Index node, MotionPoses& now) const;
    [[nodiscard]] Box box(Index node, MotionPoses& now) const;
    /// All nodes that move though their parents do not.
    [[nodiscard]] const std::vector<Index>& roots() const { return roots_; }

private:
    [[nodiscard]] MovingNode placed(Index node) const;
    /// A node that moves, and its limits over all times.
    struct Slot {
        Box rest;
        Index motion = none;
        double max_speed_mps = 0;
        bool jumps = false;
    };

    const Model* model_ = nullptr;
    std::vector<Index> slot_of_node_;  ///< by node; empty where all stands still
    std::vector<Slot> slots_;
    std::vector<Index> roots_;
    double from_s_ = 0, to_s_ = 0;
};

/// The view as a thing in that pose has it: turned back about the eye.
ViewScale turned_back(const ViewScale& scale, const RigidPose& pose);

}  // namespace surefoot::model
