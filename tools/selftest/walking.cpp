// Rows: visitors at thin walls, in sharp corners, on stairs of exactly a step, over cracks, far from the origin and at odd
// scales.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/bake/ground_build.hpp"
#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

using Triangles = std::vector<model::GroundTriangle>;

void quad(Triangles& to, const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    to.push_back({a, b, c});
    to.push_back({a, c, d});
}

void floor_of(Triangles& to, double x0, double x1, double z0, double z1, double y) {
    quad(to, {x0, y, z0}, {x0, y, z1}, {x1, y, z1}, {x1, y, z0});
}

void wall_of(Triangles& to, const dvec2& a, const dvec2& b, double low, double high) {
    quad(to, {a.x, low, a.y}, {b.x, low, b.y}, {b.x, high, b.y}, {a.x, high, a.y});
}

/// Turned about the vertical through the origin, then moved.
model::Ground placed_ground(const Triangles& triangles, double turn, const dvec3& move) {
    Triangles moved;
    const auto place = [&](const dvec3& p) {
        return move + dvec3(p.x * std::cos(turn) - p.z * std::sin(turn), p.y, p.x * std::sin(turn) + p.z * std::cos(turn));
    };
    for (const model::GroundTriangle& t : triangles) moved.push_back({place(t.a), place(t.b), place(t.c)});
    model::Ground ground;
    bake::append(ground, bake::build_tree(moved, 1.0 / 4096));
    model::index_instances(ground);
    return ground;
}

/// A way in the turned frame.
dvec3 turned(const dvec3& v, double turn) {
    return {v.x * std::cos(turn) - v.z * std::sin(turn), v.y, v.x * std::sin(turn) + v.z * std::cos(turn)};
}

double overlap_of(const model::Ground& ground, const model::Walker& walker) {
    const model::Capsule body = walker.capsule_at(walker.feet());
    Box box{body.low - 1.0, body.low + 1.0};
    box.max.y += body.length;
    double apart = body.radius;
    model::for_triangles_near(ground, box,
                              [&](const model::GroundTriangle& t) { apart = std::min(apart, separation(body, t).distance); });
    return body.radius - apart;
}

void thin_walls(const Effort& effort, Outcome& out) {
    Random random(41);
    std::uint64_t behind = 0, pushes = 0;
    double worst = 0;
    for (std::uint64_t run = effort.count(400, 20); run > 0 && !effort.stopped(); --run) {
        Triangles t;
        floor_of(t, -30, 30, -30, 30, 0);
        wall_of(t, {3, -30}, {3, 30}, 0, 3);
        wall_of(t, {3.0001, 30}, {3.0001, -30}, 0, 3);
        const double turn = random.range(0, 6.28), speed = random.range(0.1, 6), tick_s = random.range(0.001, 0.05);
        const model::Ground ground = placed_ground(t, turn, dvec3(0.0));
        model::Walker walker(ground, {});
        dvec3 eye{0, 1.7, 0};
        const dvec3 way = turned({speed, 0, random.range(-2, 2) * speed}, turn);
        for (double s = 0; s < 5; s += tick_s, ++pushes) eye = walker.walk(eye, eye + way * tick_s, tick_s);
        worst = std::max(worst, overlap_of(ground, walker));
        behind += turned(eye, -turn).x > 3 ? 1 : 0;
    }
    out.none_of("visitors behind the wall", behind);
    out.at_most("overlap with it", worst, 0.001, "m");
    out.at_least("pushes", static_cast<double>(pushes), 1000);
    out.digest_of(behind);
}

void sharp_corners(const Effort& effort, Outcome& out) {
    Random random(42);
    double worst = 0, restless = 0;
    std::uint64_t inside = 0;
    for (std::uint64_t run = effort.count(200, 20); run > 0 && !effort.stopped(); --run) {
        Triangles t;
        floor_of(t, -30, 30, -30, 30, 0);
        const double half = std::numbers::pi / 360;  // half of a degree
        wall_of(t, {20, 0}, {-20, 40 * std::tan(half)}, 0, 3);
        wall_of(t, {20, 0}, {-20, -40 * std::tan(half)}, 0, 3);
        const double turn = random.range(0, 6.28);
        const model::Ground ground = placed_ground(t, turn, dvec3(0.0));
        model::Walker walker(ground, {});
        dvec3 eye = turned({-21, 1.7, random.range(-0.1, 0.1)}, turn), before = eye;
        for (int i = 0; i < 6000; ++i) {
            if (i == 5900) before = eye;
            eye = walker.walk(eye, eye + turned({0.012, 0, random.range(-0.002, 0.002)}, turn), 0.004);
        }
        worst = std::max(worst, overlap_of(ground, walker));
        restless = std::max(restless, glm::length(eye - before));
        const dvec3 at = turned(eye, -turn);
        inside += std::abs(at.z) > (20 - at.x) * std::tan(half) + 1e-6 && at.x > -20 && at.x < 20 ? 1 : 0;
    }
    out.none_of("visitors who left the wedge through a side", inside);
    out.at_most("overlap with its sides", worst, 0.001, "m");
    out.at_most("way of one who is pushed on in its end, in 0.4 s", restless, 0.05, "m");
    out.digest_of(inside);
}

void stairs(const Effort& effort, Outcome& out) {
    Random random(43);
    std::uint64_t stuck = 0, low = 0;
    double worst = 0;
    for (std::uint64_t run = effort.count(200, 16); run > 0 && !effort.stopped(); --run) {
        Triangles t;
        floor_of(t, -10, 10, -5, 5, 0);
        const double tread = random.range(0.25, 0.5);
        for (int i = 0; i < 12; ++i) {
            const double x = 2 + i * tread, y = 0.25 * i;
            wall_of(t, {x, -5}, {x, 5}, y, y + 0.25);
            floor_of(t, x, i == 11 ? x + 6 : x + tread, -5, 5, y + 0.25);
        }
        const double turn = random.range(0, 6.28), speed = random.range(0.3, 2);
        const dvec3 move = any_in(random, dvec3(-9), dvec3(9));
        const model::Ground ground = placed_ground(t, turn, move);
        model::Walker walker(ground, {});
        dvec3 eye = move + dvec3(0, 1.7, 0);
        const double up_s = (2 + 12 * tread + 2) / speed;
        for (double s = 0; s < 1.2 * up_s; s += 0.004) {
            eye = walker.walk(eye, eye + turned({speed * 0.004, 0, 0}, turn), 0.004);
            worst = std::max(worst, overlap_of(ground, walker));
        }
        low += std::abs(eye.y - move.y - 1.7 - 3) > 0.01 ? 1 : 0;
        for (double s = 0; s < 2 * up_s; s += 0.004) eye = walker.walk(eye, eye - turned({speed * 0.004, 0, 0}, turn), 0.004);
        stuck += std::abs(eye.y - move.y - 1.7) > 0.01 ? 1 : 0;
    }
    out.none_of("stairs whose top was not reached", low);
    out.none_of("stairs that were not come down again", stuck);
    out.at_most("overlap on the way", worst, 0.01, "m");
    out.digest_of(low + stuck);
}

void cracks(const Effort& effort, Outcome& out) {
    Random random(44);
    double lowest = 0;
    std::uint64_t stopped = 0;
    for (std::uint64_t run = effort.count(100, 10); run > 0 && !effort.stopped(); --run) {
        Triangles t;
        std::vector<double> at{-10};
        while (at.back() < 10) at.push_back(at.back() + random.range(0.05, 1));
        for (std::size_t i = 0; i + 1 < at.size(); ++i) floor_of(t, at[i] + 0.001, at[i + 1], -10, 10, 0);
        const double turn = random.range(0, 6.28);
        const model::Ground ground = placed_ground(t, turn, dvec3(0.0));
        model::Walker walker(ground, {});
        dvec3 eye = turned({-8, 1.7, 0}, turn);
        const dvec3 way = turned({1.4, 0, random.range(-0.5, 0.5)}, turn);
        for (int i = 0; i < 2500; ++i) {
            eye = walker.walk(eye, eye + way * 0.004, 0.004);
            lowest = std::max(lowest, 1.7 - eye.y);
        }
        stopped += glm::length(eye - turned({-8, 1.7, 0}, turn)) < 13 ? 1 : 0;
    }
    out.at_most("sinking over cracks", lowest, 0.001, "m");
    out.none_of("visitors who were stopped", stopped);
    out.digest_of(stopped);
}

/// A court with a wall, a step and a low platform.
Triangles court() {
    Triangles t;
    floor_of(t, -10, 10, -10, 10, 0);
    wall_of(t, {4, -10}, {4, 10}, 0, 3);
    floor_of(t, -6, -2, -10, 10, 0.25);
    wall_of(t, {-2, -10}, {-2, 10}, 0, 0.25);
    floor_of(t, -10, -6, -10, 10, 0.9);
    wall_of(t, {-6, -10}, {-6, 10}, 0.25, 0.9);
    return t;
}

void far_away(const Effort& effort, Outcome& out) {
    double off = 0;
    std::uint64_t steps = 0;
    const model::Ground near = placed_ground(court(), 0, dvec3(0.0));
    for (const dvec3& far : {dvec3(1024, 2048, -4096), dvec3(6.4e6, 0, 0), dvec3(-4e6, 3e6, 4.5e6), dvec3(1e7, -1e7, 1e7)}) {
        const model::Ground ground = placed_ground(court(), 0, far);
        model::Walker here(near, {}), there(ground, {});
        Random random(45);
        dvec3 a{0, 1.7, 0}, b = far + a;
        double heading = 0;
        for (std::uint64_t i = effort.count(40'000, 2000); i > 0 && !effort.stopped(); --i, ++steps) {
            heading += random.range(-0.02, 0.02);
            const dvec3 way = 0.004 * dvec3(std::cos(heading), 0, std::sin(heading));
            a = here.walk(a, a + way, 0.004);
            b = there.walk(b, b + way, 0.004);
            off = std::max(off, glm::length(b - far - a));
            if (i % 500 == 0) b = far + a;  // differences of rounding do not add up: who stands at an edge may fall or not
        }
    }
    out.at_most("difference to the same walk at the origin", off, 0.05, "m");
    out.at_least("steps", static_cast<double>(steps), 4000);
    out.digest_of(steps);
}

void odd_scales(const Effort& effort, Outcome& out) {
    double sunk = 0;
    std::uint64_t wrong = 0;
    for (const double size : {1e-3, 0.1, 100.0, 1e4, 1e6}) {
        Triangles t;
        floor_of(t, -size / 2, size / 2, -size / 2, size / 2, 0);
        const model::Ground ground = placed_ground(t, 0.3, dvec3(0.0));
        wrong += model::validate(ground).ok() ? 0 : 1;
        Random random(46);
        for (std::uint64_t run = effort.count(40, 8); run > 0 && !effort.stopped(); --run) {
            model::Walker walker(ground, {});
            dvec3 eye = turned({random.range(-0.3, 0.3) * size, 1.7, random.range(-0.3, 0.3) * size}, 0.3);
            for (int i = 0; i < 500; ++i) {
                eye = walker.walk(eye, eye + dvec3(0.004, 0, 0.002), 0.004);
                wrong += std::isfinite(eye.x + eye.y + eye.z) ? 0 : 1;
                if (size >= 100) sunk = std::max(sunk, std::abs(eye.y - 1.7));
            }
        }
    }
    out.none_of("grounds that are not valid, or eyes that are nowhere", wrong);
    out.at_most("sinking into floors 100 m to 1000 km wide", sunk, 0.002, "m");
    out.digest_of(wrong);
}

}  // namespace

std::span<const Row> walking_rows() {
    static constexpr std::array<Row, 6> table = {{
        {"W1", "walking", "visitors pushed at a wall 0.1 mm thick, at 0.1 to 6 m/s, in steps of 1 to 50 ms, at any angle",
         "nobody passes; the body keeps off it", thin_walls},
        {"W2", "walking", "visitors pushed into a wedge of one degree between two walls", "they come to rest in it",
         sharp_corners},
        {"W3", "walking", "stairs with twelve steps of exactly the step height, in any direction, at 0.3 to 2 m/s",
         "they are climbed and come down, without touching them", stairs},
        {"W4", "walking", "floors of strips 5 cm to 1 m wide with cracks of a millimetre", "nobody sinks or is stopped", cracks},
        {"W5", "walking", "the same walk at the origin and up to 17 000 km from it", "it is the same", far_away},
        {"W6", "walking", "floors from a millimetre to a thousand kilometres wide", "they carry, or the walk goes on",
         odd_scales},
    }};
    return table;
}

}  // namespace surefoot::selftest
