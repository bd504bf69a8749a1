// Places where a walker is easily lost: trenches as wide as the body, mirrored solids, tables, and drops where edges do not stop.
#include <gtest/gtest.h>

#include <cmath>

#include "render/model/ground/walker.hpp"
#include "tests/ground/grounds.hpp"

namespace surefoot::test {

namespace {

Triangles floor_of(double half) {
    Triangles t;
    add_floor(t, -half, half, -half, half, 0);
    return t;
}

/// A floor, and a mesh that stands on it twice.
model::Ground with_two(const Triangles& mesh, const mat3& linear) {
    model::Ground ground;
    bake::append(ground, bake::build_tree(floor_of(20), 1.0 / 4096));
    bake::append(ground, bake::build_tree(mesh, 1.0 / 4096));
    ground.instances.push_back({dvec3(0), linear, 1});
    ground.instances.push_back({dvec3(8, 0, 0), linear, 1});
    model::index_instances(ground);
    return ground;
}

}  // namespace

TEST(OddPlaces, TheEyeStaysOverFeetThatHangInATrench) {
    for (const double speed : {0.6, 1.2, 1.4, 1.6, 3.0}) {
        for (const double width : {0.62, 0.65, 0.70, 0.8}) {
            Triangles t;
            add_floor(t, -5, 0, -5, 5, 0);
            add_floor(t, width, 5, -5, 5, 0);
            add_floor(t, 0, width, -5, 5, -0.9);
            add_wall(t, {0, -5}, {0, 5}, -0.9, 0);
            add_wall(t, {width, -5}, {width, 5}, -0.9, 0);
            const model::Ground ground = ground_of(t);
            model::Walker walker(ground, {});
            dvec3 eye(-1, 1.7, 0);
            double lowest_m = 9, highest_m = 0;
            for (int i = 0; i < 5000; ++i) {
                eye = walker.walk(eye, eye + dvec3(speed * tick_s, 0, 0), tick_s);
                lowest_m = std::min(lowest_m, eye.y - walker.feet().y);
                highest_m = std::max(highest_m, eye.y - walker.feet().y);
            }
            EXPECT_GE(lowest_m, 1.7 - 0.81) << speed << ' ' << width << ": as far behind as after steps";
            EXPECT_LE(highest_m, 1.7 + 0.91) << speed << ' ' << width << ": no more than the trench is deep";
            EXPECT_NEAR(eye.y - walker.feet().y, 1.7, 0.05) << speed << ' ' << width << ": at the end";
        }
    }
}

TEST(OddPlaces, MirroredThingsHaveTheirInsideInside) {
    Triangles solid, room;
    add_box(solid, {-0.8, -0.1, -0.8}, {0.8, 1.9, 0.8});
    for (const model::GroundTriangle& t : solid) room.push_back({t.a, t.c, t.b});
    for (const float side : {1.0F, -1.0F}) {
        const mat3 linear(vec3(side, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));
        for (const double x : {0.0, 8.0}) {
            const model::Ground solids = with_two(solid, linear), rooms = with_two(room, linear);
            model::Walker inside_solid(solids, {}), inside_room(rooms, {});
            const dvec3 out = push(inside_solid, {x, 1.7, 0}, {0.5, 0, 0.1}, 1),
                        in = push(inside_room, {x, 1.7, 0}, {0.5, 0, 0.1}, 1);
            EXPECT_EQ(inside_solid.freed(), 1U) << side << ' ' << x;
            EXPECT_GT(std::max(std::abs(out.x - x), std::abs(out.z)), 1) << side << ' ' << x;
            EXPECT_EQ(inside_room.freed(), 0U) << side << ' ' << x;
            EXPECT_LT(std::max(std::abs(in.x - x), std::abs(in.z)), 0.8) << side << ' ' << x;
        }
    }
}

TEST(OddPlaces, WhoIsPlacedOverATableStandsBesideIt) {
    for (const double height : {0.5, 0.75, 1.05}) {
        Triangles t = floor_of(10);
        add_box(t, {-0.4, height - 0.05, -0.6}, {0.4, height, 0.6});
        const model::Ground ground = ground_of(t);
        model::Walker walker(ground, {});
        const dvec3 eye = push(walker, {0, 1.7, 0}, {0.3, 0, 0}, 2);
        EXPECT_NEAR(walker.feet().y, 0, 1e-3) << height;
        EXPECT_NEAR(eye.y, 1.7, 1e-3) << height;
        model::Walker upon(ground, {});  // placed at its height over the table, it stands on it
        (void)push(upon, {0, height + 1.7, 0}, {0, 0, 0.1}, 0.1);
        EXPECT_NEAR(upon.feet().y, height, 1e-3) << height;
    }
}

TEST(OddPlaces, DropsBelowTheEdgeSettingAreFallenDownHoweverDeep) {
    for (const double drop : {2.0, 2.9, 3.2, 5.0, 8.0}) {
        Triangles t;
        add_floor(t, -5, 0, -5, 5, 0);
        add_floor(t, 0, 20, -5, 5, -drop);
        const model::Ground ground = ground_of(t);
        model::Body body;
        body.edge_m = 10;
        model::Walker walker(ground, body);
        const dvec3 eye = push(walker, {-1, 1.7, 0}, {1.4, 0, 0}, 5);
        EXPECT_NEAR(walker.feet().y, -drop, 1e-3) << drop;
        EXPECT_NEAR(eye.y, 1.7 - drop, 0.01) << drop;
    }
}

}  // namespace surefoot::test
