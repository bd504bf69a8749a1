// Things that move: floors carry, walls and doors push, shut doors stop, and where there is no room nobody is trapped.
#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "rt/threads/guard.hpp"
#include "tests/ground/moving_scenes.hpp"

namespace surefoot::test {

namespace {

MovingScene open_hall() {
    MovingScene scene;
    add_floor(scene.still, -20, 20, -20, 20, 0);
    return scene;
}

/// Two walls 0.2 m thick from floor to 3 m leave an opening from -0.6 to 0.6 in the plane z = 0.
void add_doorway(Triangles& to) {
    add_box(to, {-20, 0, -0.1}, {-0.6, 3, 0.1});
    add_box(to, {0.6, 0, -0.1}, {20, 3, 0.1});
}

/// A leaf before the opening; it is shut for 5 s, opens in 1 s, is open for 5 s.
MovingThing sliding_door() {
    MovingThing door;
    add_box(door.at_rest, {-0.6, 0, -0.03}, {0.6, 2.5, 0.03});
    door.stands = {{0, dvec3(0.0)}, {5, dvec3(0.0)}, {6, {1.3, 0, 0}}, {11, {1.3, 0, 0}}, {12, dvec3(0.0)}};
    return door;
}

/// Thin walls every 0.4 m, from -5 to 5 m: nobody is free between them. Outside of them are moving blocks, but for a strip beyond
/// x = 7.5 m.
MovingScene crowded_hall() {
    MovingScene scene = open_hall();
    for (int i = -12; i <= 12; ++i) add_wall(scene.still, {0.4 * i, -5}, {0.4 * i, 5}, 0, 4);
    const auto block = [&](const dvec3& min, const dvec3& max) { scene.things.push_back(platform(min, max, {0, 0.05, 0}, 1)); };
    block({-20, -0.3, 5}, {20, 4, 20});
    block({-20, -0.3, -20}, {20, 4, -5});
    block({-20, -0.3, -5}, {-5, 4, 5});
    block({5, -0.3, -5}, {7.5, 4, 5});
    return scene;
}

}  // namespace

TEST(Moving, WhoIsPutBesideWhatHeStoodInComesToNoPlaceWhereSomethingMoves) {
    const MovingScene scene = crowded_hall();
    Rider rider(scene, {0.1, 1.7, 0.3});
    rider.push({0.5, 0, 0}, 2);
    ASSERT_EQ(rider.walker.freed(), 1U);
    EXPECT_GT(rider.walker.feet().x, 7.8) << "all other places are inside of a moving block";
    EXPECT_LT(std::abs(rider.walker.feet().z), 5);
    EXPECT_EQ(rider.walker.passed_through(), 0U);
}

namespace {

constexpr double gate_shuts_s = 11;

/// A platform up to x = 2, and beside it a shaft as narrow as the body, 0.9 m deep; far behind it is another platform. After
/// gate_shuts_s a block stands on the first one, from `gate_from` to x = 1.95.
MovingScene shaft_with_a_gate(double gate_from) {
    MovingScene scene;
    add_floor(scene.still, -10, 2, -10, 10, 0.9);
    add_wall(scene.still, {2, -10}, {2, 10}, 0, 0.9);
    add_floor(scene.still, 2, 2.63, -0.32, 0.32, 0);
    add_wall(scene.still, {2.63, -10}, {2.63, 10}, 0, 4);
    for (const double z : {-0.32, 0.32}) add_wall(scene.still, {2, z}, {2.7, z}, 0, 4);
    add_floor(scene.still, 5, 9, -4, 4, 0.9);
    MovingThing gate;
    add_box(gate.at_rest, {gate_from, 0.8, -12}, {1.95, 4, 12});
    const dvec3 away(0, 40, 0);
    gate.stands = {{0, away}, {gate_shuts_s, away}, {gate_shuts_s, dvec3(0.0)}, {1000, dvec3(0.0)}};
    scene.things.push_back(gate);
    return scene;
}

/// Walks into the shaft, waits until the gate is shut, and pushes until it is put elsewhere. Returns for how many ticks it
/// pushed. A hand that trembles also pushes aside, to and fro.
int push_out_of_shaft(Rider& rider, double tremble_m_s = 0) {
    do rider.push({1.4, 0, 0}, 0.1);
    while (rider.time_s < 10 && rider.walker.feet().y > 0.01);
    EXPECT_NEAR(rider.walker.feet().y, 0, 0.01) << "it is in the shaft";
    rider.wait(gate_shuts_s + 0.5 - rider.time_s);
    int ticks = 0;
    const auto jumps = [&] { return rider.walker.returns() + rider.walker.freed(); };
    for (const double until_s = rider.time_s + 8; rider.time_s < until_s && jumps() == 0; ++ticks)
        rider.step({1, 0, ticks % 2 == 0 ? tremble_m_s : -tremble_m_s});
    EXPECT_EQ(jumps(), 1U);
    rider.push({0, 0, 0.5}, 1);
    EXPECT_EQ(rider.walker.put_aside() + rider.walker.passed_through(), 0U) << "nothing is where it was put";
    return ticks;
}

}  // namespace

TEST(Moving, AStuckWalkerGoesBackToNoPlaceWhereSomethingMovesNow) {
    Rider one(shaft_with_a_gate(1.65), {1.3, 2.6, 0});  // of the place at 1.8 m alone
    push_out_of_shaft(one);
    EXPECT_NEAR(one.eye.x, 1.3, 0.05) << "to where it stood up";
    Rider few(shaft_with_a_gate(0.2), {-2, 2.6, 0});
    push_out_of_shaft(few);
    EXPECT_EQ(few.walker.returns(), 1U);
    EXPECT_LT(few.eye.x, 0.2 - 0.3);
    EXPECT_GT(few.eye.x, 0.2 - 1) << "to the nearest of those that are free";
    Rider all(shaft_with_a_gate(-12), {-2, 2.6, 0});
    push_out_of_shaft(all);
    EXPECT_EQ(all.walker.freed(), 1U);
    EXPECT_GT(all.eye.x, 5) << "all of the first platform is shut";
}

TEST(Moving, AStuckWalkerLooksAtFewPlacesATick) {
    Rider first(shaft_with_a_gate(1.9), {-8, 2.6, 0}), last(shaft_with_a_gate(-6.2), {-8, 2.6, 0});
    const int ticks_to_first = push_out_of_shaft(first), ticks_to_last = push_out_of_shaft(last);
    EXPECT_GT(first.eye.x, 1);
    EXPECT_LT(last.eye.x, -6.45);
    EXPECT_GE(ticks_to_last - ticks_to_first, 6) << "fifteen places are shut";
    EXPECT_LT(ticks_to_last - ticks_to_first, 12);
}

/// While it looks for a free place among those that are shut, it moves a little where it is.
TEST(Moving, AStuckWalkerRemembersNoPlaceWhileItIsStuck) {
    Rider rider(shaft_with_a_gate(-6.2), {-8, 2.6, 0});
    push_out_of_shaft(rider, 0.5);
    EXPECT_EQ(rider.walker.returns(), 1U);
    EXPECT_LT(rider.eye.x, -6.45) << "before the gate, and not in the shaft again";
}

TEST(Moving, ALiftCarriesUpAndDownAndTheEyeKeepsItsHeight) {
    MovingScene scene = open_hall();
    scene.things.push_back(platform({-1, -0.1, -1}, {1, 0.02, 1}, {0, 4, 0}, 4));
    Rider rider(scene, {0.3, 1.72, -0.2});
    rider.step({1e-6, 0, 0});
    for (int i = 0; i < 5000; ++i) {
        rider.step(dvec3(0.0));
        const double floor = scene.things[0].at({0, 0.02, 0}, rider.time_s).y;
        ASSERT_NEAR(rider.walker.feet().y, floor, 3e-4) << rider.time_s;
        ASSERT_NEAR(rider.eye.y, floor + 1.7, 1e-3) << rider.time_s;
        ASSERT_TRUE(rider.walker.supported());
    }
    EXPECT_NEAR(rider.eye.x, 0.3, 1e-5);
    EXPECT_GT(scene.things[0].at({0, 0, 0}, 5.5).y, 3.9) << "it was up";
}

TEST(Moving, AFloorThatSlidesOrTurnsCarriesAndTurnsTheVisitor) {
    MovingScene scene = open_hall();
    scene.things.push_back(platform({-1, -0.1, -1}, {1, 0.2, 1}, {6, 0, 3}, 5));
    MovingThing turntable;
    add_box(turntable.at_rest, {-14, -0.1, -4}, {-6, 0.2, 4});
    turntable.pivot = {-10, 0, 0};
    for (int k = 0; k <= 4; ++k) turntable.stands.push_back({2.5 * k, dvec3(0.0), k * std::numbers::pi / 2});
    scene.things.push_back(turntable);
    Rider slid(scene, {0.5, 1.9, 0.5}), turned(scene, {-8, 1.9, 0.5});
    slid.time_s = turned.time_s = -tick_s;  // they stand up at time 0
    slid.step({1e-6, 0, 0}), turned.step({1e-6, 0, 0});
    double turn = 0;
    while (slid.time_s < 6.5) slid.step(dvec3(0.0));
    for (; turned.time_s < 5; turn += turned.walker.ride().turn_rad) turned.step(dvec3(0.0));
    EXPECT_LT(glm::length(slid.walker.feet() - dvec3(6.5, 0.2, 3.5)), 1e-3);
    EXPECT_LT(glm::length(turned.walker.feet() - scene.things[1].at({-8, 0.2, 0.5}, turned.time_s)), 1e-3);
    EXPECT_NEAR(turn, std::numbers::pi, 0.01) << "half a turn to the left";
}

TEST(Moving, WhoWalksOnAPlatformWalksThatMuchBesides) {
    MovingScene scene = open_hall();
    scene.things.push_back(platform({-3, -0.1, -3}, {3, 0.2, 3}, {8, 0, 0}, 8));
    Rider rider(scene, {0, 1.9, 0});
    rider.step({1e-6, 0, 0});
    while (rider.time_s < 2) rider.step(dvec3(0.0));
    const dvec3 before = rider.eye;
    rider.push({0, 0, 1}, 2);
    EXPECT_NEAR(rider.eye.x - before.x, 2, 0.01);
    EXPECT_NEAR(rider.eye.z - before.z, 2, 0.01);
}

TEST(Moving, AShutDoorStopsAndAnOpenOneLetsThrough) {
    MovingScene scene = open_hall();
    add_doorway(scene.still);
    scene.things.push_back(sliding_door());
    Rider rider(scene, {0, 1.7, -2});
    rider.push({0, 0, 1}, 4.5);
    EXPECT_NEAR(rider.eye.z, -0.331, 2e-3) << "at the leaf";
    EXPECT_EQ(rider.walker.barrier(), model::Barrier::wall);
    rider.push({0, 0, 1}, 4);
    EXPECT_GT(rider.eye.z, 1.5) << "it has opened";
    EXPECT_EQ(rider.walker.put_aside() + rider.walker.passed_through(), 0U);
}

TEST(Moving, AWallThatComesPushesAlongAndKeepsOff) {
    MovingScene scene = open_hall();
    scene.things.push_back(platform({-0.1, 0.3, -4}, {0, 2.5, 4}, {5, 0, 0}, 4));
    Rider rider(scene, {1, 1.7, 0.3});
    rider.step({0, 0, 1e-6});
    while (rider.time_s < 5.5) rider.step(dvec3(0.0));
    EXPECT_NEAR(rider.eye.x, 5.3, 5e-3) << "before it";
    EXPECT_NEAR(rider.eye.z, 0.3, 1e-3);
    EXPECT_EQ(rider.walker.put_aside() + rider.walker.passed_through(), 0U);
}

namespace {

/// A wall comes against another one: whoever is between them gets out of it at once, and through neither still wall nor floor.
void squeeze(double speed, double step_s, double thick_m) {
    MovingScene scene = open_hall();
    add_box(scene.still, {3, 0, -6}, {3.02, 3, 6});
    scene.things.push_back(platform({-thick_m, 0, -5}, {0, 2.5, 5}, {2.98, 0, 0}, 3 / speed));
    scene.things[0].stands.push_back({60, dvec3(0.0)});
    Rider rider(scene, {2.2, 1.7, 0.3});
    rider.step({0, 0, 1e-6}, step_s);
    const exact::ExactGround still = scene.still_judge();
    while (rider.time_s < 1.9 + 3 / speed) {
        rider.step(dvec3(0.0), step_s);
        const model::Capsule body = rider.walker.capsule_at(rider.walker.feet());
        ASSERT_LE(still.penetration(body.low, body.length, body.radius), 0.01);
        ASSERT_LT(rider.eye.x, 3);
        ASSERT_NEAR(rider.eye.y, 1.7, 1e-3);
    }
    EXPECT_GE(rider.walker.put_aside() + rider.walker.passed_through(), 1U);
    const dvec3 before = rider.eye;
    rider.push({-1.5, 0, 0}, 3, step_s);
    EXPECT_LT(rider.eye.x, before.x - 2) << "the way is free";
    rider.wait(2 + 6 / speed, step_s);
    EXPECT_EQ(rider.walker.passing(), 0U);
}

}  // namespace

TEST(Moving, WhereAWallLeavesNoRoomNobodyIsTrappedOrThrownThroughAWall) {
    for (const double speed : {0.3, 2.0, 8.0})
        for (const double step_s : {0.002, 0.02, 0.05})
            for (const double thick_m : {0.05, 1.5}) {
                SCOPED_TRACE(testing::Message() << speed << " m/s, " << step_s << " s, " << thick_m << " m");
                squeeze(speed, step_s, thick_m);
            }
}

TEST(Moving, WhatIsAsFastAsATrainSweepsNobodyAlong) {
    for (const double speed : {5.0, 20.0}) {
        MovingScene scene = open_hall();
        scene.things.push_back(platform({-15, 0, -1}, {-14, 2.5, 1}, {24, 0, 0}, 24 / speed));
        Rider rider(scene, {0, 1.7, 0.05});
        rider.step({0, 0, 1e-6});
        while (rider.time_s < 1.5 + 24 / speed) rider.step(dvec3(0.0));
        if (speed < 10)
            EXPECT_NEAR(rider.eye.x, 10.3, 0.02) << "it pushes";
        else
            EXPECT_LT(std::abs(rider.eye.x), 1.5) << "it goes through";
        EXPECT_EQ(rider.walker.passing(), 0U);
    }
}

TEST(Moving, ALiftThatMeetsACeilingGoesThroughAndLeavesTheVisitorBelow) {
    MovingScene scene = open_hall();
    add_box(scene.still, {-5, 3, -5}, {5, 3.2, 5});
    scene.things.push_back(platform({-2, -0.1, -2}, {2, 0.02, 2}, {0, 2.9, 0}, 4));
    Rider rider(scene, {0, 1.72, 0});
    rider.step({1e-6, 0, 0});
    double highest = 0;
    while (rider.time_s < 20) {
        rider.step(dvec3(0.0));
        highest = std::max(highest, rider.walker.feet().y);
    }
    EXPECT_LT(highest, 1.21) << "the head of 1.8 m stays below the ceiling at 3 m";
    EXPECT_GT(highest, 1.1);
    EXPECT_GE(rider.walker.passed_through() + rider.walker.put_aside(), 1U);
    EXPECT_NEAR(rider.walker.feet().y, 0, 0.03) << "on the floor, or on the platform that came down";
}

TEST(Moving, DoorsDoNotPushOverEdges) {
    MovingScene scene;
    add_box(scene.still, {-5, -0.5, -5}, {2, 0, 5});
    add_floor(scene.still, -20, 20, -20, 20, -2);
    scene.things.push_back(platform({-0.1, 0.01, -1}, {0, 2.5, 1}, {1.95, 0, 0}, 2));
    Rider rider(scene, {1.2, 1.7, 0.1});
    rider.step({0, 0, 1e-6});
    while (rider.time_s < 8) {
        rider.step(dvec3(0.0));
        ASSERT_NEAR(rider.walker.feet().y, 0, 1e-3) << rider.time_s;
    }
}

TEST(Moving, WhatJumpsNeitherCarriesNorTraps) {
    MovingScene scene = open_hall();
    MovingThing leaping = platform({-1, -0.1, -1}, {1, 0.02, 1}, {0, 4, 0}, 4);
    leaping.stands.resize(3);  // from up there back down at once
    scene.things.push_back(leaping);
    MovingThing wall = platform({4, 0, -2}, {4.1, 2.5, 2}, {3, 0, 0}, 1);
    wall.stands = {{0, dvec3(0.0)}, {2, dvec3(0.0)}, {2, {1, 0, 0}}, {4, {1, 0, 0}}};  // back and forth, into who stands there
    scene.things.push_back(wall);
    Rider lifted(scene, {0, 1.72, 0}), walled(scene, {5.1, 1.7, 0});
    lifted.step({1e-6, 0, 0}), walled.step({1e-6, 0, 0});
    double fastest_m_s = 0;
    while (lifted.time_s < 5.5) {
        const dvec3 before = lifted.eye;
        lifted.step(dvec3(0.0)), walled.step(dvec3(0.0));
        fastest_m_s = std::max(fastest_m_s, glm::length(lifted.eye - before) / tick_s);
    }
    EXPECT_LT(fastest_m_s, 6) << "it falls, or stays, and does not jump";
    EXPECT_GE(walled.walker.put_aside() + walled.walker.passed_through(), 1U);
    walled.push({0, 0, 1}, 3);
    EXPECT_GT(walled.eye.z, 2) << "it gets away";
}

TEST(Moving, WhoFindsHimselfInSomethingThatJumpedGetsOut) {
    MovingScene scene = open_hall();
    MovingThing block;
    add_box(block.at_rest, {-12, 0, -3}, {-6, 4, 3});
    block.stands = {{0, dvec3(0.0)}, {1, dvec3(0.0)}, {1, {9, 0, 0}}, {60, {9, 0, 0}}};
    scene.things.push_back(block);
    Rider rider(scene, {0, 1.7, 0});
    rider.step({0, 0, 1e-6});
    rider.wait(2);
    EXPECT_EQ(rider.walker.passed_through() + rider.walker.put_aside(), 1U);
    rider.push({1, 0, 0}, 5);
    EXPECT_GT(rider.eye.x, 4);
    rider.push({-1, 0, 0}, 3);
    EXPECT_NEAR(rider.eye.x, 3.3, 0.01) << "and it blocks again";
}

TEST(Moving, AfterAPauseNothingHasCarried) {
    MovingScene scene = open_hall();
    scene.things.push_back(platform({-1, -0.1, -1}, {1, 0.02, 1}, {0, 4, 0}, 4));
    Rider rider(scene, {0, 1.72, 0});
    rider.step({1e-6, 0, 0});
    while (rider.time_s < 2) rider.step(dvec3(0.0));
    const dvec3 before = rider.eye;
    rider.time_s += 2;
    rider.step(dvec3(0.0));
    EXPECT_EQ(rider.eye, before) << "as it was placed";
    rider.step({1e-6, 0, 0});
    EXPECT_LT(std::abs(rider.eye.y - before.y), 3) << "it stands up where it is";
}

TEST(Moving, StepsDoNotAllocate) {
    if (!rt::guard_active()) GTEST_SKIP() << "a sanitizer counts in its place";
    MovingScene scene = open_hall();
    add_doorway(scene.still);
    scene.things.push_back(sliding_door());
    scene.things.push_back(platform({-1, -0.1, 1}, {1, 0.02, 3}, {0, 4, 0}, 4));
    Rider rider(scene, {0, 1.7, -2});
    const std::uint64_t before = rt::guard_counters().own_violations;
    {
        const rt::OwnScope own;
        rider.push({0, 0, 0.4}, 15);
    }
    EXPECT_EQ(rt::guard_counters().own_violations, before);
    EXPECT_GT(rider.eye.z, 0.5);
}

TEST(Moving, AModelWithoutMotionWalksAsItsGroundAlone) {
    MovingScene scene = open_hall();
    add_doorway(scene.still);
    model::Model model;
    model.ground = ground_of(scene.still);
    model::Walker alone(model.ground, {}), of_model(model, {});
    dvec3 a{0.4, 1.7, -2}, b = a;
    for (int i = 0; i < 3000; ++i) {
        of_model.set_time(i * tick_s);
        const dvec3 way(0.001 * std::sin(0.01 * i), 0, 0.002);
        a = alone.walk(a, a + way, tick_s), b = of_model.walk(b, b + way, tick_s);
        ASSERT_EQ(a, b) << i;
    }
    EXPECT_EQ(of_model.ride().max_m_s, 0);
}

/// Bounds of thousands of things with thousands of keys take long: then those of one motion have theirs in common.
TEST(Moving, BoundsOfManyThingsHoldTheirWays) {
    MovingScene scene = open_hall();
    MovingThing thing = platform({-1, 0, -1}, {1, 0.2, 1}, {0, 3, 0}, 2);
    thing.stands.clear();
    for (int k = 0; k <= 4000; ++k) thing.stands.push_back({0.01 * k, {std::sin(0.01 * k), 0, 0}});
    scene.things.push_back(thing);
    model::Model model = scene.model();
    const double alone = model.moving_ground.reach[0].speed_mps;
    for (int i = 1; i < 1500; ++i) {
        model.moving_ground.rest.instances.push_back({dvec3(i, 0, 0), mat3(1.0F), 1});
        model.moving_ground.motions.push_back(0);
    }
    model::index_moving_ground(model);
    ASSERT_EQ(model.moving_ground.reach.size(), 1500U);
    EXPECT_GE(model.moving_ground.reach[0].speed_mps, alone);
    EXPECT_LT(model.moving_ground.reach[0].box.min.x, -1.99);
    EXPECT_GT(model.moving_ground.reach[0].box.max.x, 1500) << "that of all of them";
}

}  // namespace surefoot::test
