// Boxes of moving nodes (moving.hpp).
#include "render/model/moving.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::model {

namespace {

/// Beyond rounding.
bool is_other_pose(const MotionKey& a, const MotionKey& b) {
    float same = 0, turned = 0;  // a quaternion and its negative are one rotation
    for (std::size_t i = 0; i < 4; ++i) {
        same = std::max(same, std::abs(a.rotation[i] - b.rotation[i]));
        turned = std::max(turned, std::abs(a.rotation[i] + b.rotation[i]));
    }
    return std::min(same, turned) > 1e-6F || glm::length(a.translation - b.translation) > 1e-6;
}

/// Between two keys at one time, or from the end to the start.
bool has_jumps(const Model& model, Index motion) {
    for (Index m = motion; m != none; m = model.motions[m].outer) {
        const Motion& one = model.motions[m];
        const MotionKey* const keys = &model.motion_keys[one.first_key];
        if (is_other_pose(keys[0], keys[one.key_count - 1])) return true;
        for (std::uint32_t k = one.first_key + 1; k < one.first_key + one.key_count; ++k)
            if (!(model.motion_keys[k].time_s > model.motion_keys[k - 1].time_s)) return true;
    }
    return false;
}

dvec3 corner_of(const Box& box, unsigned c) {
    return {(c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y, (c & 4U) != 0 ? box.max.z : box.min.z};
}

}  // namespace

Box MovingNode::box() const {
    const dvec3 centre = pose(rest.centre()), half = rest.half();
    const dmat3 turn = glm::mat3_cast(pose.rotation);
    const dvec3 reach = glm::abs(turn[0]) * half.x + glm::abs(turn[1]) * half.y + glm::abs(turn[2]) * half.z + drift_m;
    return {centre - reach, centre + reach};
}

MotionPoses::MotionPoses(const Model& model) : model_(&model), poses_(model.motions.size()), worked_(model.motions.size(), 0) {}

void MotionPoses::set_time(double time_s) {
    time_s_ = time_s;
    ++moment_;
}

const RigidPose& MotionPoses::at(Index motion) {
    if (worked_[motion] != moment_) {
        poses_[motion] = pose_at(*model_, motion, time_s_);
        worked_[motion] = moment_;
    }
    return poses_[motion];
}

MovingNodes::MovingNodes(const Model& model) : model_(&model) {
    if (model.motions.empty()) return;
    slot_of_node_.assign(model.nodes.size(), none);
    const std::vector<Box> rest = rest_boxes_of(model);
    std::vector<Box> moved_by(model.motions.size());  // all that a motion moves: its limits are worked out once
    for (Index n = 0; n < model.nodes.size(); ++n) {
        const Node& node = model.nodes[n];
        Slot slot;
        slot.motion = motion_of(model, node);
        if (slot.motion == none) continue;
        slot.rest = rest[n];
        moved_by[slot.motion].grow(slot.rest);
        slot_of_node_[n] = static_cast<Index>(slots_.size());
        slots_.push_back(slot);
        if (node.parent == none || slot_of_node_[node.parent] == none) roots_.push_back(n);
    }
    if (slots_.empty()) slot_of_node_.clear();
    std::vector<double> max_speed_mps(moved_by.size(), 0);
    std::vector<bool> jumps(moved_by.size(), false);
    for (Index m = 0; m < moved_by.size(); ++m) {
        if (moved_by[m].empty()) continue;
        max_speed_mps[m] = reach_of(model, m, moved_by[m]).speed_mps;
        jumps[m] = has_jumps(model, m);
    }
    for (Slot& slot : slots_) {
        slot.max_speed_mps = max_speed_mps[slot.motion];
        slot.jumps = jumps[slot.motion];
    }
}

void MovingNodes::set_span(double from_s, double to_s) {
    from_s_ = std::isfinite(from_s) ? from_s : 0;
    to_s_ = std::isfinite(to_s) ? std::max(to_s, from_s_) : from_s_;
}

/// But for its speed.
MovingNode MovingNodes::placed(Index index) const {
    const Slot& slot = slots_[slot_of_node_[index]];
    const double half_s = 0.5 * (to_s_ - from_s_);
    MovingNode node;
    node.rest = slot.rest;
    node.pose = pose_at(*model_, slot.motion, from_s_ + half_s);
    node.drift_m = slot.max_speed_mps * half_s * (1 + 1e-9);
    node.everywhere = slot.jumps && half_s > 0;
    return node;
}

std::optional<MovingNode> MovingNodes::find(Index index) const {
    if (slot_of_node_.empty() || slot_of_node_[index] == none) return {};
    const Slot& slot = slots_[slot_of_node_[index]];
    MovingNode node = placed(index);
    const double half_s = 0.5 * (to_s_ - from_s_), middle_s = from_s_ + half_s;
    const double around_s = std::max(half_s, 0.005);  // a moment has a speed as well
    const RigidPose before = pose_at(*model_, slot.motion, middle_s - around_s);
    const RigidPose after = pose_at(*model_, slot.motion, middle_s + around_s);
    double way_m = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 corner = corner_of(node.rest, c);
        way_m = std::max(way_m, glm::length(after(corner) - before(corner)));
    }
    node.speed_mps = std::min(way_m / (2 * around_s), slot.max_speed_mps);
    return node;
}

Box MovingNodes::box(Index node) const {
    const Box& always = model_->nodes[node].box;
    if (slot_of_node_.empty() || slot_of_node_[node] == none) return always;
    const MovingNode moving = placed(node);
    return moving.everywhere ? always : moving.box();
}

std::optional<MovingNode> MovingNodes::find(Index node, MotionPoses& now) const {
    if (slot_of_node_.empty() || slot_of_node_[node] == none) return {};
    const Slot& slot = slots_[slot_of_node_[node]];
    MovingNode moving;
    moving.rest = slot.rest;
    moving.pose = now.at(slot.motion);
    return moving;
}

Box MovingNodes::box(Index node, MotionPoses& now) const {
    const std::optional<MovingNode> moving = find(node, now);
    return moving ? moving->box() : model_->nodes[node].box;
}

ViewScale turned_back(const ViewScale& scale, const RigidPose& pose) {
    const glm::quat back(glm::conjugate(pose.rotation));
    ViewScale out = scale;
    for (vec3* axis : {&out.right, &out.up, &out.forward, &out.across, &out.rise, &out.middle}) *axis = back * *axis;
    return out;
}

}  // namespace surefoot::model
