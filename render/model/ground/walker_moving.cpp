// How things that move carry the walker, push it aside, and pass through it where there is no room (README.md).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/model/ground/walker_parts.hpp"

namespace surefoot::model {

namespace {

constexpr double max_part_m = 0.1;  // things move this far at a time at most: no thin one gets behind the body's axis
constexpr int max_step_parts = 32, max_pushes = 8;
constexpr double max_pushing_m_s = 10;  // what comes faster, as a train, goes through: nobody is swept along
constexpr double max_push_m_s = 0.5;    // beyond the speed of what pushes: out of a wedge that closes
constexpr double near_things_m = 2;     // what comes so near to where triangles are gathered counts for predictions
constexpr double around_body_m = 1.2;   // triangles are gathered so far around the body
constexpr std::array aside_rings_m = {0.15, 0.3, 0.5, 0.8};
constexpr int aside_directions = 12;
constexpr double core_radius_m = 0.05, overlap_noise_m = 1e-7;
constexpr double min_level = 0.1;  // of a contact's direction: else it is a floor or a ceiling, and nothing is pushed level

}  // namespace

void Walker::gather_moving(const dvec3& feet, double from_s, double to_s) {
    if (!moving_.exist()) return;
    const Capsule body = capsule_at(feet);
    Box box{feet - (body.radius + around_body_m), feet + (body.radius + around_body_m)};
    box.max.y = body.low.y + body.length + body.radius + around_body_m;
    moving_.gather(box, near_things_m, from_s, to_s);
    if (holds_still_) return;  // else predictions are wider by speeds that are not there
    for (const NearMoving::Thing& thing : moving_.things()) {
        if (thing.speed_m_s > 0) ride_.max_m_s = std::max(ride_.max_m_s, thing.speed_m_s + max_push_m_s);
        ride_.max_turn_rad_s = std::max(ride_.max_turn_rad_s, thing.turn_rad_s);
    }
}

/// Things have moved since the last step. They do so in parts, each short against the body.
void Walker::move_along(double from_s, double to_s) {
    gather_moving(feet_, from_s, to_s);
    end_passing();
    bool moved = false;
    double fastest_m_s = 0;
    for (const NearMoving::Thing& thing : moving_.things()) {
        moved = moved || thing.moved;
        fastest_m_s = std::max(fastest_m_s, thing.speed_m_s);
    }
    if (!moved) return evade(0);  // perhaps it was put there
    const double seconds = to_s - from_s, part_m = std::min(max_part_m, body_.radius_m / 3);
    const int parts = std::clamp(static_cast<int>(std::ceil(fastest_m_s * seconds / part_m)), 1, max_step_parts);
    for (int i = 0; i < parts; ++i) {
        const double part_from_s = from_s + seconds * i / parts,
                     part_to_s = i + 1 == parts ? to_s : from_s + seconds * (i + 1) / parts;
        if (parts > 1) gather_moving(feet_, part_from_s, part_to_s);
        const double max_m = ride_.max_m_s * (part_to_s - part_from_s);
        prepare_near(feet_, max_m + body_.step_m);
        const dvec3 before = feet_;
        carry(part_to_s - part_from_s);
        const bool was_pushed = push_aside(max_m - glm::length(feet_ - before), part_to_s - part_from_s);
        keep_on_floor(was_pushed);
        evade(part_to_s - part_from_s);
    }
}

/// With the eye, and with what is remembered of the way.
void Walker::move_by(const dvec3& way) {
    feet_ += way;
    eye_ += way;
    tried_from_ += way, trial_from_ += way, trial_at_.feet += way;
    ride_.way += way;
}

/// The feet go where the floor under them goes, unless something else is in the way.
void Walker::carry(double seconds) {
    if (!supported_ || support_ == no_thing) return;
    NearMoving::Thing* thing = moving_.find(support_);
    if (thing == nullptr || thing->leaps || thing->absent) {  // no floor any more
        supported_ = false;
        support_ = no_thing;
        return;
    }
    if (!thing->moved || steep_) return;
    dvec3 way = thing->carried(feet_) - feet_;
    const double length = glm::length(way), max_m = ride_.max_m_s * seconds;
    if (length > max_m) way *= max_m / length;
    thing->absent = true;  // it moves along
    Barrier ignored = Barrier::clear;
    dvec3 at = slide(feet_, dvec3(way.x, 0, way.z), ignored);
    at.y += std::min(1.0, sweep(at, dvec3(0, way.y, 0)).share) * way.y;
    thing->absent = false;
    move_by(at - feet_);
    const double max_turn = thing->turn_rad_s * seconds;
    ride_.turn_rad += std::clamp(thing->turned_rad(), -max_turn, max_turn);
}

/// Whether it comes so fast that it would sweep the body along.
bool Walker::sweeps(const NearMoving::Thing& thing, double seconds) const {
    return !thing.leaps && glm::length(thing.carried(feet_) - feet_) > max_pushing_m_s * seconds;
}

/// Out of what overlaps by moving there: level, along walls, and by `max_m` at most. Not over edges, nor by what is too fast.
bool Walker::push_aside(double max_m, double seconds) {
    bool was_pushed = false;
    for (int i = 0; i < max_pushes && max_m > 0; ++i) {
        const Capsule body = capsule_at(feet_);
        const Capsule grown{body.low, body.length, body.radius + walker_parts::skin_m};
        dvec3 aside(0.0);
        double deepest = overlap_noise_m;
        moving_.for_triangles(walker_parts::swept(grown, dvec3(0.0)), [&](const GroundTriangle& t, std::uint32_t instance) {
            if (min_separation(grown, t) > grown.radius - deepest) return;
            const Separation s = separation(grown, t);
            const double deep = grown.radius - s.distance, level = std::hypot(s.away.x, s.away.z);
            if (deep <= deepest || s.distance == 0 || level < min_level) return;
            if (const NearMoving::Thing* thing = moving_.find(instance); thing->leaps || sweeps(*thing, seconds)) return;
            deepest = deep;
            aside = dvec3(s.away.x, 0, s.away.z) * (deep / (level * level));
        });
        if (aside == dvec3(0.0)) break;
        if (const double length = glm::length(aside); length > max_m) aside *= max_m / length;
        Barrier ignored = Barrier::clear;
        const dvec3 to = slide(feet_, aside, ignored);
        const double moved_m = glm::length(to - feet_);
        if (moved_m < overlap_noise_m || !has_floor_at(to)) break;
        move_by(to - feet_);
        max_m -= moved_m;
        was_pushed = true;
    }
    return was_pushed;
}

/// Or may be there, because nothing carries the feet now.
bool Walker::has_floor_at(const dvec3& feet) const {
    if (!supported_) return true;
    const double raise = body_.step_m + walker_parts::step_slack_m;
    const double deep = std::max(raise, std::min(body_.edge_m, walker_parts::deep_m));
    return footing(feet, feet.y + raise, feet.y - deep).any > -walker_parts::infinity;
}

/// What carries the feet may have risen, sunk or ended. A rising floor catches who falls.
void Walker::keep_on_floor(bool was_pushed) {
    const double raise = body_.step_m + walker_parts::step_slack_m;
    const Footing under = footing(feet_, feet_.y + raise, feet_.y - raise);
    const bool steep = under.floor == -walker_parts::infinity;
    const double floor = steep ? under.any : under.floor;
    const std::uint32_t thing = steep ? under.any_thing : under.floor_thing;
    if (!supported_) {
        const NearMoving::Thing* catches = moving_.find(thing);
        if (catches == nullptr || catches->leaps || floor < feet_.y) return;
        if (floor > feet_.y + std::max(0.0, catches->carried(feet_).y - feet_.y) + walker_parts::skin_m) return;
    } else if (support_ == no_thing && thing == no_thing && !was_pushed) {
        return;  // nothing here moves
    } else if (floor == -walker_parts::infinity) {
        supported_ = false;
        support_ = no_thing;
        return;
    }
    const double rise = floor - feet_.y;
    if (rise > 0 && floor + body_.eye_m - eye_.y > walker_parts::max_lag_m) return;
    const Contact contact = sweep(feet_, dvec3(0, rise, 0));
    if (rise > 0 && contact.share <= 1) return;
    feet_.y = contact.share > 1 ? floor : feet_.y + contact.share * rise;
    supported_ = true;
    steep_ = steep;
    support_ = thing;
    fall_m_s = 0;
}

/// Where something that moves overlaps after all, there is no room: it goes on through the walker, or past it where a place is
/// free beside it.
void Walker::evade(double seconds) {
    Capsule core = capsule_at(feet_);
    core.radius -= walker_parts::max_overlap_m;
    std::uint64_t overlapping = 0;  // bits: things
    double nearest_m = core.radius;
    dvec3 away(1, 0, 0);
    moving_.for_triangles(walker_parts::swept(core, dvec3(0.0)), [&](const GroundTriangle& t, std::uint32_t instance) {
        if (min_separation(core, t) >= core.radius) return;
        const Separation s = separation(core, t);
        if (s.distance >= core.radius) return;
        overlapping |= std::uint64_t{1} << (moving_.find(instance) - moving_.things().data());
        if (s.distance < nearest_m) nearest_m = s.distance, away = s.away;
    });
    bool swept = false;  // beside its way there is seldom room, and in its way none is left
    for (const NearMoving::Thing& thing : moving_.things()) {
        const std::uint64_t bit = std::uint64_t{1} << (&thing - moving_.things().data());
        if (thing.leaps && thing.moved && !thing.absent && is_in(feet_, thing)) overlapping |= bit;
        swept = swept || ((overlapping & bit) != 0 && sweeps(thing, seconds));
    }
    if (overlapping == 0 || (!swept && step_beside(std::atan2(away.z, away.x) / (2 * std::numbers::pi)))) return;
    for (NearMoving::Thing& thing : moving_.things()) {
        if ((overlapping >> (&thing - moving_.things().data()) & 1U) == 0) continue;
        moving_.let_pass(thing);
        ++passed_through_;
        if (support_ == thing.instance) supported_ = false, support_ = no_thing;
    }
}

/// To the nearest free place on rings around the feet, first in the direction `turn`. It has a floor of about that height, and no
/// wall is between.
bool Walker::step_beside(double turn) {
    const double raise = body_.step_m + walker_parts::step_slack_m;
    for (const double ring_m : aside_rings_m) {
        for (int i = 0; i < aside_directions; ++i) {
            const int side = i % 2 == 0 ? -(i / 2) : (i + 1) / 2;
            dvec3 at = feet_ + ring_m * walker_parts::direction(turn + static_cast<double>(side) / aside_directions);
            const Footing under = footing(at, feet_.y + raise, feet_.y - raise);
            if (under.floor == -walker_parts::infinity) continue;
            at.y = under.floor;
            if (!is_free(at) || !reaches(at) || is_in_any(at)) continue;
            ++put_aside_;
            stand_at(at);
            support_ = under.floor_thing;
            ride_.way = dvec3(0.0);
            ride_.turn_rad = 0;
            return true;
        }
    }
    return false;
}

/// Whether the middle of the body gets there past all that stands still.
bool Walker::reaches(const dvec3& to) const {
    const double bottom = body_.step_m + walker_parts::step_slack_m, top = body_.eye_m + crown_m;
    const double radius = std::min(core_radius_m, body_.radius_m / 2);
    const Capsule core{dvec3(feet_.x, std::max(feet_.y, to.y) + bottom + radius, feet_.z), top - bottom - 2 * radius, radius};
    const dvec3 way(to.x - feet_.x, 0, to.z - feet_.z);
    bool blocked = false;
    for_still(walker_parts::swept(core, way),
              [&](const GroundTriangle& t) { blocked = blocked || first_contact(core, way, t).share <= 1; });
    return !blocked;
}

/// Whether the middle of the body is inside of it: of six lines five end at backs.
bool Walker::is_in(const dvec3& feet, const NearMoving::Thing& thing) const {
    const Capsule body = capsule_at(feet);
    const dvec3 middle = body.low + dvec3(0, body.length / 2, 0);
    if (thing.at_rest.distance(thing.now.back(middle)) > 0) return false;
    const double size_m = thing.at_rest.diagonal();
    int backs = 0;
    for (int i = 0; i < 6; ++i) {
        dvec3 way(0.0);
        way[i / 2] = i % 2 == 0 ? size_m : -size_m;
        Box line{middle, middle};
        line.grow(middle + way);
        Crossing nearest;
        moving_.for_triangles_of(thing, line, [&](const GroundTriangle& t, std::uint32_t) {
            if (const Crossing crossing = crossing_of(middle, way, t); crossing.share < nearest.share) nearest = crossing;
        });
        backs += nearest.share <= 1 && nearest.back ? 1 : 0;
    }
    return backs >= 5;
}

bool Walker::is_in_any(const dvec3& feet) const {
    return std::any_of(moving_.things().begin(), moving_.things().end(),
                       [&](const NearMoving::Thing& thing) { return !thing.absent && is_in(feet, thing); });
}

/// Whether it neither overlaps the body nor has it inside.
bool Walker::is_clear_of(const NearMoving::Thing& thing) const {
    const Capsule body = capsule_at(feet_);
    bool clear = true;
    moving_.for_triangles_of(thing, walker_parts::swept(body, dvec3(0.0)), [&](const GroundTriangle& t, std::uint32_t) {
        clear = clear && (min_separation(body, t) >= body.radius || separation(body, t).distance >= body.radius);
    });
    return clear && !is_in(feet_, thing);
}

void Walker::end_passing() {
    for (std::size_t i = moving_.passing().size(); i > 0; --i) {
        const std::uint32_t instance = moving_.passing()[i - 1];
        const NearMoving::Thing* thing = moving_.find(instance);
        if (thing == nullptr || is_clear_of(*thing)) moving_.end_passing(instance);
    }
}

}  // namespace surefoot::model
