// The steps of the walker (README.md).
#include "render/model/ground/walker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/model/ground/walker_parts.hpp"
#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

constexpr double slope_slack = 1e-6, edge_slack_m = 1e-3;  // a slope of exactly the limit is climbed, and an edge stops
constexpr double foot_share = 0.5;                         // radius of the disc under which the floor is looked for
constexpr double gravity_m_s2 = 9.81, max_fall_m_s = 5, fall_from_m = 3;
constexpr double max_roll_m_s = 1;
constexpr double eye_m_s2 = 8, eye_settles_s = 0.06;  // how the eye follows the feet up and down
constexpr double max_sink_m = 0.15;                   // the eye below its height over the feet, landing
constexpr double gather_m = 0.25;                     // triangles are gathered this much further than a step needs
constexpr double close_m = 0.12;
constexpr std::size_t max_close = 4096;
constexpr double wall_max_up = 0.7;  // of a normal: what is more level is a floor or a ceiling, and the eye is not led through it

using walker_parts::max_lag_m, walker_parts::max_overlap_m, walker_parts::step_slack_m;

}  // namespace

Walker::Walker(const Model& model, const Body& body) : Walker(model.ground, &model, body) {}

Walker::Walker(const Ground& ground, const Model* model, const Body& body)
    : ground_(ground), body_(body), near_(ground), moving_(model) {
    // A small visitor is a thin one too, and steps no higher than the knee.
    const double tall = body_.eye_m + crown_m;
    body_.step_m = std::min(body_.step_m, 0.4 * tall);
    body_.radius_m = std::min(body_.radius_m, (tall - body_.step_m - step_slack_m) / 2);
    close_.reserve(max_close);
    for (std::size_t i = 1; i < foot_.size(); ++i)
        foot_[i] = foot_share * body_.radius_m * walker_parts::direction(static_cast<double>(i) / 8);
}

Capsule Walker::capsule_at(const dvec3& feet) const {
    const double bottom = body_.step_m + step_slack_m, top = body_.eye_m + crown_m;
    return {feet + dvec3(0, bottom + body_.radius_m, 0), std::max(0.0, top - bottom - 2 * body_.radius_m), body_.radius_m};
}

void Walker::prepare_near(const dvec3& feet, double reach_m) {
    const Capsule body = capsule_at(feet);
    reach_m += close_m;
    Box needed{feet - dvec3(body.radius + reach_m), feet + dvec3(body.radius + reach_m)};
    needed.min.y = feet.y - std::min(body_.edge_m, 2.0) - reach_m;
    needed.max.y = body.low.y + body.length + body.radius + body_.step_m + reach_m;
    if (near_.gathered(needed)) return;
    near_.gather({needed.min - gather_m, needed.max + gather_m});
    close_known_ = false;
}

void Walker::find_close(const dvec3& feet) {
    const Capsule body = capsule_at(feet);
    const Box box = walker_parts::swept({body.low, body.length, body.radius + close_m}, dvec3(0.0));
    close_.clear();
    close_complete_ = near_.holds(box);
    near_.for_triangles(box, [&](const GroundTriangle& t, NearBlocks::Known& known) {
        if (known.apart_m - glm::length(feet - known.feet) > close_m) return;
        if (known.apart_m == -walker_parts::infinity) known = {feet, min_separation(body, t) - body.radius};
        if (known.apart_m - glm::length(feet - known.feet) > close_m) return;
        if (close_.size() < max_close)
            close_.push_back({&t, &known});
        else
            close_complete_ = false;
    });
    close_to_ = feet;
    close_known_ = true;
}

/// The body with its feet there, moved; its radius grown by `skin`. Steps are short, so only what is close can be touched; and of
/// that only what was so near when it was last measured that it may have come within reach since.
Contact Walker::sweep(const dvec3& feet, const dvec3& move, double skin) {
    Contact first;
    const Capsule body = capsule_at(feet);
    const Capsule grown{body.low, body.length, body.radius + skin};
    const auto offer = [&](const GroundTriangle& t) {
        const Contact contact = first_contact(grown, move, t, first.share);
        if (contact.share < first.share) first = contact;
    };
    const Box box = walker_parts::swept(grown, move);
    const double reach = glm::length(move) + skin;
    const bool short_step = reach <= close_m && near_.holds(box);
    if (short_step && (!close_known_ || glm::length(feet - close_to_) + reach > close_m)) find_close(feet);
    if (moving_.exist()) first = moving_.first_contact(grown, move, box);
    if (!short_step || !close_complete_) {
        for_still(box, offer);
        return first;
    }
    for (const Close& close : close_) {
        NearBlocks::Known& known = *close.known;
        const double moved = glm::length(feet - known.feet);
        if (known.apart_m - moved > reach) continue;
        if (moved > 0 || !known.exact) known = {feet, separation(body, *close.triangle).distance - body.radius, true};
        if (known.apart_m <= reach) offer(*close.triangle);
    }
    return first;
}

bool Walker::is_free(const dvec3& feet) const {
    Capsule body = capsule_at(feet);
    body.radius -= max_overlap_m;
    bool is_free = true;
    for_near(walker_parts::swept(body, dvec3(0.0)), [&](const GroundTriangle& t) {
        is_free = is_free && (min_separation(body, t) >= body.radius || separation(body, t).distance >= body.radius);
    });
    return is_free;
}

bool Walker::passes(const dvec3& from, const dvec3& to) const {
    const double y = std::max(from.y, to.y);
    const Capsule body = capsule_at({from.x, y, from.z});
    const dvec3 move(to.x - from.x, 0, to.z - from.z);
    bool touches = false;
    for_near(walker_parts::swept(body, move),
             [&](const GroundTriangle& t) { touches = touches || first_contact(body, move, t).share <= 1; });
    return !touches;
}

/// The centre and eight points around it look down from `top`.
Walker::Footing Walker::footing(const dvec3& at, double top, double bottom) const {
    const double reach = foot_share * body_.radius_m, min_up = std::cos(body_.slope_rad) - slope_slack;
    Footing found{-walker_parts::infinity, -walker_parts::infinity};
    const Box column{dvec3(at.x - reach, bottom, at.z - reach), dvec3(at.x + reach, top, at.z + reach)};
    const auto offer = [&](const GroundTriangle& t) {
        if (std::max({t.a.y, t.b.y, t.c.y}) <= found.floor) return;
        const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
        const bool floor = std::abs(n.y) >= min_up * glm::length(n);
        for (const dvec3& off : foot_) {
            const double y = height_at(t, at.x + off.x, at.z + off.z);
            if (!(y >= bottom && y <= top)) continue;
            found.any = std::max(found.any, y);
            if (floor) found.floor = std::max(found.floor, y);
        }
    };
    for_still(column, offer);
    moving_.for_triangles(column, [&](const GroundTriangle& t, std::uint32_t thing) {
        const Footing before = found;
        offer(t);
        if (found.any > before.any) found.any_thing = thing;
        if (found.floor > before.floor) found.floor_thing = thing;
    });
    return found;
}

/// Level moves stop at walls and go on along them.
dvec3 Walker::slide(const dvec3& feet, dvec3 move, Barrier& barrier) {
    dvec3 at = feet;
    std::array<dvec3, 4> walls;
    for (std::size_t i = 0; i < walls.size() && glm::length(move) > 1e-12; ++i) {
        Contact contact = sweep(at, move, walker_parts::skin_m);
        // The skin is for walls. A ceiling whose tilt is a rounding error would hold who has come under it that close.
        if (contact.share <= 1 && contact.away.y < -wall_max_up) contact = sweep(at, move);
        if (contact.share > 1) return at + move;
        at += contact.share * move;
        move *= 1 - contact.share;
        barrier = contact.away.y < -wall_max_up ? Barrier::ceiling : Barrier::wall;
        const double level = std::hypot(contact.away.x, contact.away.z);
        if (level < 1e-6) return at;
        walls[i] = dvec3(contact.away.x / level, 0, contact.away.z / level);
        move -= walls[i] * std::min(0.0, glm::dot(walls[i], move));
        for (std::size_t before = 0; before < i; ++before)
            if (glm::dot(walls[before], move) < -1e-12) return at;  // a corner
    }
    return at;
}

Walker::Attempt Walker::attempt(const dvec3& move) {
    Attempt to;
    to.feet = slide(feet_, move, to.barrier);
    const double raise = body_.step_m + step_slack_m, top = feet_.y + raise;
    const double bottom = feet_.y - std::max(raise, std::min(body_.edge_m, walker_parts::deep_m) - edge_slack_m);
    const Footing under = footing(to.feet, top, bottom);
    const auto refused = [&](Barrier why) {
        to.feet = feet_;
        to.barrier = why;
        return to;
    };
    double floor = under.floor;
    to.thing = under.floor_thing;
    if (floor == -walker_parts::infinity &&
        under.any > -walker_parts::infinity) {  // only what is too steep: down it goes, if it stood on such before
        if (supported_ && (!steep_ || under.any > feet_.y)) return refused(Barrier::slope);
        floor = under.any;
        to.thing = under.any_thing;
        to.steep = true;
    }
    if (floor == -walker_parts::infinity) {
        if (supported_) return refused(Barrier::edge);
        return to;
    }
    const double rise = floor - feet_.y;
    if (rise > 0) {
        if (floor + body_.eye_m - eye_.y > max_lag_m) return refused(Barrier::slope);  // too fast for the eye
        if (sweep(to.feet, dvec3(0, rise, 0)).share <= 1) return refused(Barrier::ceiling);
        to.feet.y = floor;
        to.supported = true;
    } else if (-rise <= raise && supported_) {
        const Contact below = sweep(to.feet, dvec3(0, rise, 0));
        to.feet.y += std::min(1.0, below.share) * rise;
        to.supported = true;
    }
    return to;
}

void Walker::travel(const dvec3& move) {
    Attempt best = attempt(move);
    const Barrier first = best.barrier;
    // Along an edge, or past the end of what is too steep or too low: the same way, turned aside.
    const int tries = near_.complete() ? 6 : 2;  // where triangles are too many to gather, each try takes long
    for (int i = 1; i <= tries && best.feet == feet_ && first != Barrier::wall; ++i) {
        const int step = i % 2 == 0 ? -(i / 2) : (i + 1) / 2;
        const double turn = step * (29.0 / 360.0), along = std::cos(2 * std::numbers::pi * turn);
        const dvec3 d = walker_parts::direction(turn);
        best = attempt(along * dvec3(move.x * d.x - move.z * d.z, 0, move.x * d.z + move.z * d.x));
    }
    if (best.feet == feet_) {
        barrier_ = first;
        return;
    }
    const dvec2 gone(best.feet.x - feet_.x, best.feet.z - feet_.z);
    if (glm::length(gone) < 0.1 * glm::length(move)) barrier_ = first;
    feet_ = best.feet;
    supported_ = best.supported;
    steep_ = best.steep;
    support_ = best.thing;
    if (!supported_) return;
    fall_m_s = 0;
    remember_free_place();
}

void Walker::fall(double dt_s) {
    if (supported_) return;
    const double deep = std::max(fall_from_m, std::min(body_.edge_m, walker_parts::deep_m));
    const Footing under = footing(feet_, feet_.y + walker_parts::skin_m, feet_.y - deep);
    if (under.any == -walker_parts::infinity) {  // no floor to fall to: it glides
        fall_m_s = 0;
        return;
    }
    fall_m_s = std::min(fall_m_s + gravity_m_s2 * dt_s, max_fall_m_s);
    const double drop = std::min(fall_m_s * dt_s, std::max(0.0, feet_.y - under.any));
    const Contact below = sweep(feet_, dvec3(0, -drop, 0));
    feet_.y -= std::min(1.0, below.share) * drop;
    if (below.share > 1 && feet_.y - under.any > 1e-9) return;
    if (below.share <= 1 && feet_.y - under.any > body_.step_m && roll_off(below, dt_s)) return;
    supported_ = true;
    steep_ = under.any > under.floor;
    support_ = under.thing();
    fall_m_s = 0;
}

/// A falling body that touches an edge with its side is led off it, slowly. False: it lies there.
bool Walker::roll_off(const Contact& contact, double dt_s) {
    const double level = std::hypot(contact.away.x, contact.away.z);
    if (level < 0.05) return false;
    // Down and aside together no more than gravity gives.
    fall_m_s = std::clamp(fall_m_s - 0.3 * gravity_m_s2 * dt_s, 0.0, max_roll_m_s);
    Barrier ignored = Barrier::clear;
    const dvec3 aside = dvec3(contact.away.x, 0, contact.away.z) * (fall_m_s * dt_s / level);
    const dvec3 to = slide(feet_, aside, ignored);
    const bool moved = glm::length(to - feet_) > 0.1 * glm::length(aside);
    feet_ = to;
    return moved;
}

/// The eye follows its height over the feet with a limited acceleration. It may stop at once. Feet that really sink take it
/// along.
void Walker::raise_eye(double sank_m_s, double dt_s) {
    eye_.x = feet_.x, eye_.z = feet_.z;
    const double target = feet_.y + body_.eye_m, off = target - eye_.y;
    const double speed = std::min(std::sqrt(2 * eye_m_s2 * std::abs(off)), std::abs(off) / eye_settles_s);
    const double wanted = std::copysign(speed, off), change = eye_m_s2 * dt_s;
    if (supported_ || sank_m_s == 0)
        eye_m_s += std::clamp(wanted - eye_m_s, -change, change);
    else
        eye_m_s = std::max(-sank_m_s, std::min(eye_m_s, 0.0) - gravity_m_s2 * dt_s);
    const double before = eye_.y, lowest = target - max_sink_m;
    eye_.y += eye_m_s * dt_s;
    if (eye_m_s < 0 && eye_.y < lowest) {  // it stops; it is not moved up
        eye_.y = std::max(eye_.y, std::min(before, lowest));
        eye_m_s = 0;
    }
    if (std::abs(target - eye_.y) < 1e-5 && std::abs(eye_m_s) < 1e-3) eye_.y = target, eye_m_s = 0;
}

Walker::Foreseen Walker::foresee(const dvec3& feet, const dvec3& eye, const dvec3& way, double wide_m) noexcept {
    Barrier ignored = Barrier::clear;
    prepare_near(feet, glm::length(way) + wide_m);
    const dvec3 to = slide(feet, dvec3(way.x, 0, way.z), ignored);
    Foreseen foreseen{{to.x, eye.y + way.y, to.z}, 0};
    Capsule point{foreseen.eye, 0, wide_m + glm::length(foreseen.eye - eye - way)};
    for_near(walker_parts::swept(point, dvec3(0.0)), [&](const GroundTriangle& t) {
        const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
        if (min_separation(point, t) >= point.radius || std::abs(n.y) > wall_max_up * glm::length(n)) return;
        point.radius = std::min(point.radius, separation(point, t).distance);
    });
    foreseen.clear_m = point.radius;
    return foreseen;
}

dvec3 Walker::walk(const dvec3& from, const dvec3& wanted, double dt_s) noexcept {
    if (time_s_ < stood_s_ && time_s_ > stood_s_ - max_pause_s) time_s_ = stood_s_;  // a display moved the frames' grid
    const double since_s = time_s_ - stood_s_;
    double moved_from_s = stood_s_;
    stood_s_ = time_s_;
    if (moving_.exist()) ride_ = {};
    if (!known_ || from != eye_ || (moving_.exist() && !(since_s >= 0 && since_s <= max_pause_s))) {  // somebody placed the eye
        eye_ = from;
        known_ = true;
        awake_ = searching_ = false;
        barrier_ = Barrier::clear;
    }
    const dvec3 move(wanted.x - from.x, 0, wanted.z - from.z);
    const bool pushed = move != dvec3(0.0);
    if (!awake_) {
        gather_moving(eye_ - dvec3(0, body_.eye_m, 0), time_s_, time_s_);
        if (!pushed) return eye_;
        stand_up();
        moved_from_s = time_s_;
        tried_from_ = feet_;
        pushed_s_ = 0;
        trial_ = 0;
    }
    stuck_s_ = std::max(0.0, stuck_s_ - dt_s);
    barrier_ = stuck_s_ > 0 ? Barrier::stuck : Barrier::clear;
    if (searching_) {
        gather_moving(feet_, time_s_, time_s_);
        look_for_a_free_place();
        return eye_;
    }
    if (moving_.exist()) move_along(moved_from_s, time_s_);
    if (!pushed && supported_ && eye_m_s == 0 && eye_.y == feet_.y + body_.eye_m) return eye_;
    prepare_near(feet_, glm::length(move) + max_fall_m_s * dt_s);
    if (pushed) travel(move);
    const double before_m = feet_.y;
    fall(dt_s);
    raise_eye(std::max(0.0, before_m - feet_.y) / dt_s, dt_s);
    if (pushed) watch(move, dt_s);
    return eye_;
}

}  // namespace surefoot::model
