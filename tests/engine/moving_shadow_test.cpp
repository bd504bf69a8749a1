// The shadow map of what moves: what it holds, when it is bought, and when an old one is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "render/engine.hpp"
#include "tests/engine/moving_frame.hpp"
#include "tests/engine/moving_lawn.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot {
namespace {

using model::Index;
using test::baked_lawn;
using test::eye_of_lawn;
using test::lawn_and_ball;
using test::lawn_picture;
using test::over_the_lawn;
using test::PlannedLawn;

TEST(MovingShadow, HoldsAllThatCastsWithARimOfSun) {
    PlannedLawn lawn;
    for (double time_s = 0; time_s < 8; time_s += 0.37) {
        ASSERT_TRUE(lawn.shadow.plan(lawn.at(time_s), eye_of_lawn));
        const gl::ShadowView& view = lawn.shadow.view();
        EXPECT_LT(view.texel_m, 0.02F) << "a ball of 2 m";
        ASSERT_EQ(lawn.shadow.items().size(), 1U);
        const Index node = lawn.shadow.items()[0].node;
        const Box rest = lawn.moving.find(node)->rest;
        const model::RigidPose pose = lawn.moving.find(node)->pose;
        EXPECT_LE(lawn.m.reps[lawn.shadow.items()[0].rep].error_m, view.texel_m);
        const float rim = 1 - 4.0F / static_cast<float>(gl::shadow_map_px);
        for (unsigned c = 0; c < 8; ++c) {
            const dvec3 corner((c & 1U) != 0 ? rest.max.x : rest.min.x, (c & 2U) != 0 ? rest.max.y : rest.min.y,
                               (c & 4U) != 0 ? rest.max.z : rest.min.z);
            const vec4 at = view.from_origin * vec4(vec3(pose(corner) - view.origin), 1);
            EXPECT_LT(std::max(std::abs(at.x), std::abs(at.y)), rim);
            EXPECT_GT(at.z, 0.05F);
            EXPECT_LT(at.z, 1.0F);
        }
    }
}

TEST(MovingShadow, HoldsTheFormWithTheFewestTrianglesOfThoseThatAreNear) {
    model::Model m = baked_lawn();
    PlannedLawn lawn(m);
    ASSERT_TRUE(lawn.shadow.plan(lawn.at(1), eye_of_lawn));
    const model::Node& ball = m.nodes[lawn.shadow.items()[0].node];
    ASSERT_GE(ball.rep_count, 3U);
    const float near_m = 0.5F * lawn.shadow.view().texel_m;
    for (Index r = 0; r < ball.rep_count; ++r) {  // the coarser, the more: as where full detail was cut to its masks
        model::Representation& rep = m.reps[ball.first_rep + r];
        rep.triangles = 1000 - 10 * r;
        rep.error_m = r + 1 < ball.rep_count ? near_m : 2 * lawn.shadow.view().texel_m;
    }
    ASSERT_TRUE(lawn.shadow.plan(lawn.at(1), eye_of_lawn));
    EXPECT_EQ(lawn.shadow.items()[0].rep, ball.first_rep + ball.rep_count - 2) << "the last one has fewer, but is too far off";
}

TEST(MovingShadow, AnOldMapIsShownWhileItIsOffByLittleAndNotTooOld) {
    PlannedLawn lawn;
    ASSERT_TRUE(lawn.shadow.plan(lawn.at(1), eye_of_lawn));
    EXPECT_FALSE(lawn.shadow.usable(lawn.at(1), eye_of_lawn)) << "nothing is drawn yet";
    const float first = lawn.shadow.value(lawn.at(1), eye_of_lawn);
    EXPECT_GT(first, 0);
    lawn.shadow.drawn(1);
    EXPECT_TRUE(lawn.shadow.usable(lawn.at(1), eye_of_lawn));
    EXPECT_EQ(lawn.shadow.value(lawn.at(1), eye_of_lawn), 0) << "it would show the same";
    const ShadowScene soon = lawn.at(1.02);  // 8 cm, about a pixel
    ASSERT_TRUE(lawn.shadow.plan(soon, eye_of_lawn));
    EXPECT_TRUE(lawn.shadow.usable(soon, eye_of_lawn));
    const float little = lawn.shadow.value(soon, eye_of_lawn);
    EXPECT_GT(little, 0);
    EXPECT_LT(little, first);
    const ShadowScene late = lawn.at(1.2);
    ASSERT_TRUE(lawn.shadow.plan(late, eye_of_lawn));
    EXPECT_FALSE(lawn.shadow.usable(late, eye_of_lawn)) << "80 cm off";
    EXPECT_NEAR(lawn.shadow.value(late, eye_of_lawn), first, 0.2F * first) << "all of it is at stake";
    ShadowScene old = lawn.at(1.005);
    EXPECT_TRUE(lawn.shadow.usable(old, eye_of_lawn));
    old.time_s = 1.3;
    EXPECT_FALSE(lawn.shadow.usable(old, eye_of_lawn));
    const ShadowScene a_turn_later = lawn.at(9);
    EXPECT_TRUE(lawn.shadow.usable(a_turn_later, eye_of_lawn)) << "it stands there again";
    lawn.shadow.forget();
    EXPECT_FALSE(lawn.shadow.usable(lawn.at(1), eye_of_lawn));
}

TEST(MovingShadow, IsNotPlannedByNightOrFarFromTheEyeOrBehindIt) {
    PlannedLawn lawn;
    lawn.light = model::daylight_at(0, lawn.m.light);
    EXPECT_FALSE(lawn.shadow.plan(lawn.at(1), eye_of_lawn));
    lawn.light = model::daylight_at(12, lawn.m.light);
    EXPECT_TRUE(lawn.shadow.plan(lawn.at(1), eye_of_lawn));
    ShadowEye far = eye_of_lawn;
    far.pose.position *= 60;
    EXPECT_FALSE(lawn.shadow.plan(lawn.at(1), far)) << "a pixel or two";
    ShadowEye away = eye_of_lawn;
    away.pose.orientation = glm::quatLookAt(dvec3(0, 0.3, 0.95), dvec3(0, 1, 0));
    EXPECT_FALSE(lawn.shadow.plan(lawn.at(1), away));
}

TEST(MovingShadow, IsWorthThePictureAtMost) {
    PlannedLawn lawn;
    const ShadowScene scene = lawn.at(1);
    ASSERT_TRUE(lawn.shadow.plan(scene, eye_of_lawn));
    const Index ball = lawn.shadow.items()[0].node;
    ShadowEye below = eye_of_lawn;
    below.pose.position = lawn.moving.box(ball, lawn.poses).centre() - 2.5 * lawn.m.sun_direction;
    ASSERT_TRUE(lawn.shadow.plan(scene, below));
    EXPECT_LE(lawn.shadow.value(scene, below), static_cast<float>(lawn_picture.width * lawn_picture.height)) << "in the shadow";
    EXPECT_GT(lawn.shadow.value(scene, below), lawn.shadow.value(scene, eye_of_lawn));
}

TEST(MovingShadow, AllocatesNothingAfterItIsMade) {
    PlannedLawn lawn;
    int drawn = 0;
    const std::uint64_t before = test::allocations();
    for (int i = 0; i < 20; ++i) {
        const ShadowScene scene = lawn.at(0.1 * i);
        if (!lawn.shadow.plan(scene, eye_of_lawn) || !(lawn.shadow.value(scene, eye_of_lawn) > 0)) continue;
        lawn.shadow.drawn(scene.time_s);
        ++drawn;
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_EQ(drawn, 20);
}

/// A lawn over which 70 small balls go up and down, in rows; those in front are larger on the picture.
const model::Model& baked_rows() {
    static const model::Model baked = [] {
        importer::Scene scene = lawn_and_ball();
        scene.nodes.pop_back();
        const auto bead = bake::add_mesh(scene, bake::ball(6, 0.4F), "bead");
        for (int i = 0; i < 70; ++i)
            bake::place_moving(scene, bead, dvec3(2 * (i % 10) - 9, 1, 2 * (i / 10) - 6),
                               bake::add_lift(scene, dvec3(0, 1 + 0.01 * i, 0), 10));
        auto m = bake::bake(scene, {}, {});
        EXPECT_TRUE(m.ok());
        return std::move(*m);
    }();
    return baked;
}

std::vector<Index> nodes_in(const MovingShadow& shadow) {
    std::vector<Index> nodes;
    for (const gl::DrawItem& item : shadow.items()) nodes.push_back(item.node);
    return nodes;
}

TEST(MovingShadow, OfManyThatMoveAPlanLooksAtSomeAndTheNextAtOthers) {
    PlannedLawn all(baked_rows(), {.casters = 3}), some(baked_rows(), {.casters = 3, .poses = 8, .boxes = 16});
    ASSERT_TRUE(all.shadow.plan(all.at(1), eye_of_lawn));
    const std::vector<Index> largest = nodes_in(all.shadow);
    ASSERT_EQ(largest.size(), 3U);
    for (int plan = 0; plan < 18; ++plan) {  // 4 new ones each
        ASSERT_TRUE(some.shadow.plan(some.at(1), eye_of_lawn));
        if (plan > 0) continue;
        EXPECT_NE(nodes_in(some.shadow), largest) << "it looked at more than the limit";
    }
    EXPECT_EQ(nodes_in(some.shadow), largest) << "some are never looked at";
}

TEST(MovingShadow, Holds64OfMoreAndAllocatesNothingForThem) {
    PlannedLawn rows(baked_rows()), some(baked_rows(), {.poses = 32, .boxes = 40});
    int drawn = 0;
    const std::uint64_t before = test::allocations();
    for (PlannedLawn* lawn : {&rows, &some}) {
        for (int i = 0; i < 10; ++i) {
            const ShadowScene scene = lawn->at(0.3 * i);
            if (!lawn->shadow.plan(scene, eye_of_lawn) || !(lawn->shadow.value(scene, eye_of_lawn) > 0)) continue;
            lawn->shadow.drawn(scene.time_s);
            ++drawn;
        }
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_EQ(drawn, 20);
    EXPECT_EQ(nodes_in(rows.shadow).size(), 64U) << "of 70";
    EXPECT_LE(nodes_in(some.shadow).size(), 32U);
}

/// A ball 300 m away would make texels too wide. One on an arm goes where both of its motions take it.
TEST(MovingShadow, LeavesOutWhatWidensTexelsAndFollowsOuterMotions) {
    importer::Scene scene = lawn_and_ball();
    const importer::Index ball = scene.nodes.back().mesh;
    const auto arm = bake::add_turn(scene, dvec3(0, 3, 0), dvec3(0, 1, 0), 20);
    scene.nodes.back().motion = bake::add_lift(scene, dvec3(0, 2, 0), 10, arm);
    bake::place_moving(scene, ball, dvec3(0, 3, -300), bake::add_lift(scene, dvec3(0, 2, 0), 12), dvec3(4));
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    PlannedLawn lawn(*m);
    ASSERT_TRUE(lawn.shadow.plan(lawn.at(5), eye_of_lawn));
    ASSERT_EQ(nodes_in(lawn.shadow).size(), 1U);
    const Box box = lawn.moving.box(nodes_in(lawn.shadow)[0], lawn.poses);
    EXPECT_LT(glm::length(box.centre() - dvec3(0, 5, -5)), 0.1) << "a quarter of a turn, and 2 m up";
    EXPECT_LT(glm::length(lawn.shadow.view().origin - box.centre()), 1);
    EXPECT_LE(lawn.shadow.view().texel_m, MovingShadow::max_texel_m);
}

TEST(MovingShadow, WhatDoesNotFitIntoTheMapIsNotInIt) {
    PlannedLawn by_casters(baked_rows(), {.casters = 3}), by_items(baked_rows(), {.items = 3});
    const ShadowScene scene = by_items.at(1);
    ASSERT_TRUE(by_casters.shadow.plan(by_casters.at(1), eye_of_lawn));
    ASSERT_TRUE(by_items.shadow.plan(scene, eye_of_lawn));
    EXPECT_EQ(nodes_in(by_items.shadow), nodes_in(by_casters.shadow));
    EXPECT_EQ(by_items.shadow.value(scene, eye_of_lawn), by_casters.shadow.value(scene, eye_of_lawn));
}

/// Two hundred beads that move together: a tree of many nodes, whose forms hardly fit into a small map.
TEST(MovingShadow, APlanLooksAtABoundedNumberOfNodes) {
    importer::Scene scene = lawn_and_ball();
    scene.nodes.pop_back();
    const auto bead = bake::add_mesh(scene, bake::ball(6, 0.4F), "bead");
    const auto lift = bake::add_lift(scene, dvec3(0, 1, 0), 10);
    for (int row = 0; row < 10; ++row)
        for (int column = 0; column < 20; ++column) bake::place_moving(scene, bead, dvec3(column - 9.5, 1, 1.5 * row - 6), lift);
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    std::size_t bound_reached = 0;
    for (const std::size_t items : {4U, 8U, 16U, 32U, 64U, 4096U}) {
        PlannedLawn lawn(*m, {.items = items});
        ASSERT_TRUE(lawn.shadow.plan(lawn.at(1), eye_of_lawn)) << items;
        EXPECT_GT(lawn.shadow.visits(), 0U) << items;
        EXPECT_LT(lawn.shadow.visits(), items) << items;
        EXPECT_LE(lawn.shadow.items().size(), items) << items;
        bound_reached += lawn.shadow.visits() + 1 == items ? 1 : 0;
    }
    EXPECT_GT(bound_reached, 0U) << "else nothing is bounded here";
}

TEST(MovingShadow, ANewcomerIsOfferedAndHidesNoOther) {
    importer::Scene scene = lawn_and_ball();
    scene.nodes.back().motion = bake::add_lift(scene, dvec3(0, 1e-4, 0), 100);  // as good as still
    bake::place_moving(scene, scene.nodes.back().mesh, dvec3(400, 2, 0), bake::add_lift(scene, dvec3(-400, 0, 0), 10));
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    PlannedLawn lawn(*m);
    ASSERT_TRUE(lawn.shadow.plan(lawn.at(0), eye_of_lawn));
    EXPECT_EQ(lawn.shadow.items().size(), 1U) << "the other is far away";
    lawn.shadow.drawn(0);
    const ShadowScene later = lawn.at(4.5);
    ASSERT_TRUE(lawn.shadow.plan(later, eye_of_lawn));
    EXPECT_EQ(lawn.shadow.items().size(), 2U);
    EXPECT_TRUE(lawn.shadow.usable(later, eye_of_lawn));
    EXPECT_GT(lawn.shadow.value(later, eye_of_lawn), 50) << "the newcomer's pixels";
}

/// Frames of one engine.
struct ShadowFrames {
    std::unique_ptr<Engine> engine;
    prepare::PreparedFrame prepared;
    Pose pose = over_the_lawn();
    std::int64_t at_ns = -1;  ///< of the next frame; below 0: none rests
    SubmitLimits limits{.limit_us = 1e6};

    explicit ShadowFrames(gl::BackendKind backend, model::Model model = baked_lawn(), double rest_after_ms = 0,
                          std::uint32_t samples = 1) {
        EngineOptions options;
        options.device.samples = samples;
        options.rest_after_ms = rest_after_ms;
        options.device.kind = backend;
        options.device.viewport = lawn_picture;
        options.device.switches = {model::effect_moving_shadow};
        auto opened = Engine::open(std::move(model), model::default_costs(), options);
        if (!opened) {
            EXPECT_EQ(opened.error().kind, ErrorKind::unsupported) << opened.error().text();
            return;
        }
        engine = std::move(*opened);
        engine->device().draws.plays();
        engine->reserve(prepared);
    }
    SubmitReport frame(double time_s, double budget_us = 1e6) {
        limits.frame_ns = at_ns;
        if (at_ns >= 0) at_ns += 33'000'000;
        return test::moving_frame(*engine, prepared, pose, time_s, budget_us, limits);
    }
    std::vector<std::uint8_t> pixels() {
        engine->device().draws.plays();
        auto image = engine->device().read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? std::move(image->rgba) : std::vector<std::uint8_t>{};
    }
};

TEST(MovingShadow, IsBoughtWhenItChangesPaidForAndCounted) {
    ShadowFrames frames(gl::BackendKind::null);
    ASSERT_NE(frames.engine, nullptr);
    const SubmitReport first = frames.frame(1);
    EXPECT_TRUE(first.shadow_refreshed && first.shadow_shown);
    EXPECT_EQ(first.bought_items, 1U);
    EXPECT_GT(first.bought_us, 30) << "more than the end of a slice";
    EXPECT_NEAR(first.finished_us, first.predicted_us, 1e-3 * first.predicted_us) << "the device charges what was predicted";
    const SubmitReport same = frames.frame(1);
    EXPECT_FALSE(same.shadow_refreshed) << "it would show the same";
    EXPECT_TRUE(same.shadow_shown);
    EXPECT_EQ(same.bought_items, 0U);
    EXPECT_TRUE(frames.frame(1.1).shadow_refreshed);
}

/// The device draws while the time of the clock stands still: only what is in flight counts.
TEST(MovingShadow, IsInFlightUntilTheFirstSliceIsDrawn) {
    ShadowFrames frames(gl::BackendKind::null);
    ASSERT_NE(frames.engine, nullptr);
    frames.limits.limit_us = frames.frame(1).bought_us;
    frames.limits.now_ns = [](void*) -> std::int64_t { return 0; };
    const SubmitReport kept = frames.frame(1);
    EXPECT_FALSE(kept.shadow_refreshed);
    EXPECT_EQ(kept.downgraded_slices, 0U);
    const SubmitReport anew = frames.frame(2);
    EXPECT_TRUE(anew.shadow_refreshed);
    EXPECT_GT(anew.downgraded_slices, 0U) << "the map alone takes all of the time";
}

TEST(MovingShadow, StaysForAWhileWhereThereIsNoTimeAndIsThenLeftOut) {
    ShadowFrames frames(gl::BackendKind::null);
    ASSERT_NE(frames.engine, nullptr);
    frames.frame(1);
    const double floor_us = 1;  // nothing but the floor
    const SubmitReport soon = frames.frame(1.02, floor_us);
    EXPECT_FALSE(soon.shadow_refreshed);
    EXPECT_TRUE(soon.shadow_shown) << "a pixel off";
    EXPECT_FALSE(frames.frame(1.2, floor_us).shadow_shown);
    EXPECT_TRUE(frames.frame(1.2).shadow_shown);
}

TEST(MovingShadow, ThatIsForgottenIsInNoPictureUntilItIsBought) {
    ShadowFrames frames(gl::BackendKind::null);
    ASSERT_NE(frames.engine, nullptr);
    const SubmitReport first = frames.frame(1);
    ASSERT_TRUE(first.shadow_refreshed);
    frames.engine->forget_shadow();
    const SubmitReport again = frames.engine->submit(frames.pose, frames.limits);
    EXPECT_TRUE(again.shadow_refreshed && again.shadow_shown) << "the selection bought it";
    EXPECT_EQ(again.predicted_us, first.predicted_us);
    frames.engine->forget_shadow();
    const double floor_us = 1;
    const SubmitReport poor = frames.frame(1, floor_us);
    EXPECT_FALSE(poor.shadow_refreshed || poor.shadow_shown) << "an earlier frame paid for it";
    frames.engine->forget_shadow();
    EXPECT_FALSE(frames.engine->submit(frames.pose, frames.limits).shadow_refreshed) << "this selection did not buy it";
}

/// A ball whose shadow falls on the middle of the lawn from `high_m` at time 0, by the sun of baked_lawn().
dvec3 above_the_middle(double high_m) {
    const dvec3 sun(baked_lawn().sun_direction);
    return sun * (high_m / sun.y);
}

TEST(MovingShadow, IsJudgedWhereItFallsAndNotAtWhatCastsIt) {
    importer::Scene scene = lawn_and_ball();
    const importer::Index ball = scene.nodes.back().mesh;
    scene.nodes.pop_back();
    bake::place_moving(scene, ball, above_the_middle(60), bake::add_lift(scene, dvec3(20, 0, 0), 10));  // 5 m/s
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    PlannedLawn high(*m);
    ShadowEye near = eye_of_lawn, far = eye_of_lawn;
    near.pose.position = dvec3(0, 4, 0);
    near.pose.orientation = glm::quatLookAt(dvec3(0, -1, 0), dvec3(0, 0, -1));
    far.pose.position = dvec3(0, 60, 0);
    far.pose.orientation = near.pose.orientation;
    for (const bool is_near : {true, false}) {
        const ShadowEye& eye = is_near ? near : far;
        ASSERT_TRUE(high.shadow.plan(high.at(0), eye));
        high.shadow.drawn(0);
        EXPECT_TRUE(high.shadow.usable(high.at(0.001), eye));
        EXPECT_EQ(high.shadow.usable(high.at(0.02), eye), !is_near) << "10 cm at 4 m, or at 60 m";
    }
}

TEST(MovingShadow, OfWhatSinksGoesFartherWhereTheSunIsLow) {
    importer::Scene scene = lawn_and_ball();
    scene.nodes.back().motion = bake::add_lift(scene, dvec3(0, 20, 0), 10);  // 5 m/s
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    PlannedLawn lift(*m);
    for (const bool low : {false, true}) {
        lift.light.sun_direction = glm::normalize(low ? vec3(0.8F, 0.2F, 0.6F) : vec3(0, 1, 0));
        ASSERT_TRUE(lift.shadow.plan(lift.at(1), eye_of_lawn));
        lift.shadow.drawn(1);
        EXPECT_EQ(lift.shadow.usable(lift.at(1.015), eye_of_lawn), !low) << "8 cm up, 37 cm on the ground";
        lift.shadow.drawn(1);
        ShadowScene turned = lift.at(1);
        lift.light.sun_direction = glm::normalize(lift.light.sun_direction + vec3(0.01F, 0, 0));
        EXPECT_EQ(lift.shadow.usable(turned, eye_of_lawn), !low) << "the sun turns by half a degree";
    }
}

TEST(MovingShadow, EndsARestAsItComesIntoView) {
    importer::Scene scene = lawn_and_ball();
    scene.nodes.pop_back();
    bake::place_moving(scene, scene.nodes.back().mesh, above_the_middle(40), bake::add_lift(scene, dvec3(600, 0, 0), 100));
    auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    ShadowFrames frames(gl::BackendKind::null, std::move(*m), 200);
    ASSERT_NE(frames.engine, nullptr);
    frames.pose.position = dvec3(0, 15, 0);
    frames.pose.orientation = glm::quatLookAt(dvec3(0, -1, 0), dvec3(0, 0, -1));  // what casts is never in view
    frames.at_ns = 0;
    bool rested = false;
    for (int i = 0; i < 20; ++i) rested = frames.frame(50 + 0.033 * i).at_rest;
    EXPECT_TRUE(rested) << "600 m away";
    const SubmitReport back = frames.frame(100);
    EXPECT_FALSE(back.at_rest);
    EXPECT_TRUE(back.shadow_refreshed && back.shadow_shown);
    EXPECT_FALSE(frames.frame(100.033).at_rest);
    for (int i = 0; i < 20; ++i) rested = frames.frame(150 + 0.033 * i).at_rest;
    EXPECT_TRUE(rested) << "it went again";
}

TEST(MovingShadow, GoesWithItsSwitchAndTheSun) {
    ShadowFrames frames(gl::BackendKind::null);
    ASSERT_NE(frames.engine, nullptr);
    frames.engine->hide_effects(model::effect_moving_shadow);
    const SubmitReport hidden = frames.frame(1);
    EXPECT_FALSE(hidden.shadow_refreshed || hidden.shadow_shown);
    frames.engine->hide_effects(0);
    EXPECT_TRUE(frames.frame(1).shadow_shown);
    frames.engine->set_light(model::daylight_at(0, frames.engine->model().light));
    const SubmitReport night = frames.frame(1);
    EXPECT_FALSE(night.shadow_refreshed || night.shadow_shown);
}

TEST(MovingShadow, IsInPicturesOfSeveralSamples) {
    ShadowFrames frames(gl::BackendKind::egl, baked_lawn(), 0, 4);
    if (frames.engine == nullptr) GTEST_SKIP() << "EGL is not there, or a sanitizer allows no GL";
    EXPECT_TRUE(frames.frame(1).shadow_shown);
    const std::vector<std::uint8_t> with = frames.pixels();
    frames.engine->draw_unbudgeted(over_the_lawn(), frames.engine->full_detail(over_the_lawn()));
    const std::vector<std::uint8_t> without = frames.pixels();
    ASSERT_EQ(with.size(), without.size());
    std::size_t darker = 0;
    for (std::size_t i = 0; i < with.size(); ++i) darker += with[i] + 8 < without[i] ? 1 : 0;
    EXPECT_GT(darker, 150U);
}

TEST(MovingShadow, IsInThePictureOfFramesAndInNoOther) {
    ShadowFrames frames(gl::BackendKind::egl);
    if (frames.engine == nullptr) GTEST_SKIP() << "EGL is not there, or a sanitizer allows no GL";
    frames.frame(1);
    const std::vector<std::uint8_t> with = frames.pixels();
    frames.frame(3);
    const std::vector<std::uint8_t> later = frames.pixels();
    EXPECT_NE(later, with);
    frames.frame(1);
    EXPECT_EQ(frames.pixels(), with) << "by the time alone";
    const auto items = frames.engine->full_detail(over_the_lawn());
    frames.engine->draw_unbudgeted(over_the_lawn(), items);
    const std::vector<std::uint8_t> without = frames.pixels();
    std::size_t darker = 0, brighter = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        darker += with[i] + 8 < without[i] ? 1 : 0;
        brighter += with[i] > without[i] + 8 ? 1 : 0;
    }
    EXPECT_GT(darker, 150U) << "a ball of 2 m at 20 m";
    EXPECT_LT(brighter, 20U);
    EXPECT_TRUE(frames.engine->refresh_shadow(over_the_lawn()));
    frames.engine->draw_unbudgeted(over_the_lawn(), items);
    EXPECT_EQ(frames.pixels(), with) << "all is in full detail";
}

}  // namespace
}  // namespace surefoot
