// The walker on floors, walls, steps, slopes and edges made by hand.
#include "render/model/ground/walker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/ground/grounds.hpp"

namespace surefoot::model {

namespace {

using test::add_box;
using test::add_floor;
using test::add_quad;
using test::add_wall;
using test::ground_of;
using test::push;
using test::Triangles;

constexpr dvec3 right{1, 0, 0}, ahead{0, 0, -1};

Triangles level() {
    Triangles t;
    add_floor(t, -20, 20, -20, 20, 0);
    return t;
}

/// A stair of ten steps to the right of x = 2, a platform behind it.
Triangles stair(double rise, double tread) {
    Triangles t = level();
    for (int i = 0; i < 10; ++i) {
        const double x = 2 + i * tread, y = rise * i;
        add_wall(t, {x, -5}, {x, 5}, y, y + rise);
        add_floor(t, x, i == 9 ? x + 5 : x + tread, -5, 5, y + rise);
    }
    return t;
}

/// A slope to the right of x = 2 that rises by 4 m.
Triangles slope(double degrees) {
    Triangles t = level();
    const double run = 4 / std::tan(degrees * std::numbers::pi / 180);
    add_quad(t, {2, 0, -5}, {2, 0, 5}, {2 + run, 4, 5}, {2 + run, 4, -5});
    add_floor(t, 2 + run, 12 + run, -5, 5, 4);
    return t;
}

}  // namespace

TEST(Walker, WalksOnALevelFloorAsItIsTold) {
    const Ground ground = ground_of(level());
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 1.7, 0}, 1.4 * right, 2);
    EXPECT_NEAR(eye.x, 2.8, 0.01);
    EXPECT_NEAR(eye.y, 1.7, 1e-3);
    EXPECT_EQ(walker.barrier(), Barrier::clear);
}

TEST(Walker, StopsAtAWallAndSlidesAlongItWithoutJitter) {
    Triangles t = level();
    add_wall(t, {3, -10}, {3, 10}, 0, 3);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    dvec3 eye = push(walker, {0, 1.7, 0}, 1.4 * right, 4);
    EXPECT_NEAR(eye.x, 2.7, 2e-3);
    EXPECT_EQ(walker.barrier(), Barrier::wall);
    double min_x = 9, max_x = -9, before = eye.z;
    for (int i = 0; i < 1000; ++i) {
        eye = walker.walk(eye, eye + dvec3(1, 0, -1) * test::tick_s, test::tick_s);
        min_x = std::min(min_x, eye.x), max_x = std::max(max_x, eye.x);
        ASSERT_LT(eye.z, before) << "goes on along the wall at every tick";
        before = eye.z;
    }
    EXPECT_LT(max_x - min_x, 1e-6);
    EXPECT_NEAR(eye.z, -2, 0.01);
    EXPECT_EQ(walker.barrier(), Barrier::clear);
}

TEST(Walker, DoesNotPassARazorThinWallNorACornerOfOneDegree) {
    Triangles t = level();
    add_wall(t, {3, -10}, {3, 10}, 0, 3);
    add_wall(t, {3 + 1e-4, -10}, {3 + 1e-4, 10}, 0, 3);
    const double turn = std::numbers::pi / 180;  // two walls that meet at x = -8
    add_wall(t, {-8, 0}, {0, 8 * std::sin(turn)}, 0, 3);
    add_wall(t, {-8, 0}, {0, -8 * std::sin(turn)}, 0, 3);
    const Ground ground = ground_of(t);
    Walker fast(ground, {});
    EXPECT_LT(push(fast, {0.5, 1.7, 5}, 200.0 * right, 1).x, 2.71);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {2, 1.7, 0}, -1.4 * right, 8);
    EXPECT_GT(eye.x, 0) << "the gap is 0.28 m wide at most";
}

TEST(Walker, ClimbsStairsOfExactlyTheStepAndNoHigherOnes) {
    for (const double rise : {0.1, 0.2, 0.25}) {
        const Ground ground = ground_of(stair(rise, 0.3));
        Walker walker(ground, {});
        dvec3 eye = push(walker, {0, 1.7, 0}, 1.4 * right, 6);
        EXPECT_NEAR(eye.y, 1.7 + 10 * rise, 0.01) << rise;
        EXPECT_GT(eye.x, 5) << rise;
        eye = push(walker, eye, -1.4 * right, 6);
        EXPECT_NEAR(eye.y, 1.7, 0.01) << rise << ": down again";
        EXPECT_LT(eye.x, 1) << rise;
    }
    const Ground ground = ground_of(stair(0.3, 0.3));
    Walker walker(ground, {});
    EXPECT_LT(push(walker, {0, 1.7, 0}, 1.4 * right, 6).x, 2);
    EXPECT_EQ(walker.barrier(), Barrier::wall);
}

TEST(Walker, ClimbsSlopesUpToTheLimit) {
    const Ground easy = ground_of(slope(45)), steep = ground_of(slope(47));
    Walker climber(easy, {});
    EXPECT_NEAR(push(climber, {0, 1.7, 0}, 1.4 * right, 7).y, 5.7, 0.02);
    Walker stopped(steep, {});
    const dvec3 eye = push(stopped, {0, 1.7, 0}, 1.4 * right, 7);
    EXPECT_LT(eye.y, 2.0);
    EXPECT_NE(stopped.barrier(), Barrier::clear);
}

TEST(Walker, TheEyeRisesSmoothly) {
    const Ground ground = ground_of(stair(0.25, 0.3));
    Walker walker(ground, {});
    dvec3 eye{0, 1.7, 0};
    double speed = 0;
    for (int i = 0; i < 3000; ++i) {
        const dvec3 next = walker.walk(eye, eye + 1.4 * right * test::tick_s, test::tick_s);
        const double now = (next.y - eye.y) / test::tick_s;
        ASSERT_LE(std::abs(now - speed), 8 * test::tick_s + 1e-6) << i << ": its acceleration is limited";
        speed = now;
        eye = next;
    }
    EXPECT_GT(eye.y, 4);
}

TEST(Walker, StopsAtEdgesOfAMetreAndFallsDownLowerOnes) {
    for (const double drop : {0.6, 0.99, 1.0, 1.01, 30.0}) {
        Triangles t;
        add_floor(t, -10, 2, -10, 10, drop);
        add_wall(t, {2, -10}, {2, 10}, 0, drop);
        add_floor(t, 2, 20, -10, 10, 0);
        const Ground ground = ground_of(t);
        Walker walker(ground, {});
        dvec3 eye = push(walker, {0, drop + 1.7, 0}, 1.4 * right, 3);
        const bool falls = drop < 1;
        EXPECT_NEAR(eye.y, (falls ? 0 : drop) + 1.7, 0.02) << drop;
        EXPECT_EQ(eye.x > 2.5, falls) << drop;
        EXPECT_EQ(walker.barrier(), falls ? Barrier::clear : Barrier::edge) << drop;
        if (falls) continue;
        eye = push(walker, eye, dvec3(1, 0, -1), 2);
        EXPECT_LT(eye.z, -1) << drop << ": goes along the edge";
        EXPECT_NEAR(eye.y, drop + 1.7, 0.02) << drop;
    }
}

TEST(Walker, FallsWithGravityAndLands) {
    const Ground ground = ground_of(level());
    Walker walker(ground, {});
    dvec3 eye{0, 1.7 + 1.2, 0};
    double t_s = 0;
    for (; t_s == 0 || (!walker.supported() && t_s < 2); t_s += test::tick_s)
        eye = walker.walk(eye, eye + (t_s == 0 ? 1e-6 : 0) * right, test::tick_s);
    EXPECT_NEAR(t_s, std::sqrt(2 * 1.2 / 9.81), 0.01);
    double lowest = eye.y;
    for (int i = 0; i < 1000; ++i) {
        eye = walker.walk(eye, eye, test::tick_s);
        lowest = std::min(lowest, eye.y);
    }
    EXPECT_NEAR(eye.y, 1.7, 1e-3);
    EXPECT_GT(lowest, 1.5) << "the knees bend a little";
}

TEST(Walker, DoesNotHangOnAnEdgeThatItFallsFrom) {
    Triangles t;
    add_floor(t, -10, 2, -10, 10, 0.9);
    add_wall(t, {2, -10}, {2, 10}, 0, 0.9);
    add_floor(t, 2, 20, -10, 10, 0);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    dvec3 eye = push(walker, {1.8, 2.6, 0}, right, 0.3);
    while (walker.supported() && eye.x < 3) eye = push(walker, eye, right, 0.002);
    for (int i = 0; i < 750; ++i) eye = walker.walk(eye, eye, test::tick_s);
    EXPECT_NEAR(eye.y, 1.7, 1e-3) << "within a second and a half, the hand at rest";
    EXPECT_NEAR(eye.x, 2.3, 0.02) << "its side touches the wall";
}

TEST(Walker, CeilingsStopIt) {
    Triangles t = level();
    add_quad(t, {3, 1.6, -5}, {3, 1.6, 5}, {8, 1.6, 5}, {8, 1.6, -5});      // a low ceiling
    add_quad(t, {-2, 0.2, -5}, {-2, 0.2, 5}, {-8, 0.2, 5}, {-8, 0.2, -5});  // a step under one that is just high enough below it
    add_wall(t, {-2, -5}, {-2, 5}, 0, 0.2);
    add_quad(t, {-2, 1.9, -5}, {-2, 1.9, 5}, {-8, 1.9, 5}, {-8, 1.9, -5});
    const Ground ground = ground_of(t);
    Walker low(ground, {});
    EXPECT_LT(push(low, {0, 1.7, 0}, 1.4 * right, 4).x, 3);
    Walker step(ground, {});
    EXPECT_GT(push(step, {0, 1.7, 0}, -1.4 * right, 4).x, -2);
    EXPECT_EQ(step.barrier(), Barrier::ceiling);
}

TEST(Walker, ASmallBodyIsAThinOne) {
    Triangles t = level();
    add_wall(t, {3, -10}, {3, 10}, 0, 3);
    add_quad(t, {-3, 0.7, -5}, {-3, 0.7, 5}, {-8, 0.7, 5}, {-8, 0.7, -5});
    const Ground ground = ground_of(t);
    const Body child{0.5, 0.3, 0.4, 0.78, 1};
    Walker walker(ground, child);
    const Capsule body = walker.capsule_at({0, 0, 0});
    EXPECT_GE(body.low.y - body.radius, 0.0);
    EXPECT_LE(body.low.y + body.length + body.radius, 0.6 + 1e-9) << "its crown";
    EXPECT_LT(push(walker, {0, 0.5, 0}, 1.4 * right, 4).x, 3);
    Walker under(ground, child);
    EXPECT_LT(push(under, {0, 0.5, 0}, -1.4 * right, 4).x, -5) << "under the table";
}

TEST(Walker, CracksAndHolesSmallerThanAFootCarryIt) {
    Triangles t;
    for (int i = -10; i < 10; ++i) add_floor(t, i + 0.001, i + 1, -5, 5, 0);  // a millimetre apart
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    double low = 9;
    dvec3 eye{-5, 1.7, 0};
    for (int i = 0; i < 3000; ++i) {
        eye = walker.walk(eye, eye + right * test::tick_s, test::tick_s);
        low = std::min(low, eye.y);
    }
    EXPECT_NEAR(eye.x, 1, 0.02);
    EXPECT_NEAR(low, 1.7, 1e-3);
}

TEST(Walker, WithoutAnyFloorItGlides) {
    Triangles t;
    add_wall(t, {3, -10}, {3, 10}, -5, 5);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 0, 0}, 1.4 * right, 4);
    EXPECT_NEAR(eye.x, 2.7, 2e-3);
    EXPECT_EQ(eye.y, 0);
}

TEST(Walker, InTheAirItFallsOnlyOnceTheHandMoves) {
    const Ground ground = ground_of(level());
    Walker walker(ground, {});
    dvec3 eye{0, 4.5, 0};
    for (int i = 0; i < 500; ++i) eye = walker.walk(eye, eye, test::tick_s);
    EXPECT_EQ(eye, dvec3(0, 4.5, 0)) << "a viewpoint above the floor";
    eye = push(walker, eye, 0.1 * right, 10);
    EXPECT_NEAR(eye.y, 1.7, 0.01);
}

TEST(Walker, HighAboveTheFloorItGlides) {
    const Ground ground = ground_of(level());
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 40, 0}, 1.4 * right, 3);
    EXPECT_EQ(eye.y, 40) << "a view from the air stays one";
    EXPECT_GT(eye.x, 4);
}

TEST(Walker, BelowItsFloorItIsPutOnIt) {
    const Ground ground = ground_of(level());
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, -0.01, 0}, 0.1 * right, 1);
    EXPECT_NEAR(eye.y, 1.7, 1e-3) << "a vehicle's recorded path";
    EXPECT_EQ(walker.freed(), 1U);
}

TEST(Walker, ASlightOverlapIsLeftByTheShortestWay) {
    Triangles t = level();
    add_wall(t, {3, -10}, {3, 10}, 0, 3);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {2.8, 1.7, 0}, 0.01 * ahead, 0.1);
    EXPECT_NEAR(eye.x, 2.699, 2e-3);
    EXPECT_NEAR(eye.z, 0, 0.01);
}

TEST(Walker, InAHallOfOutwardWallsItStaysWhereItIs) {
    Triangles t;
    add_box(t, {-8, 0, -8}, {8, 4, 8});
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 1.7, 0}, 1.4 * right, 1);
    EXPECT_EQ(walker.freed(), 0U);
    EXPECT_NEAR(eye.x, 1.4, 0.01);
}

TEST(Walker, FloorsInsideOutAndDoubledCarryIt) {
    Triangles t;
    add_floor(t, 10, -10, -10, 10, 0);  // faces down
    add_floor(t, -10, 10, -10, 10, 0);
    add_floor(t, -10, 10, -10, 10, 0);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 1.7, 0}, 1.4 * right, 3);
    EXPECT_NEAR(eye.x, 4.2, 0.01);
    EXPECT_NEAR(eye.y, 1.7, 1e-3);
}

TEST(Walker, ThatBeginsInsideSomethingIsPutBesideIt) {
    Triangles t = level();
    add_box(t, {-1, 0, -1}, {0.1, 2.5, 1});
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, {0, 1.7, 0}, 0.1 * right, 1);
    EXPECT_EQ(walker.freed(), 1U);
    EXPECT_TRUE(eye.x > 0.39 || eye.x < -1.29 || std::abs(eye.z) > 1.29) << eye.x << ' ' << eye.z;
    EXPECT_LT(glm::length(eye - dvec3(0, 1.7, 0)), 0.8) << "near";
}

TEST(Walker, ThatIsStuckGoesBackAndIsCounted) {
    // A platform, and beside it a shaft as narrow as the body, 0.9 m deep.
    Triangles t;
    add_floor(t, -10, 2, -10, 10, 0.9);
    add_wall(t, {2, -10}, {2, 10}, 0, 0.9);
    add_floor(t, 2, 3, -10, 10, 0);
    add_wall(t, {2.63, -10}, {2.63, 10}, 0, 4);
    add_wall(t, {2, 0.32}, {2.7, 0.32}, 0, 4);
    add_wall(t, {2, -0.32}, {2.7, -0.32}, 0, 4);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    dvec3 eye = push(walker, {-2, 2.6, 0}, 1.4 * right, 3.9);
    EXPECT_EQ(walker.returns(), 0U);
    EXPECT_NEAR(walker.feet().y, 0, 0.01) << "it is in the shaft";
    for (double s = 0; s < 4 && walker.returns() == 0; s += test::tick_s)
        eye = walker.walk(eye, eye + right * test::tick_s, test::tick_s);
    EXPECT_EQ(walker.returns(), 1U);
    EXPECT_EQ(walker.freed(), 0U);
    EXPECT_LT(eye.x, 1.7);
    EXPECT_NEAR(eye.y, 2.6, 0.01) << "back on the platform";
    walker.walk(eye, eye + right * test::tick_s, test::tick_s);
    EXPECT_EQ(walker.barrier(), Barrier::stuck) << "said for a second";
}

namespace {

/// Pushes a stuck walker on until it is back on the platform at height 0, for at most a minute. Returns where its eye is.
dvec3 push_until_back(Walker& walker, dvec3 eye, const dvec3& way) {
    for (double s = 0; s < 60 && walker.feet().y < -0.01; s += test::tick_s)
        eye = walker.walk(eye, eye + way * test::tick_s, test::tick_s);
    EXPECT_NEAR(walker.feet().y, 0, 0.01) << "back on the platform";
    return eye;
}

/// Pushes to the right until the feet are down at this height, for at most a minute.
dvec3 push_down_to(Walker& walker, dvec3 eye, double speed, double height) {
    for (double s = 0; s < 60 && !(walker.stands() && walker.feet().y < height + 0.01); s += test::tick_s)
        eye = walker.walk(eye, eye + right * (speed * test::tick_s), test::tick_s);
    EXPECT_LT(walker.feet().y, height + 0.01) << "it is down";
    return eye;
}

/// A platform up to x = 2, open at the right for |z| < 0.32; what is beyond has walls at both sides up to `until`.
Triangles platform_with_a_gap(double until) {
    constexpr double half_m = 0.32;
    Triangles t;
    add_floor(t, -10, 2, -10, 10, 0);
    for (const double z : {-half_m, half_m}) add_wall(t, {2, z}, {until, z}, -6, 4);
    add_wall(t, {2, -10}, {2, -half_m}, -6, 4), add_wall(t, {2, half_m}, {2, 10}, -6, 4);
    add_wall(t, {until, -half_m}, {until, half_m}, -6, 4);
    return t;
}

}  // namespace

TEST(Walker, StuckAgainAndAgainItGoesBackFurther) {
    // A way down as narrow as the body: six drops of half a metre, none of which is climbed.
    constexpr double half_m = 0.32, step = 0.62, drop = 0.5;
    constexpr int drops = 6;
    Triangles t = platform_with_a_gap(2 + drops * step);
    for (int i = 0; i < drops; ++i) {
        const double x = 2 + i * step, y = -drop * i;
        add_wall(t, {x, -half_m}, {x, half_m}, y - drop, y);
        add_floor(t, x, x + step, -half_m, half_m, y - drop);
    }
    const Ground ground = ground_of(t);
    for (const double start : {-2.0, 1.5}) {  // the second has no places before the way down: back to where it stood up
        Walker walker(ground, {});
        dvec3 eye = push_down_to(walker, {start, 1.7, 0}, 1.4, -drop * drops);
        eye = push_until_back(walker, eye, right);
        EXPECT_LE(walker.returns(), 3U) << start;
        if (start == 1.5) {
            EXPECT_NEAR(eye.x, start, 0.1);
        }
        eye = push(walker, eye, -1.4 * right, 5);
        EXPECT_LT(eye.x, 0) << "and off";
    }
}

TEST(Walker, ItGoesBackToNoPlaceOnWhatIsTooSteep) {
    // Over a step of 0.9 m it falls onto a slope of 50 degrees that ends at a wall.
    constexpr double half_m = 0.32, slope_from = 2.4, until = 5;
    Triangles t = platform_with_a_gap(until);
    add_wall(t, {2, -half_m}, {2, half_m}, -0.9, 0);
    add_floor(t, 2, slope_from, -half_m, half_m, -0.9);
    const double low = -0.9 - (until - slope_from) * std::tan(50 * std::numbers::pi / 180);
    add_quad(t, {slope_from, -0.9, -half_m}, {slope_from, -0.9, half_m}, {until, low, half_m}, {until, low, -half_m});
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push_down_to(walker, {-2, 1.7, 0}, 1.4, -2.5);
    push_until_back(walker, eye, right);
    EXPECT_EQ(walker.returns(), 1U);
}

TEST(Walker, StuckFarFromWhereItStoodUpItGoesBackALittle) {
    // Ninety metres to a shaft as narrow as the body: more places than are remembered do not count.
    Triangles t = platform_with_a_gap(2.63);
    add_floor(t, -100, -10, -10, 10, 0);
    add_floor(t, 2, 2.63, -0.32, 0.32, -0.9);
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    dvec3 eye = push_down_to(walker, {-90, 1.7, 0}, 4, -0.9);
    eye = push_until_back(walker, eye, right);
    EXPECT_EQ(walker.returns(), 1U);
    EXPECT_GT(eye.x, 0);
}

TEST(Walker, PutWhereItIsStuckItIsPutBesideIt) {
    Triangles t = level();
    add_box(t, {5, 0, -1}, {5.5, 3, 1});
    add_box(t, {6.13, 0, -1}, {6.6, 3, 1});
    add_box(t, {5.5, 0, -1}, {6.13, 3, -0.32});
    add_box(t, {5.5, 0, 0.32}, {6.13, 3, 1});
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    push(walker, {0, 1.7, 0}, right, 2);
    const dvec3 eye = push(walker, {5.815, 1.7, 0}, right, 3);
    EXPECT_EQ(walker.freed(), 1U);
    EXPECT_TRUE(eye.x < 4.7 || eye.x > 6.9 || std::abs(eye.z) > 1.29) << eye.x << ' ' << eye.z;
}

TEST(Walker, TheSameCallsGiveTheSameBits) {
    const Ground ground = ground_of(stair(0.2, 0.25));
    Walker one(ground, {}), other(ground, {});
    dvec3 a{0, 1.7, 0}, b = a;
    for (int i = 0; i < 5000; ++i) {
        const dvec3 move = dvec3(std::cos(i * 0.003), 0, std::sin(i * 0.003)) * 0.004;
        a = one.walk(a, a + move, test::tick_s);
        b = other.walk(b, b + move, test::tick_s);
        ASSERT_EQ(a, b) << i;
    }
}

TEST(Walker, FarFromTheOriginItWalksTheSame) {
    Triangles t = stair(0.25, 0.3);
    const dvec3 far{5e6, -3e5, 4e6};
    for (GroundTriangle& one : t) one.a += far, one.b += far, one.c += far;
    const Ground ground = ground_of(t);
    Walker walker(ground, {});
    const dvec3 eye = push(walker, far + dvec3(0, 1.7, 0), 1.4 * right, 6);
    EXPECT_NEAR(eye.y - far.y, 4.2, 0.01);
}

}  // namespace surefoot::model
