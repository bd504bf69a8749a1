// Shares of frames and triangles with an effect, where it is, and effects spread over all materials.
#include "tools/accuracy/effect_use.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "render/model/walk_file.hpp"
#include "tests/accuracy/effect_scene.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/accuracy/all_on.hpp"

namespace surefoot::accuracy {
namespace {

using test::EffectScene;

// As they stand in model::Effect.
constexpr std::size_t texture = 0, vertex_colour = 1, sun = 2;

TEST(EffectUse, FramesAndTrianglesWithAnEffectAreCounted) {
    const EffectScene scene;
    const auto of_reps = triangles_of_reps(scene.model);
    FramesInUse frames;
    const auto draw = [&](std::vector<model::Index> reps) { frames.add(scene.model, of_reps, reps); };
    draw({EffectScene::lamp_a, EffectScene::wall});
    draw({EffectScene::lamp_a, EffectScene::lamp_b});
    draw({EffectScene::cluster_form});
    draw({});
    EXPECT_EQ(frames.frames, 4U);
    EXPECT_EQ(frames.triangles, 15U + 20 + 2);
    EXPECT_DOUBLE_EQ(frames.share_of_frames(texture), 2.0 / 4);
    EXPECT_DOUBLE_EQ(frames.share_of_triangles(texture), 18.0 / 37);
    EXPECT_DOUBLE_EQ(frames.share_of_frames(sun), 1.0 / 4);
    EXPECT_DOUBLE_EQ(frames.share_of_triangles(sun), 5.0 / 37);
    EXPECT_DOUBLE_EQ(frames.share_of_frames(vertex_colour), 1.0 / 4) << "the cluster's form alone has it";
    EXPECT_DOUBLE_EQ(frames.share_of_triangles(vertex_colour), 2.0 / 37);
    EXPECT_DOUBLE_EQ(FramesInUse{}.share_of_frames(texture), 0) << "of no frame";
}

TEST(EffectUse, ObjectsOfOneNameHoldAnEffectTogether) {
    EffectScene scene;
    scene.model.materials[EffectScene::lit].effects |= model::effect_texture;
    const auto holders = holders_of(scene.model, texture);
    ASSERT_EQ(holders.size(), 2U);
    EXPECT_EQ(holders[0].name, "lamp");
    EXPECT_EQ(holders[0].objects, 2U);
    EXPECT_DOUBLE_EQ(holders[0].share, 12.0 / 17) << "the lamps' bare parts do not count";
    EXPECT_EQ(holders[1].name, "wall");
    EXPECT_EQ(holders[1].objects, 1U);
    EXPECT_DOUBLE_EQ(holders[1].share, 5.0 / 17);
    EXPECT_TRUE(holders_of(scene.model, vertex_colour).empty()) << "coarse forms are no place";
}

TEST(EffectUse, DrawnItemsAreNamedWithTheirPlaceAndWhatOfThemSeesSky) {
    EffectScene scene;
    for (model::Vertex& v : scene.model.vertices) v.hidden[0] = 255;
    scene.vertex_of(EffectScene::textured).hidden[0] = 254;  // of both lamps the first
    scene.model.nodes[2].box = {dvec3(4, 0, 2), dvec3(6, 2, 4)};
    const auto of_reps = triangles_of_reps(scene.model);
    FramesInUse frames;
    frames.add(scene.model, of_reps, std::array{EffectScene::lamp_b, EffectScene::wall});
    frames.add(scene.model, of_reps, std::array{EffectScene::lamp_a, EffectScene::lamp_b});
    const std::vector<DrawnHolder> lamps = drawn_holders(scene.model, frames, texture);
    ASSERT_EQ(lamps.size(), 1U);
    EXPECT_EQ(lamps[0].name, "lamp");
    EXPECT_EQ(lamps[0].items, 3U);
    EXPECT_EQ(lamps[0].node, 2U) << "drawn in both frames";
    EXPECT_EQ(lamps[0].middle_m, dvec3(5, 1, 3));
    EXPECT_EQ(lamps[0].vertices, 3U) << "without those of its bare triangles";
    EXPECT_EQ(lamps[0].see_sky, 0U) << "of the other lamp one does";
    EXPECT_TRUE(drawn_holders(scene.model, frames, vertex_colour).empty());
    scene.model.materials[EffectScene::lit].two_sided = true;
    EXPECT_EQ(drawn_holders(scene.model, frames, sun).at(0).see_sky, drawn_holders(scene.model, frames, sun).at(0).vertices)
        << "its back sees all of it";
}

TEST(EffectUse, OfAPathThatLooksAwayHalfTheTimeIsHalf) {
    auto model = model::read_walk(test::Forest::get().model_file);
    ASSERT_TRUE(model.ok());
    const Box box = model->nodes[0].box;
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = {160, 90};
    auto engine = Engine::open(std::move(*model), model::default_costs(), options);
    ASSERT_TRUE(engine.ok()) << engine.error().text();
    std::array<Pose, 2> poses;
    poses[0].position = poses[1].position = box.centre() + dvec3(0, 0, box.diagonal());  // at first, poses look along -z
    poses[1].orientation = dquat(0, 0, 1, 0);                                            // half a turn about y
    const UseOfEffects use = measure_use(**engine, poses, {});
    for (const FramesInUse* frames : {&use.full, &use.walked}) {
        EXPECT_EQ(frames->frames, 2U);
        EXPECT_GT(frames->triangles, 0U);
        EXPECT_DOUBLE_EQ(frames->share_of_frames(sun), 0.5);
    }
    EXPECT_LE(use.walked.triangles, use.full.triangles) << "a walk has no time for more";
}

TEST(EffectUse, WhatShowsNoSkyDoesNotCountForTheSun) {
    EffectScene scene;
    scene.model.materials[EffectScene::lit].effects |= model::effect_openness;
    scene.model.materials[EffectScene::lit].two_sided = true;
    for (model::Vertex& v : scene.model.vertices) v.hidden[0] = 255;  // their fronts look to +z
    EngineOptions options;
    options.device.kind = gl::BackendKind::null;
    options.device.viewport = {160, 90};
    auto engine = Engine::open(std::move(scene.model), model::default_costs(), options);
    ASSERT_TRUE(engine.ok()) << engine.error().text();
    std::array<Pose, 2> poses;
    poses[0].position = dvec3(0, 0, 12);  // at first, poses look along -z
    poses[1].position = dvec3(0, 0, -12);
    poses[1].orientation = dquat(0, 0, 1, 0);  // half a turn about y
    const UseOfEffects use = measure_use(**engine, poses, {});
    EXPECT_EQ(use.full.frames, 2U);
    EXPECT_EQ(use.full.frames_with[sun], 1U) << "from behind";
    EXPECT_EQ(use.full.first_frame[sun], 1U);
    EXPECT_EQ(use.full.triangles_with[sun], 5U);
}

TEST(AllOn, EveryMaterialHasEachEffectThatChangesNoPicture) {
    EffectScene scene;
    scene.model.materials[EffectScene::textured].effects |= model::effect_alpha_mask;
    scene.model.materials[EffectScene::textured].alpha_cutoff = 0.5F;
    EXPECT_EQ(programs_of(scene.model), 4U);
    const AllOn found = turn_all_on(scene.model);
    const auto& materials = scene.model.materials;
    const model::EffectMask everywhere = model::effect_texture | model::effect_vertex_colour | model::effect_alpha_mask;
    EXPECT_EQ(materials[EffectScene::bare].effects, everywhere);
    EXPECT_EQ(materials[EffectScene::textured].effects, everywhere);
    EXPECT_EQ(materials[EffectScene::lit].effects, everywhere | model::effect_sun) << "light is for lit materials alone";
    EXPECT_EQ(materials[EffectScene::bare].alpha_cutoff, 0.0F);
    EXPECT_EQ(materials[EffectScene::textured].alpha_cutoff, 0.5F) << "its own";
    EXPECT_EQ(materials[EffectScene::textured].texture, 0U) << "its own";
    const model::Texture& white = scene.model.textures.at(materials[EffectScene::bare].texture);
    EXPECT_EQ(scene.model.texels.at(white.first_byte), std::byte{255});
    EXPECT_EQ(programs_of(scene.model), 2U);
    EXPECT_EQ(programs_of(scene.model, 0xffffffff), 1U) << "bare";

    EXPECT_EQ(found.triangles, 25U);
    ASSERT_EQ(found.effects.size(), 4U) << "what no material has, none gets";
    EXPECT_EQ(found.effects[0].name, "texture");
    EXPECT_EQ(found.effects[0].triangles, 12U);
    EXPECT_EQ(found.effects[0].all_on_triangles, 25U);
    EXPECT_TRUE(found.effects[0].why_not.empty());
    EXPECT_EQ(found.effects[2].name, "sun");
    EXPECT_EQ(found.effects[2].triangles, 5U);
    EXPECT_EQ(found.effects[2].all_on_triangles, 5U);
    EXPECT_FALSE(found.effects[2].why_not.empty());
}

TEST(AllOn, VerticesSayWhichEffectsWouldShow) {
    EffectScene scene;
    scene.vertex_of(EffectScene::bare).colour[1] = 7;
    scene.vertex_of(EffectScene::lit).hidden[2] = 9;  // a corner of the room
    scene.model.materials[EffectScene::textured].effects |= model::effect_openness;
    turn_all_on(scene.model);
    const auto& materials = scene.model.materials;
    EXPECT_EQ(materials[EffectScene::bare].effects & model::effect_vertex_colour, 0U) << "the colour would show";
    EXPECT_EQ(materials[EffectScene::lit].effects & model::effect_openness, 0U) << "the shade would show";
    EXPECT_EQ(materials[EffectScene::textured].effects & model::effect_sun, 0U) << "it sees the sky: the sun would show";
    for (model::Vertex& v : scene.model.vertices) v.hidden[0] = 255;
    turn_all_on(scene.model);
    EXPECT_NE(materials[EffectScene::textured].effects & model::effect_sun, 0U) << "it sees no sky";
}

TEST(AllOn, LeavesABakedModelWhole) {
    auto model = model::read_walk(test::Forest::get().model_file);
    ASSERT_TRUE(model.ok());
    const std::uint32_t programs = programs_of(*model);
    const AllOn found = turn_all_on(*model);
    EXPECT_LE(programs_of(*model), programs);
    const auto valid = model::validate(*model);
    EXPECT_TRUE(valid.ok()) << valid.error().text();
    EXPECT_EQ(found.triangles, model->triangles());
    EXPECT_GE(found.effects.size(), 2U);
}

}  // namespace
}  // namespace surefoot::accuracy
