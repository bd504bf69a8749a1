// Poses and triangles of what moves near a body, found anew at each step.
#include "render/model/ground/near_moving.hpp"

#include <algorithm>
#include <cmath>

#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

constexpr double max_thing_m_s = 50;    // what is faster neither carries nor pushes
constexpr double thing_slack_m = 1e-6;  // of rounding, beyond what its speed allows in a step

bool same_pose(const RigidPose& a, const RigidPose& b) {
    return a.pivot == b.pivot && a.translation == b.translation && a.rotation == b.rotation;
}

/// The furthest that a corner of the box gets from one pose to another.
double way_of(const RigidPose& from, const RigidPose& to, const Box& at_rest) {
    double way = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 corner((c & 1U) != 0 ? at_rest.max.x : at_rest.min.x, (c & 2U) != 0 ? at_rest.max.y : at_rest.min.y,
                           (c & 4U) != 0 ? at_rest.max.z : at_rest.min.z);
        way = std::max(way, glm::length(to(corner) - from(corner)));
    }
    return way;
}

}  // namespace

double NearMoving::Thing::turned_rad() const {
    const dquat by = now.rotation * glm::conjugate(before.rotation);
    return 2 * std::atan2(by.w < 0 ? -by.y : by.y, std::abs(by.w));
}

NearMoving::NearMoving(const Model* model) : model_(model != nullptr && !model->moving_ground.empty() ? model : nullptr) {
    if (!exist()) return;
    things_.reserve(max_things);
    triangles_.reserve(max_triangles);
}

const Ground& NearMoving::rest_ground() const { return model_->moving_ground.rest; }

/// Around the box, seen from what stands in that pose.
Box NearMoving::box_at_rest(const RigidPose& pose, const Box& box) {
    const dmat3 back = glm::mat3_cast(glm::conjugate(pose.rotation));
    const dvec3 centre = pose.back(box.centre()), half = box.half();
    const dvec3 reach = glm::abs(back[0]) * half.x + glm::abs(back[1]) * half.y + glm::abs(back[2]) * half.z;
    return {centre - reach, centre + reach};
}

void NearMoving::add(std::uint32_t instance, double from_s, double to_s) {
    if (things_.size() == max_things) return;
    const MovingGround& moving = model_->moving_ground;
    const MotionReach& reach = moving.reach[instance];
    Thing thing;
    thing.at_rest = box_of(moving.rest, moving.rest.instances[instance]);
    thing.instance = instance;
    thing.now = pose_at(*model_, moving.motions[instance], to_s);
    thing.before = from_s == to_s ? thing.now : pose_at(*model_, moving.motions[instance], from_s);
    thing.moved = !same_pose(thing.before, thing.now);
    thing.leaps = reach.speed_mps > max_thing_m_s;
    thing.speed_m_s = thing.leaps ? 0 : reach.speed_mps, thing.turn_rad_s = thing.leaps ? 0 : reach.turn_rps;
    if (thing.moved && !thing.leaps) {
        const double way = way_of(thing.before, thing.now, thing.at_rest);
        thing.leaps = way > thing.speed_m_s * std::abs(to_s - from_s) + thing_slack_m;
    }
    thing.absent = std::find(passing().begin(), passing().end(), instance) != passing().end();
    things_.push_back(thing);
}

void NearMoving::gather(const Box& box, double reach_m, double from_s, double to_s) noexcept {
    things_.clear();
    triangles_.clear();
    box_ = box;
    complete_ = true;
    if (!exist()) return;
    ground_tree::instances_near(rest_ground(), {box.min - reach_m, box.max + reach_m},
                                [&](std::uint32_t instance) { add(instance, from_s, to_s); });
    for (Thing& thing : things_) {
        thing.first = static_cast<std::uint32_t>(triangles_.size());
        for_all(thing, box, [&](const GroundTriangle& t, std::uint32_t) {
            if (triangles_.size() < max_triangles)
                triangles_.push_back({t, ground_tree::box_of(t)});
            else
                complete_ = false;
        });
        thing.count = static_cast<std::uint32_t>(triangles_.size()) - thing.first;
    }
}

NearMoving::Thing* NearMoving::find(std::uint32_t instance) {
    for (Thing& thing : things_)
        if (thing.instance == instance) return &thing;
    return nullptr;
}

Contact NearMoving::first_contact(const Capsule& capsule, const dvec3& move, const Box& box) const {
    Contact first;
    for_triangles(box, [&](const GroundTriangle& t, std::uint32_t) {
        const Contact contact = model::first_contact(capsule, move, t, first.share);
        if (contact.share < first.share) first = contact;
    });
    return first;
}

void NearMoving::let_pass(Thing& thing) {
    thing.absent = true;
    if (passing_count_ < max_passing) passing_[passing_count_++] = thing.instance;
}

void NearMoving::end_passing(std::uint32_t instance) {
    if (Thing* thing = find(instance); thing != nullptr) thing->absent = false;
    const auto end = passing_.begin() + static_cast<std::ptrdiff_t>(passing_count_);
    passing_count_ -= static_cast<std::size_t>(end - std::remove(passing_.begin(), end, instance));
}

}  // namespace surefoot::model
