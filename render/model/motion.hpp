// Rigid motions that loop: what a moving placement does at any time, and bounds over all times.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/effects.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::model {

struct Model;
struct Node;
struct Placement;
struct Representation;

/// Where a rigid thing is, relative to its rest: x -> pivot + translation + rotation * (x - pivot), in world coordinates.
struct RigidPose {
    dvec3 pivot{0.0};
    dvec3 translation{0.0};
    dquat rotation{1.0, 0.0, 0.0, 0.0};  // w, x, y, z

    [[nodiscard]] dvec3 operator()(const dvec3& x) const { return pivot + translation + rotation * (x - pivot); }
    /// The point at rest that is at x now.
    [[nodiscard]] dvec3 back(const dvec3& x) const { return pivot + glm::conjugate(rotation) * (x - pivot - translation); }
};

/// A pose at a time. Between keys the translation is linear, and the rotation takes the shorter arc at an even rate (slerp).
struct MotionKey {
    double time_s = 0;
    dvec3 translation{0.0};
    std::array<float, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w; unit
};

/// A motion that loops for ever. Key times do not fall; two equal ones make a jump. The first is 0 and the last the period.
struct Motion {
    dvec3 pivot{0.0};                            ///< world; the point about which keys rotate
    std::uint32_t first_key = 0, key_count = 0;  ///< in Model::motion_keys; one key: a constant pose
    double period_s = 1;
    std::uint32_t outer = 0xffffffffU;  ///< motion that carries this one, below its own index; none: the world
};

constexpr std::uint32_t max_motions = 1U << 16U, max_motion_keys = 1U << 22U;
constexpr std::uint32_t max_motion_depth = 16;             ///< motions that carry each other
constexpr double min_period_s = 1e-3, max_period_s = 1e6;  ///< of a motion

/// The pose of a motion, those that carry it included. `motion`: an index, or none. Any time: it wraps, and what is no number is
/// time 0. Allocates nothing.
RigidPose pose_at(const Model& model, std::uint32_t motion, double time_s);

/// The placement as it stands in that pose.
Placement moved(const Placement& placement, const RigidPose& pose);

/// Bounds of what a motion does to the points of a box. The box is in the world, at rest.
struct MotionReach {
    Box box;                    ///< contains all of the points at all times, and at rest if asked for
    double displacement_m = 0;  ///< no point is ever farther from its rest
    double speed_mps = 0;       ///< no point is ever faster, jumps left out
    double turn_rps = 0;        ///< nothing ever turns faster
};
MotionReach reach_of(const Model& model, std::uint32_t motion, const Box& at_rest, bool with_rest = true);

/// Whether a model calls for motion, and why, as for an effect. It has no program and no bit: what moves is drawn as what stands.
EffectFinding motion_finding(const Model& model);

/// What a form that moves has to be to cast a shadow. That it sees no sky is known only where the bake measured it.
enum class Casting : std::uint8_t { casts, transparent, sees_no_sky };
/// Its parts that are not transparent decide.
Casting casting_of(const Model& model, const Representation& rep);

/// The box of a node's full detail at rest: Node::box, unless it moves. Passes over its triangles.
Box rest_box_of(const Model& model, const Node& node);
/// The same of every node.
std::vector<Box> rest_boxes_of(const Model& model);

}  // namespace surefoot::model
