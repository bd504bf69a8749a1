// Rows: visitors on lifts and turning platforms, and at doors that slide, swing and close on them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/bake/ground_build.hpp"
#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"
#include "render/model/model.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

using Faces = std::vector<model::GroundTriangle>;

void rectangle(Faces& to, const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    to.push_back({a, b, c});
    to.push_back({a, c, d});
}

void block(Faces& to, const dvec3& min, const dvec3& max) {
    const dvec3 a(min), g(max);
    rectangle(to, {a.x, a.y, a.z}, {g.x, a.y, a.z}, {g.x, a.y, g.z}, {a.x, a.y, g.z});
    rectangle(to, {a.x, g.y, a.z}, {a.x, g.y, g.z}, {g.x, g.y, g.z}, {g.x, g.y, a.z});
    rectangle(to, {a.x, a.y, a.z}, {a.x, g.y, a.z}, {g.x, g.y, a.z}, {g.x, a.y, a.z});
    rectangle(to, {a.x, a.y, g.z}, {g.x, a.y, g.z}, {g.x, g.y, g.z}, {a.x, g.y, g.z});
    rectangle(to, {a.x, a.y, a.z}, {a.x, a.y, g.z}, {a.x, g.y, g.z}, {a.x, g.y, a.z});
    rectangle(to, {g.x, a.y, a.z}, {g.x, g.y, a.z}, {g.x, g.y, g.z}, {g.x, a.y, g.z});
}

/// A thing at rest, and its motion.
struct Mover {
    Faces faces;
    std::vector<model::MotionKey> keys;
    dvec3 pivot{0.0};
};

model::MotionKey key_at(double time_s, const dvec3& translation, double turn_rad = 0) {
    return {time_s, translation, {0, static_cast<float>(std::sin(turn_rad / 2)), 0, static_cast<float>(std::cos(turn_rad / 2))}};
}

/// Of its ground and its motions alone.
model::Model moving_model(const Faces& still, const std::vector<Mover>& movers) {
    model::Model model;
    bake::append(model.ground, bake::build_tree(still, bake::made_lattice_m));
    model::index_instances(model.ground);
    for (const Mover& mover : movers) bake::append_moving(model, mover.faces, mover.pivot, mover.keys);
    model::index_moving_ground(model);
    return model;
}

/// How deep the body is in any of the triangles, moved by a pose.
double depth_in(const Faces& faces, const model::RigidPose& pose, const model::Walker& walker) {
    const model::Capsule body = walker.capsule_at(walker.feet());
    double apart_m = body.radius;
    for (const model::GroundTriangle& t : faces)
        apart_m = std::min(apart_m, model::separation(body, {pose(t.a), pose(t.b), pose(t.c)}).distance);
    return body.radius - apart_m;
}

/// A platform that goes up, waits, comes down and waits; or a cabin with three sides and a roof.
Mover lift(double half_m, double way_m, double speed_m_s, bool cabin) {
    Mover of;
    block(of.faces, {-half_m, -0.2, -half_m}, {half_m, 0, half_m});
    if (cabin) {
        block(of.faces, {-half_m, 0, -half_m - 0.05}, {half_m, 2.3, -half_m});
        block(of.faces, {-half_m - 0.05, 0, -half_m}, {-half_m, 2.3, half_m});
        block(of.faces, {half_m, 0, -half_m}, {half_m + 0.05, 2.3, half_m});
        block(of.faces, {-half_m, 2.3, -half_m}, {half_m, 2.35, half_m});
    }
    const double takes_s = way_m / speed_m_s;
    of.keys = {key_at(0, dvec3(0.0)), key_at(takes_s, {0, way_m, 0}), key_at(takes_s + 1, {0, way_m, 0}),
               key_at(2 * takes_s + 1, dvec3(0.0)), key_at(2 * takes_s + 2, dvec3(0.0))};
    return of;
}

void lifts(const Effort& effort, Outcome& out) {
    Random random(47);
    double drift_m = 0, off_floor_m = 0, eye_off_m = 0;
    std::uint64_t left_behind = 0, loops = 0;
    for (std::uint64_t run = effort.count(20, 3); run > 0 && !effort.stopped(); --run) {
        Faces still;
        block(still, {-20, -1.2, -20}, {20, -0.21, 20});
        const double half_m = random.range(0.6, 2), speed_m_s = random.range(0.3, 3);
        const double way_m = random.range(1, 9);
        const bool cabin = run % 2 == 0;
        Mover of = lift(half_m, way_m, speed_m_s, cabin);
        if (run % 3 == 0)  // there is no pit: it goes level
            for (model::MotionKey& key : of.keys) key.translation = dvec3(0.6, 0, 0.8) * key.translation.y;
        const model::Model model = moving_model(still, {of});
        model::Walker walker(model, {});
        const double tick_s = random.range(0.002, 0.02), period_s = of.keys.back().time_s;
        const dvec3 start{random.range(-0.2, 0.2), 1.7, random.range(-0.2, 0.2)};
        dvec3 eye = walker.walk(start, start + dvec3(1e-9, 0, 0), tick_s);
        const dvec3 stood = walker.feet();
        for (double time_s = tick_s; time_s < 100 * period_s && !effort.stopped(); time_s += tick_s) {
            walker.set_time(time_s);
            eye = walker.walk(eye, eye, tick_s);
            const dvec3 at = model::pose_at(model, 0, time_s).back(walker.feet());
            drift_m = std::max(drift_m, std::hypot(at.x - stood.x, at.z - stood.z));
            off_floor_m = std::max(off_floor_m, std::abs(at.y));
            eye_off_m = std::max(eye_off_m, std::abs(eye.y - walker.feet().y - 1.7));
            left_behind += walker.supported() ? 0 : 1;
        }
        loops += 100;
    }
    out.at_most("drift over the platform in 100 loops", drift_m, 0.001, "m");
    out.at_most("feet above or below it", off_floor_m, 0.001, "m");
    out.at_most("change of the eye's height over the feet", eye_off_m, 0.001, "m");
    out.none_of("steps without a floor", left_behind);
    out.at_least("loops", static_cast<double>(loops), 300);
    out.digest_of(left_behind);
}

void turning_platforms(const Effort& effort, Outcome& out) {
    Random random(48);
    double drift_m = 0, turn_off_rad = 0;
    std::uint64_t left_behind = 0;
    for (std::uint64_t run = effort.count(20, 3); run > 0 && !effort.stopped(); --run) {
        Mover of;
        block(of.faces, {-4, -0.2, -4}, {4, 0, 4});
        const double turn_s = random.range(3, 20), side = run % 2 == 0 ? 1 : -1;
        for (int k = 0; k <= 8; ++k) of.keys.push_back(key_at(turn_s * k / 8, dvec3(0.0), side * k * std::numbers::pi / 4));
        Faces still;
        block(still, {-20, -1.2, -20}, {20, -0.21, 20});
        const model::Model model = moving_model(still, {of});
        model::Walker walker(model, {});
        const double tick_s = random.range(0.002, 0.02);
        const dvec3 start{random.range(-3.5, 3.5), 1.7, random.range(-3.5, 3.5)};
        dvec3 eye = walker.walk(start, start + dvec3(1e-9, 0, 0), tick_s);
        const dvec3 stood = walker.feet();
        double turned_rad = 0, time_s = tick_s;
        for (; time_s < 100 * turn_s && !effort.stopped(); time_s += tick_s) {
            walker.set_time(time_s);
            eye = walker.walk(eye, eye, tick_s);
            turned_rad += walker.ride().turn_rad;
            drift_m = std::max(drift_m, glm::length(model::pose_at(model, 0, time_s).back(walker.feet()) - stood));
            left_behind += walker.supported() ? 0 : 1;
        }
        turn_off_rad = std::max(turn_off_rad, std::abs(turned_rad - side * 2 * std::numbers::pi * (time_s - tick_s) / turn_s));
    }
    out.at_most("drift over the platform in 100 turns", drift_m, 0.001, "m");
    out.at_most("difference of the visitor's turn", turn_off_rad, 0.01, "rad");
    out.none_of("steps without a floor", left_behind);
    out.digest_of(left_behind);
}

/// A wall with an opening 1.2 m wide, and a leaf that slides or swings into it: open for 4 s, shut for 4 s.
struct Doorway {
    Faces still;
    Mover leaf;
    double moves_s = 1;

    Doorway(bool slides, double seconds) : moves_s(seconds) {
        block(still, {-8, -1, -8}, {8, 0, 8});
        block(still, {-8, 0, -0.1}, {-0.6, 3, 0.1});
        block(still, {0.6, 0, -0.1}, {8, 3, 0.1});
        block(still, {-0.6, 2.3, -0.1}, {0.6, 3, 0.1});
        block(leaf.faces, {-0.59, 0.01, -0.02}, {0.59, 2.29, 0.02});
        leaf.pivot = {-0.59, 0, 0};
        const auto open = [&](double time_s) {
            return slides ? key_at(time_s, {-1.19, 0, 0}) : key_at(time_s, dvec3(0.0), std::numbers::pi / 2);
        };
        const auto shut = [](double time_s) { return key_at(time_s, dvec3(0.0)); };
        leaf.keys = {open(0), open(4), shut(4 + moves_s), shut(8 + moves_s), open(8 + 2 * moves_s)};
    }
    [[nodiscard]] double period_s() const { return leaf.keys.back().time_s; }
    [[nodiscard]] bool is_shut(double time_s) const {
        const double at = std::fmod(time_s, period_s());
        return at > 4 + moves_s && at < 8 + moves_s;
    }
};

/// Figures of visitors at doors.
struct AtDoors {
    std::uint64_t passed_shut = 0, in_walls = 0, in_doors = 0, kept = 0, went_through = 0;
};

/// Pushes to and fro through a doorway at random for some minutes. Stands still in it now and then.
void visit(const Doorway& door, std::uint64_t seed, double seconds, AtDoors& found) {
    Random random(seed);
    const model::Model model = moving_model(door.still, {door.leaf});
    model::Walker walker(model, {});
    const double tick_s = random.range(0.002, 0.05), speed = random.range(0.3, 2);
    dvec3 eye{random.range(-0.2, 0.2), 1.7, -2}, goal{random.range(-0.2, 0.2), 0, 2};
    double goal_since_s = 0, side_before = -1;
    bool shut_before = false, steps_back = false;
    for (double time_s = 0; time_s < seconds; time_s += tick_s) {  // NOLINT(clang-analyzer-security.FloatLoopCounter): a clock
        dvec3 way(goal.x - eye.x, 0, goal.z - eye.z);
        const bool rests = random.below(4) == 0;  // now and then it stands in the way
        if (const double length = glm::length(way); length > speed * tick_s) way *= speed * tick_s / length;
        walker.set_time(time_s);
        const std::uint64_t jumps = walker.put_aside();
        eye = walker.walk(eye, eye + (rests && time_s > 0 ? dvec3(0.0) : way), tick_s);
        const bool jumped = walker.put_aside() != jumps, passing = walker.passing() > 0;
        const double side = walker.feet().z > 0 ? 1 : -1;
        const bool shut = door.is_shut(time_s);
        if (side != side_before && shut && shut_before && !jumped && !passing) ++found.passed_shut;
        if (side != side_before) ++found.went_through;
        side_before = side, shut_before = shut;
        if (depth_in(door.still, {}, walker) > 0.01) ++found.in_walls;
        if (!passing && depth_in(door.leaf.faces, model::pose_at(model, 0, time_s), walker) > 0.01) ++found.in_doors;
        goal_since_s += tick_s;
        if (std::hypot(goal.x - eye.x, goal.z - eye.z) < 0.1) {
            goal = {random.below(3) == 0 ? 0 : random.range(-0.2, 0.2), 0, goal.z > 0 ? -random.range(0, 2) : random.range(0, 2)};
            goal_since_s = 0, steps_back = false;
        } else if (goal_since_s > 2 * door.period_s()) {  // a leaf that opens towards it keeps it behind: it steps back
            found.kept += steps_back ? 1 : 0;
            goal = {0, 0, 2.5 * side};
            goal_since_s = 0, steps_back = true;
        }
    }
}

void doors(const Effort& effort, Outcome& out) {
    AtDoors found;
    for (std::uint64_t run = effort.count(80, 8); run > 0 && !effort.stopped(); --run)
        visit(Doorway(run % 2 == 0, run % 4 < 2 ? 0.3 : 1.5), run, 200, found);
    out.none_of("visitors who passed a door that was shut", found.passed_shut);
    out.none_of("steps in a wall", found.in_walls);
    out.none_of("steps in a door that does not pass through", found.in_doors);
    out.none_of("visitors who could not even step back", found.kept);
    out.at_least("ways through", static_cast<double>(found.went_through), 40);
    out.digest_of(found.passed_shut + found.in_walls + found.in_doors + found.kept);
}

/// A wall, thin or thick, comes from x = 0 against a thin one that stands at x = 3, and goes back.
void presses(const Effort& effort, Outcome& out) {
    Random random(49);
    std::uint64_t got_past = 0, behind = 0, in_walls = 0, held = 0, squeezed = 0;
    for (std::uint64_t run = effort.count(200, 24); run > 0 && !effort.stopped(); --run) {
        Faces still;
        block(still, {-9, -1, -9}, {9, 0, 9});
        block(still, {3, 0, -9}, {3.01, 3, 9});
        Mover of;
        block(of.faces, {run % 2 == 0 ? -0.02 : -1.5, 0, -8}, {0, 2.5, 8});
        const double speed = random.range(0.3, 8), tick_s = random.range(0.002, 0.05), takes_s = 2.99 / speed;
        of.keys = {key_at(0, dvec3(0.0)), key_at(1, dvec3(0.0)), key_at(1 + takes_s, {2.99, 0, 0}),
                   key_at(2 + takes_s, {2.99, 0, 0}), key_at(6 + 2 * takes_s, dvec3(0.0))};
        const model::Model model = moving_model(still, {of});
        model::Walker walker(model, {});
        dvec3 eye{random.range(0.6, 2.4), 1.7, random.range(-1, 1)};
        eye = walker.walk(eye, eye + dvec3(0, 0, 1e-9), tick_s);
        double time_s = 0;
        bool counted = false;
        for (; time_s < 2 + takes_s; time_s += tick_s) {  // NOLINT(clang-analyzer-security.FloatLoopCounter): a clock
            walker.set_time(time_s);
            eye = walker.walk(eye, eye, tick_s);
            const model::RigidPose pose = model::pose_at(model, 0, time_s);
            const bool has_room = pose.translation.x < 3 - 0.65;
            const bool evaded = walker.put_aside() + walker.passed_through() > 0;
            if (has_room && !counted && (eye.x < pose.translation.x || evaded)) ++got_past, counted = true;
            in_walls += depth_in(still, {}, walker) > 0.01 ? 1 : 0;
        }
        squeezed += walker.put_aside() + walker.passed_through() > 0 ? 1 : 0;
        behind += eye.x > 3 ? 1 : 0;
        const dvec3 before = eye;
        const double end_s = time_s + 1.5;
        while (time_s < end_s) {
            walker.set_time(time_s);
            eye = walker.walk(eye, eye - dvec3(tick_s, 0, 0), tick_s);
            time_s += tick_s;
        }
        held += eye.x > before.x - 1 ? 1 : 0;
    }
    out.none_of("walls that got past a visitor who had room", got_past);
    out.none_of("visitors put behind the wall that stands still", behind);
    out.none_of("steps in a wall that stands still", in_walls);
    out.none_of("visitors held afterwards", held);
    out.at_least("visitors who had no room", static_cast<double>(squeezed), 24);
    out.digest_of(got_past + behind + in_walls + held);
}

}  // namespace

std::span<const Row> riding_rows() {
    static constexpr std::array<Row, 4> table = {{
        {"W7", "riding",
         "visitors who stand in lifts and on sliding platforms, 0.3 to 3 m/s, for 100 loops, in steps of 2 to 20 ms",
         "they are carried, and drift by less than a millimetre", lifts},
        {"W8", "riding", "visitors who stand on platforms that turn once in 3 to 20 s, for 100 turns",
         "they are carried and turned, and drift by less than a millimetre", turning_platforms},
        {"W9", "riding", "visitors in a doorway while its door slides or swings, in 0.3 or 1.5 s, in steps of 2 to 50 ms",
         "a shut door stops them, a closing one neither passes them nor traps them, and no wall is entered", doors},
        {"W10", "riding",
         "visitors between a wall that comes at 0.3 to 8 m/s and a thin one that stands still, in steps of 2 to 50 ms",
         "it pushes them while there is room, then passes them; nobody is held, or put behind the other wall", presses},
    }};
    return table;
}

}  // namespace surefoot::selftest
