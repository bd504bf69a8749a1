// How a walker begins, gets out of what it stands in, and knows that it is stuck (README.md).
#include <algorithm>

#include "render/model/ground/walker_parts.hpp"

namespace surefoot::model {

namespace {

// How far the sides of a solid are looked for: small rooms of single walls look like one to who starts there.
constexpr double start_sight_m = 1, place_sight_m = 2.5;
constexpr std::uint32_t trials = 16, trial_steps = 21;  // directions, and steps of each: one a tick
constexpr double trial_m = 0.1, min_step_m = 1e-6, stuck_after_s = 1;
constexpr std::uint32_t search_rings = 40, search_a_tick = 2, search_places = 2 * search_rings * trials;
constexpr double below_floor_m = 1, max_push_out_m = 0.35, shown_stuck_s = 1;
constexpr double ring_m = 0.25;
constexpr double free_every_m = 0.5;

}  // namespace

/// Of six lines from the body's middle, five or all end at the backs of triangles. Closed things are seen so from their inside.
bool Walker::is_inside_solid(const dvec3& feet, double sight_m) const {
    const dvec3 middle = feet + dvec3(0, (body_.step_m + body_.eye_m) / 2, 0);
    int backs = 0;
    for (int i = 0; i < 6; ++i) {
        dvec3 way(0.0);
        way[i / 2] = i % 2 == 0 ? sight_m : -sight_m;
        Box line{middle, middle};
        line.grow(middle + way);
        double nearest = 2;
        bool back = false;
        const auto offer = [&](const GroundTriangle& t) {
            const Crossing crossing = crossing_of(middle, way, t);
            if (crossing.share < nearest) nearest = crossing.share, back = crossing.back;
        };
        for_triangles_near(ground_, line, offer);
        moving_.for_triangles(line, [&](const GroundTriangle& t, std::uint32_t) { offer(t); });
        backs += nearest <= 1 && back ? 1 : 0;
    }
    return backs >= 5;
}

/// The feet find their floor below an eye that was placed.
void Walker::stand_up() {
    awake_ = true;
    fall_m_s = eye_m_s = 0;
    const double below = eye_.y - body_.eye_m;
    Footing under = footing(eye_, below + body_.step_m, below - body_.step_m);  // not the table that it was placed over
    if (under.floor == -walker_parts::infinity)
        under = footing(eye_, eye_.y, below - std::min(body_.edge_m, walker_parts::deep_m));
    supported_ = under.any > -walker_parts::infinity;
    steep_ = under.any > under.floor;
    support_ = under.thing();
    feet_ = dvec3(eye_.x, supported_ ? std::max(under.floor, under.any) : eye_.y - body_.eye_m, eye_.z);
    stood_up_at_ = feet_;
    free_count_ = gone_back_ = new_places_ = 0;
    start_is_free_ = going_back_ = false;
    if (!supported_) {  // perhaps a vehicle's recorded path, whose heights are the road's
        const double above = footing(eye_, eye_.y + below_floor_m, eye_.y).floor;
        if (above > -walker_parts::infinity && is_free({eye_.x, above, eye_.z})) {
            free_at({eye_.x, above, eye_.z});
            return;
        }
    }
    searching_ = !is_free(feet_) || is_inside_solid(feet_, start_sight_m);
    start_is_free_ = supported_ && !steep_ && !searching_ && support_ == no_thing;
    search_at_ = 0;
}

/// Out of what the body overlaps, level and by the shortest way. False: not within max_push_out_m.
bool Walker::push_out() {
    dvec3 at = feet_;
    for (int i = 0; i < 8; ++i) {
        const Capsule body = capsule_at(at);
        dvec3 aside(0.0);
        double deepest = 0;
        for_near(walker_parts::swept(body, dvec3(0.0)), [&](const GroundTriangle& t) {
            const Separation s = separation(body, t);
            const double deep = body.radius + walker_parts::skin_m - s.distance, level = std::hypot(s.away.x, s.away.z);
            if (deep <= deepest || s.distance == 0 || level < 0.1) return;
            deepest = deep;
            aside = dvec3(s.away.x, 0, s.away.z) * (deep / (level * level));
        });
        if (deepest == 0) break;
        at += aside;
        if (glm::length(at - feet_) > max_push_out_m) return false;
    }
    at.y = footing(at, feet_.y + body_.step_m, feet_.y - body_.step_m).floor;
    if (!std::isfinite(at.y) || !is_free(at) || is_inside_solid(at, place_sight_m)) return false;
    free_at(at);
    return true;
}

bool Walker::sees(const dvec3& to) const {
    Box box{eye_, eye_};
    box.grow(to);
    bool crosses = false;
    for_triangles_near(ground_, box,
                       [&](const GroundTriangle& t) { crosses = crosses || crossing_of(eye_, to - eye_, t).share <= 1; });
    return !crosses;
}

/// Beside what it overlaps, if it does so slightly. Else on rings around the eye, nearest first: the first place with a floor
/// where the body is free. At first only floors of about this height, from where nothing is between; then any.
void Walker::look_for_a_free_place() {
    barrier_ = Barrier::inside;
    if (search_at_ == 0 && supported_ && push_out()) return;
    for (std::uint32_t i = 0; i < search_a_tick && searching_; ++i, ++search_at_) {
        if (search_at_ >= search_places) {  // nothing is free: the walker stays, and walls let it out but not in
            searching_ = false;
            return;
        }
        const std::uint32_t of_pass = search_at_ % (search_rings * trials), ring = of_pass / trials + 1;
        const bool picky = search_at_ < search_rings * trials;
        const dvec3 at = eye_ + ring * ring_m * walker_parts::direction((of_pass % trials) / static_cast<double>(trials));
        const double top = picky ? feet_.y + body_.step_m : eye_.y;
        gather_moving_there(at - dvec3(0, body_.eye_m, 0));
        const dvec3 feet{at.x, footing(at, top, eye_.y - body_.eye_m - 1.0).floor, at.z};
        if (!std::isfinite(feet.y) || !is_free(feet) || is_inside_solid(feet, place_sight_m) || is_in_any(feet)) continue;
        if (picky && !sees(feet + dvec3(0, body_.eye_m, 0))) continue;
        free_at(feet);
    }
}

/// What moves is known around the feet alone: now around a place where they may go.
void Walker::gather_moving_there(const dvec3& feet) {
    if (!moving_.exist()) return;
    const double wide_m = body_.radius_m + walker_parts::skin_m;
    Box box{feet - dvec3(wide_m, below_floor_m, wide_m), feet + dvec3(wide_m, body_.eye_m + crown_m, wide_m)};
    moving_.gather(box, place_sight_m, time_s_, time_s_);
}

/// Whether nothing that moves is there now.
bool Walker::is_left_free(const dvec3& feet) {
    if (!moving_.exist()) return true;
    gather_moving_there(feet);
    Capsule body = capsule_at(feet);
    body.radius -= walker_parts::max_overlap_m;
    bool clear = !is_in_any(feet);
    moving_.for_triangles(walker_parts::swept(body, dvec3(0.0)), [&](const GroundTriangle& t, std::uint32_t) {
        clear = clear && (min_separation(body, t) >= body.radius || separation(body, t).distance >= body.radius);
    });
    return clear;
}

/// Put beside what it was in: that is where it stood up.
void Walker::free_at(const dvec3& feet) {
    ++freed_;
    stand_at(feet);
    stood_up_at_ = feet;
    start_is_free_ = true;
}

void Walker::stand_at(const dvec3& feet) {
    feet_ = feet;
    eye_ = feet + dvec3(0, body_.eye_m, 0);
    supported_ = true;
    support_ = no_thing;  // if it moves, the next step finds it
    steep_ = searching_ = going_back_ = false;
    fall_m_s = eye_m_s = 0;
    pushed_s_ = 0;
    trial_ = 0;
    tried_from_ = feet;
}

/// Goes on with the trial of a direction: a tenth of a metre at once, as over a small step; then in steps, as along a narrow
/// ledge. The first of these that leads nowhere ends the direction.
bool Walker::trial_gets_on() {
    const Attempt here{feet_, supported_, steep_, Barrier::clear};
    const std::uint32_t step = trial_ % trial_steps, number = trial_ / trial_steps;
    if (step <= 1) trial_from_ = here.feet, trial_at_ = here;
    const dvec3 way = trial_m * walker_parts::direction(static_cast<double>(number) / trials);
    feet_ = trial_at_.feet, supported_ = trial_at_.supported, steep_ = trial_at_.steep;
    const Attempt to = attempt(step == 0 ? way : way / (trial_steps - 1.0));
    trial_ += step > 0 && glm::length(to.feet - feet_) < min_step_m ? trial_steps - step : 1;
    feet_ = here.feet, supported_ = here.supported, steep_ = here.steep;
    trial_at_ = to;
    return glm::length(to.feet - trial_from_) >= 0.9 * trial_m;
}

/// Stuck: pushed for a second without getting on, and none of 16 directions moves a tenth of a metre.
void Walker::watch(const dvec3& move, double dt_s) {
    if (glm::length(feet_ - tried_from_) >= trial_m) {
        tried_from_ = feet_;
        pushed_s_ = 0;
        trial_ = 0;
        going_back_ = false;
        return;
    }
    if (move == dvec3(0.0)) return;
    if (going_back_) return go_back_on();
    pushed_s_ += dt_s;
    if (pushed_s_ < stuck_after_s) return;
    if (trial_gets_on()) {
        pushed_s_ = 0;
        trial_ = 0;
    } else if (trial_ == trials * trial_steps) {
        trial_ = 0;
        pushed_s_ = 0;
        stuck_s_ = shown_stuck_s;
        go_back();
    }
}

const dvec3& Walker::newest_free_place() const { return free_places_[(free_first_ + free_count_ - 1) % max_free_places]; }

void Walker::remember_free_place() {
    if (steep_ || support_ != no_thing) return;  // one only slides on from there, or it is elsewhere later
    if (going_back_) return;                     // it is stuck here
    const dvec3& last = free_count_ > 0 ? newest_free_place() : stood_up_at_;
    if (glm::length(feet_ - last) < free_every_m || glm::length(feet_ - stood_up_at_) < free_every_m) return;
    if (free_count_ == max_free_places)
        free_first_ = (free_first_ + 1) % max_free_places;
    else
        ++free_count_;
    free_places_[(free_first_ + free_count_ - 1) % max_free_places] = feet_;
    ++new_places_;
}

/// To the place before the newest. If it is stuck again soon, a way in may have no way out: each time four times as far, and at
/// last to where it stood up.
void Walker::go_back() {
    const bool again = gone_back_ > 0 && new_places_ <= 2 * gone_back_;
    const std::uint32_t wanted = again ? 4 * gone_back_ : 1;
    new_places_ = 0;
    if (wanted < free_count_ || (!again && free_count_ > 0)) {
        const std::uint32_t by = std::min(wanted, free_count_ - 1);
        gone_back_ = std::max(by, 1U);
        free_count_ -= by;
        going_back_ = true;
        return go_back_on();
    }
    go_back_to_start(free_count_ > 0);
}

/// To the newest place that nothing which moves is at. A tick looks at few of them, as a search does.
void Walker::go_back_on() {
    for (std::uint32_t i = 0; i < search_a_tick && free_count_ > 0; ++i, --free_count_, ++gone_back_) {
        if (!is_left_free(newest_free_place())) continue;
        ++returns_;
        stand_at(newest_free_place());
        return;
    }
    if (free_count_ == 0) go_back_to_start(true);
}

/// To where it stood up, if it was elsewhere and nothing is there now. Else to the nearest free place.
void Walker::go_back_to_start(bool was_elsewhere) {
    const bool to_start = was_elsewhere && start_is_free_ && is_left_free(stood_up_at_);
    free_count_ = gone_back_ = 0;
    going_back_ = false;
    if (to_start) {
        ++returns_;
        stand_at(stood_up_at_);
    } else {
        searching_ = true;
        search_at_ = 1;
    }
}

}  // namespace surefoot::model
