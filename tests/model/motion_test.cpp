// Motions: poses at any time, and bounds that hold at 10^5 random times, between keys as well.
#include "render/model/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "render/model/moving.hpp"
#include "tests/model/random_motions.hpp"
#include "tests/model/two_triangles.hpp"

namespace surefoot::model {
namespace {

using surefoot::test::add_motion;
using surefoot::test::point_within;
using surefoot::test::within;

constexpr float half_turn = 0.70710678F;  // of a quarter turn's quaternion

double apart(const dvec3& a, const dvec3& b) { return glm::length(a - b); }

/// 2 m to the right and back in 4 s, while it turns by 90 degrees about y at (1, 0, 0) and back.
Model swinging() {
    Model m;
    m.motions.push_back({{1, 0, 0}, 0, 3, 4, none});
    m.motion_keys = {{0, {0, 0, 0}, {0, 0, 0, 1}}, {2, {2, 0, 0}, {0, half_turn, 0, half_turn}}, {4, {0, 0, 0}, {0, 0, 0, 1}}};
    return m;
}

TEST(Motion, IsAtItsKeysAndBetweenThem) {
    const Model m = swinging();
    const dvec3 x(1, 0, -1);  // a metre before the pivot
    EXPECT_LT(apart(pose_at(m, 0, 0)(x), x), 1e-7);
    EXPECT_LT(apart(pose_at(m, 0, 2)(x), dvec3(2, 0, 0)), 1e-6);
    const double eighth = std::numbers::pi / 4;
    EXPECT_LT(apart(pose_at(m, 0, 1)(x), dvec3(2 - std::sin(eighth), 0, -std::cos(eighth))), 1e-6);
    EXPECT_LT(apart(pose_at(m, 0, 3)(x), pose_at(m, 0, 1)(x)), 1e-6);
    EXPECT_EQ(pose_at(m, none, 1)(x), x);
}

TEST(Motion, LoopsAtAnyTime) {
    const Model m = swinging();
    const dvec3 x(1, 0, -1), at = pose_at(m, 0, 1.25)(x);
    for (const double laps : {-1e6, -3.0, -1.0, 1.0, 7.0, 1e6, 1e9})
        EXPECT_LT(apart(pose_at(m, 0, 1.25 + 4 * laps)(x), at), 1e-5) << laps;
    const dvec3 start = pose_at(m, 0, 0)(x);
    constexpr double endless = std::numeric_limits<double>::infinity();
    for (const double no_time : {std::numeric_limits<double>::quiet_NaN(), endless, -endless})
        EXPECT_EQ(pose_at(m, 0, no_time)(x), start);
    for (const double huge : {1e300, -1e300, 1e-300, -1e-300, 4.0, -4.0}) {
        const dvec3 there = pose_at(m, 0, huge)(x);
        EXPECT_TRUE(std::isfinite(there.x) && std::isfinite(there.y) && std::isfinite(there.z)) << huge;
    }
}

TEST(Motion, JumpsWhereTwoKeysAreAtOneTime) {
    Model m;
    m.motions.push_back({{0, 0, 0}, 0, 4, 2, none});
    m.motion_keys = {
        {0, {0, 0, 0}, {0, 0, 0, 1}}, {1, {0, 0, 0}, {0, 0, 0, 1}}, {1, {5, 0, 0}, {0, 0, 0, 1}}, {2, {5, 0, 0}, {0, 0, 0, 1}}};
    EXPECT_EQ(pose_at(m, 0, 0.999)(dvec3(0)).x, 0);
    EXPECT_EQ(pose_at(m, 0, 1)(dvec3(0)).x, 5);
    EXPECT_EQ(pose_at(m, 0, 2)(dvec3(0)).x, 0) << "the next lap";
    const MotionReach reach = reach_of(m, 0, {dvec3(0), dvec3(1)});
    EXPECT_NEAR(reach.box.max.x, 6, 1e-6);
    EXPECT_EQ(reach.speed_mps, 0) << "a jump has none";
    EXPECT_NEAR(reach.displacement_m, 5, 1e-6);
}

TEST(Motion, IsCarriedByAnother) {
    Model m = swinging();
    m.motions.push_back({{0, 0, 0}, 3, 2, 8, 0});  // 3 m up in 8 s, in the frame that swings
    m.motion_keys.push_back({0, {0, 0, 0}, {0, 0, 0, 1}});
    m.motion_keys.push_back({8, {0, 0, -3}, {0, 0, 0, 1}});
    const dvec3 x(1, 0, 0);
    for (const double t : {0.0, 0.7, 2.0, 3.3, 9.1, 100.0}) {
        const dvec3 inner = x + dvec3(0, 0, -3) * (std::fmod(t, 8.0) / 8);
        EXPECT_LT(apart(pose_at(m, 1, t)(x), pose_at(m, 0, t)(inner)), 1e-9) << t;
        EXPECT_LT(apart(pose_at(m, 1, t).back(pose_at(m, 1, t)(x)), x), 1e-9) << t;
    }
}

TEST(Motion, APlacementMovesAsItsPointsDo) {
    Random random(3);
    Model m;
    for (int i = 0; i < 200; ++i) {
        const Index motion = add_motion(m, random);
        Placement p;
        p.origin = point_within(random, 5);
        p.linear = mat3(glm::mat3_cast(glm::normalize(dquat(within(random, -1, 1), 0.3, within(random, -1, 1), 0.5)))) * 1.5F;
        const RigidPose pose = pose_at(m, motion, within(random, -10, 10));
        const Placement there = moved(p, pose);
        const dvec3 v = point_within(random, 2);
        EXPECT_LT(apart(there.origin + dmat3(there.linear) * v, pose(p.origin + dmat3(p.linear) * v)), 1e-5);
    }
}

/// Every point, at every time: where, how far from rest, how fast.
TEST(Motion, ReachHoldsAtAHundredThousandRandomTimes) {
    Random random(7);
    double fullest = 0;
    for (int round = 0; round < 500; ++round) {
        Model m;
        Index motion = none;
        const bool jumps = round % 2 == 0;
        for (int depth = 0; depth <= round % 3; ++depth) motion = add_motion(m, random, motion, jumps);
        Box box;
        box.grow(point_within(random, 6));
        box.grow(point_within(random, 6));
        const MotionReach reach = reach_of(m, motion, box);
        Box seen = box;
        for (int i = 0; i < 200; ++i) {
            const double t = within(random, -50, 50);
            const RigidPose pose = pose_at(m, motion, t), later = pose_at(m, motion, t + 1e-4);
            const dvec3 share(random.unit(), random.unit(), random.unit());
            const dvec3 x = box.min + share * (box.max - box.min), at = pose(x);
            ASSERT_TRUE(reach.box.contains({at, at})) << "round " << round << ", time " << t;
            ASSERT_LE(apart(at, x), reach.displacement_m);
            if (!jumps) {
                ASSERT_LE(apart(later(x), at), 1e-4 * reach.speed_mps * (1 + 1e-6) + 1e-9) << "round " << round << ", time " << t;
            }
            seen.grow(at);
        }
        fullest = std::max(fullest, glm::length(seen.max - seen.min) / glm::length(reach.box.max - reach.box.min));
    }
    EXPECT_GT(fullest, 0.8) << "the bound is not far from what is reached";
}

TEST(Motion, ReachOfAShareOfTheTurnIsNotThatOfAWholeOne) {
    const Model m = swinging();
    const MotionReach reach = reach_of(m, 0, {dvec3(1, 0, -10), dvec3(1, 0, -10)});
    EXPECT_NEAR(reach.turn_rps, std::numbers::pi / 4, 1e-6);
    EXPECT_NEAR(reach.speed_mps, 1 + 10 * std::numbers::pi / 4, 1e-5);
    EXPECT_NEAR(reach.box.min.x, -7.082, 0.01) << "a little before the turn ends, for it goes to the right meanwhile";
    EXPECT_NEAR(reach.box.max.x, 1, 0.01);
    EXPECT_NEAR(reach.box.max.z, 0, 0.01);
}

/// A model of two placed triangles, whose second one moves.
Model one_that_moves(const Model& motions) {
    Model m = two_triangles();
    m.motions = motions.motions;
    m.motion_keys = motions.motion_keys;
    m.placements.push_back(m.placements[0]);
    m.placements[1].motion = static_cast<Index>(m.motions.size() - 1);
    m.reps[3].placement = 1;
    return m;
}

TEST(MovingNodes, HoldTheNodeWithinASpan) {
    Random random(11);
    int bounded = 0;
    for (int round = 0; round < 300; ++round) {
        Model motions;
        Index outer = none;
        for (int depth = 0; depth <= round % 2; ++depth) outer = add_motion(motions, random, outer, round % 3 == 0);
        Model m = one_that_moves(motions);
        for (Index n : {2U, 0U}) m.nodes[n].box.grow(reach_of(m, m.placements[1].motion, rest_box_of(m, m.nodes[2])).box);
        MovingNodes nodes(m);
        ASSERT_TRUE(nodes.any());
        EXPECT_EQ(nodes.roots(), std::vector<Index>{2});
        EXPECT_FALSE(nodes.find(1));
        const double from_s = within(random, 0, 20), span_s = within(random, 0, 0.3);
        nodes.set_span(from_s, from_s + span_s);
        const auto moving = nodes.find(2);
        ASSERT_TRUE(moving);
        EXPECT_LE(moving->speed_mps, reach_of(m, m.placements[1].motion, moving->rest).speed_mps);
        bounded += moving->everywhere ? 0 : 1;
        for (int i = 0; i < 50; ++i) {
            const double t = from_s + span_s * random.unit();
            const RigidPose pose = pose_at(m, m.placements[1].motion, t);
            for (const vec3& v : {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)}) {
                const dvec3 at = pose(m.placements[1].origin + dvec3(v));
                const Box box = nodes.box(2);
                EXPECT_LE(box.distance(at), 1e-9) << "round " << round;
            }
        }
    }
    EXPECT_GT(bounded, 150) << "of the others the box over all times holds";
}

TEST(MotionPoses, AreThoseOfTheirTimeBitForBitHoweverOftenAndInWhateverOrder) {
    Random random(12);
    Model m;
    Index outer = none;
    for (int i = 0; i < 40; ++i) outer = add_motion(m, random, i % 3 == 0 ? none : outer, i % 5 == 0);
    MotionPoses poses(m);
    const auto expect_same = [&](Index motion, double time_s) {
        const RigidPose &is = poses.at(motion), should = pose_at(m, motion, time_s);
        ASSERT_TRUE(is.pivot == should.pivot && is.translation == should.translation && is.rotation == should.rotation)
            << "motion " << motion << " at " << time_s;
    };
    for (Index motion = 0; motion < m.motions.size(); ++motion) expect_same(motion, 0);
    for (int i = 0; i < 300; ++i) {
        const double time_s = i % 7 == 0 ? 3.5 : within(random, -20, 20);
        poses.set_time(time_s);
        for (int k = 0; k < 30; ++k)
            expect_same(static_cast<Index>(random.below(static_cast<std::uint32_t>(m.motions.size()))), time_s);
    }
}

TEST(MotionPoses, AreWorkedOutOnceATime) {
    Random random(14);
    Model m;
    add_motion(m, random, none, false);
    MotionPoses poses(m);
    poses.set_time(0.4);
    const RigidPose first = poses.at(0);
    for (MotionKey& key : m.motion_keys) key.translation += dvec3(5, 0, 0);
    EXPECT_EQ(poses.at(0).translation, first.translation) << "the keys are not read again";
    poses.set_time(0.5);
    EXPECT_TRUE(poses.at(0).translation == pose_at(m, 0, 0.5).translation);
}

TEST(MovingNodes, AreWhereTheirPosesAre) {
    Random random(13);
    Model motions;
    add_motion(motions, random, none, false);
    const Model m = one_that_moves(motions);
    MovingNodes nodes(m);
    MotionPoses poses(m);
    for (int i = 0; i < 50; ++i) {
        const double time_s = within(random, 0, 20);
        nodes.set_span(time_s, time_s);
        poses.set_time(time_s);
        const Box by_span = nodes.box(2), by_poses = nodes.box(2, poses);
        EXPECT_TRUE(by_span.min == by_poses.min && by_span.max == by_poses.max);
        ASSERT_TRUE(nodes.find(2, poses));
        EXPECT_EQ(nodes.find(2, poses)->pose.translation, nodes.find(2)->pose.translation);
    }
    EXPECT_FALSE(nodes.find(1, poses));
    EXPECT_EQ(nodes.box(1, poses).min, m.nodes[1].box.min);
}

TEST(MovingNodes, AreNoneWhereAllStandsStill) {
    const Model m = two_triangles();
    const MovingNodes nodes(m);
    EXPECT_FALSE(nodes.any());
    EXPECT_FALSE(nodes.find(1));
}

TEST(MotionFinding, SaysWhatMovesAndWhy) {
    const EffectFinding none_moves = motion_finding(two_triangles());
    EXPECT_FALSE(none_moves.called_for);
    EXPECT_EQ(none_moves.triangles, 0U);
    EXPECT_NE(none_moves.reason.find("no animation"), std::string::npos);
    const EffectFinding one = motion_finding(one_that_moves(swinging()));
    EXPECT_TRUE(one.called_for);
    EXPECT_EQ(one.triangles, 1U);
    EXPECT_NE(one.reason.find("1 of 2 objects"), std::string::npos) << one.reason;
}

}  // namespace
}  // namespace surefoot::model
