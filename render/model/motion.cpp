// Motions by their keys: the pose at a time, and bounds that hold between keys as well.
#include "render/model/motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

/// Arcs are cut into chords of this turn at most, for bounds. A point 1 m from its pivot leaves such a chord by 0.3 mm.
constexpr double chord_rad = 0.05;

std::span<const MotionKey> keys_of(const Model& model, const Motion& motion) {
    return std::span(model.motion_keys).subspan(motion.first_key, motion.key_count);
}

dquat quat_of(const MotionKey& key) {
    const dquat q(key.rotation[3], key.rotation[0], key.rotation[1], key.rotation[2]);
    return glm::normalize(q);
}

/// `share`: 0 at the first key, 1 at the second.
RigidPose between_keys(const dvec3& pivot, const MotionKey& a, const MotionKey& b, double share) {
    return {pivot, glm::mix(a.translation, b.translation, share), glm::slerp(quat_of(a), quat_of(b), share)};
}

/// Angle from one rotation to another by the shorter arc, 0 to pi.
double turn_between(const dquat& a, const dquat& b) {
    const dquat d = b * glm::conjugate(a);
    return 2 * std::atan2(glm::length(dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

/// Of the motion alone, without those that carry it.
RigidPose own_pose(const Model& model, const Motion& motion, double time_s) {
    const std::span<const MotionKey> keys = keys_of(model, motion);
    double at = std::isfinite(time_s) ? std::fmod(time_s, motion.period_s) : 0.0;
    if (at < 0) at += motion.period_s;
    const auto after = std::upper_bound(keys.begin(), keys.end(), at, [](double t, const MotionKey& k) { return t < k.time_s; });
    if (after == keys.begin()) return between_keys(motion.pivot, keys.front(), keys.front(), 0);
    if (after == keys.end()) return between_keys(motion.pivot, keys.back(), keys.back(), 0);
    const MotionKey& from = *(after - 1);
    return between_keys(motion.pivot, from, *after, (at - from.time_s) / (after->time_s - from.time_s));
}

/// The inner pose, carried by the outer one.
RigidPose composed(const RigidPose& outer, const RigidPose& inner) {
    return {inner.pivot, outer(inner.pivot + inner.translation) - inner.pivot, outer.rotation * inner.rotation};
}

template <class Use>
void for_corners(const Box& box, Use use) {
    for (unsigned c = 0; c < 8; ++c)
        use(dvec3((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                  (c & 4U) != 0 ? box.max.z : box.min.z));
}

double farthest_from(const dvec3& pivot, const Box& box) {
    double farthest = 0;
    for_corners(box, [&](const dvec3& corner) { farthest = std::max(farthest, glm::length(corner - pivot)); });
    return farthest;
}

/// Grows `out` by where the box is at one pose.
void add_pose(const RigidPose& pose, const Box& box, MotionReach& out) {
    for_corners(box, [&](const dvec3& corner) {
        const dvec3 at = pose(corner);
        out.box.grow(at);
        out.displacement_m = std::max(out.displacement_m, glm::length(at - corner));
    });
}

/// What one motion alone does to a box. A point of the box is a mean of its corners, at each pose. Between two samples a corner
/// stays within the height of its arc from the chord.
MotionReach own_reach(const Model& model, const Motion& motion, const Box& box, bool with_rest) {
    const std::span<const MotionKey> keys = keys_of(model, motion);
    MotionReach out;
    if (with_rest) out.box = box;
    double height_m = 0;
    const double radius_m = farthest_from(motion.pivot, box);
    add_pose(between_keys(motion.pivot, keys[0], keys[0], 0), box, out);
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
        const MotionKey &a = keys[k], &b = keys[k + 1];
        const double turn = turn_between(quat_of(a), quat_of(b));
        const int count = std::max(1, static_cast<int>(std::ceil(turn / chord_rad)));
        const double steps = count;
        height_m = std::max(height_m, radius_m * (1 - std::cos(0.5 * turn / steps)));
        for (int step = 1; step <= count; ++step) add_pose(between_keys(motion.pivot, a, b, step / steps), box, out);
        const double seconds = b.time_s - a.time_s;
        if (!(seconds > 0)) continue;  // a jump
        const double travel_m = glm::length(b.translation - a.translation);
        out.turn_rps = std::max(out.turn_rps, turn / seconds);
        out.speed_mps = std::max(out.speed_mps, (travel_m + radius_m * turn) / seconds);
    }
    // The arcs, and the rounding of all that was computed here.
    const dvec3 far = glm::max(glm::abs(out.box.min), glm::abs(out.box.max));
    const double slack_m = height_m + 1e-12 * (1 + std::max({far.x, far.y, far.z}));
    out.box.min -= slack_m;
    out.box.max += slack_m;
    out.displacement_m += slack_m;
    return out;
}

}  // namespace

RigidPose pose_at(const Model& model, std::uint32_t motion, double time_s) {
    RigidPose pose;
    if (motion == none) return pose;
    pose = own_pose(model, model.motions[motion], time_s);
    for (Index outer = model.motions[motion].outer; outer != none; outer = model.motions[outer].outer)
        pose = composed(own_pose(model, model.motions[outer], time_s), pose);
    return pose;
}

Placement moved(const Placement& placement, const RigidPose& pose) {
    Placement out = placement;
    out.origin = pose(placement.origin);
    out.linear = mat3(glm::mat3_cast(pose.rotation) * dmat3(placement.linear));
    return out;
}

MotionReach reach_of(const Model& model, std::uint32_t motion, const Box& at_rest, bool with_rest) {
    MotionReach reach;
    reach.box = at_rest;
    for (Index m = motion; m != none; m = model.motions[m].outer) {
        const MotionReach own = own_reach(model, model.motions[m], reach.box, with_rest);
        reach = {own.box, reach.displacement_m + own.displacement_m, reach.speed_mps + own.speed_mps,
                 reach.turn_rps + own.turn_rps};
    }
    return reach;
}

/// What was measured and has no sun sees no sky. What is unlit was not measured.
Casting casting_of(const Model& model, const Representation& rep) {
    Casting found = Casting::transparent;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const Material& material = model.materials[model.parts[p].material];
        if (material.alpha == AlphaMode::blend) continue;
        if ((material.effects & (effect_sun | effect_openness)) != effect_openness) return Casting::casts;
        found = Casting::sees_no_sky;
    }
    return found;
}

EffectFinding motion_finding(const Model& model) {
    EffectFinding finding;
    if (model.motions.empty()) {
        finding.reason = "no animation moves anything";
        return finding;
    }
    std::vector<bool> moving(model.object_count, false);
    for (const Node& node : model.nodes) {
        if (node.child_count > 0 || motion_of(model, node) == none) continue;
        finding.triangles += node.triangles;
        if (node.object < moving.size()) moving[node.object] = true;
    }
    double shortest_s = model.motions[0].period_s, longest_s = shortest_s;
    for (const Motion& motion : model.motions) {
        shortest_s = std::min(shortest_s, motion.period_s);
        longest_s = std::max(longest_s, motion.period_s);
    }
    finding.called_for = finding.triangles > 0;
    finding.reason = fmt::format("animations move {} of {} objects; their periods are {:.3g} to {:.3g} s",
                                 std::count(moving.begin(), moving.end(), true), model.object_count, shortest_s, longest_s);
    return finding;
}

namespace {

Box leaf_at_rest(const Model& model, const Node& node) {
    Box box;
    const Representation& rep = model.reps[node.first_rep + node.rep_count - 1];
    const Placement& placement = model.placements[rep.placement];
    const dmat3 linear(placement.linear);
    for_triangles(model, rep, [&](const Material&, const vec3& a, const vec3& b, const vec3& c) {
        for (const vec3& corner : {a, b, c}) box.grow(placement.origin + linear * dvec3(corner));
    });
    return box;
}

}  // namespace

Box rest_box_of(const Model& model, const Node& node) {
    if (motion_of(model, node) == none) return node.box;
    Box box;
    std::vector<const Node*> open{&node};  // a tree from a file may be deep
    while (!open.empty()) {
        const Node& next = *open.back();
        open.pop_back();
        if (motion_of(model, next) == none) {
            box.grow(next.box);
        } else if (next.child_count == 0) {
            box.grow(leaf_at_rest(model, next));
        } else {
            for (std::uint32_t c = 0; c < next.child_count; ++c) open.push_back(&model.nodes[next.first_child + c]);
        }
    }
    return box;
}

std::vector<Box> rest_boxes_of(const Model& model) {
    std::vector<Box> out(model.nodes.size());
    for (std::size_t n = model.nodes.size(); n-- > 0;) {  // children come after their parents
        const Node& node = model.nodes[n];
        if (motion_of(model, node) == none) {
            out[n] = node.box;
        } else if (node.child_count == 0) {
            out[n] = leaf_at_rest(model, node);
        } else {
            for (std::uint32_t c = 0; c < node.child_count; ++c) out[n].grow(out[node.first_child + c]);
        }
    }
    return out;
}

}  // namespace surefoot::model
