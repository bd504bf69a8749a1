// Who calls for moving shadows, and what the bake says of it.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/engine/moving_lawn.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot {
namespace {

using model::Index;
using test::baked_lawn;
using test::eye_of_lawn;
using test::lawn_and_ball;
using test::PlannedLawn;

const model::EffectFinding& shadow_finding(const model::Model& m) {
    return m.effects.at(static_cast<std::size_t>(std::countr_zero(model::effect_moving_shadow + 0U)));
}

TEST(MovingShadowBake, IsCalledForByWhatStandsLitWithinReach) {
    const model::Model& m = baked_lawn();
    const model::EffectFinding& finding = shadow_finding(m);
    EXPECT_TRUE(finding.called_for);
    EXPECT_EQ(finding.triangles, 800U) << "the lawn";
    EXPECT_EQ(finding.reason, "1 of 1 things that move are opaque and within reach of what is lit and stands still");
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0) continue;
        const bool lawn = std::string(m.name_of(node)) == "lawn";
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r)
            EXPECT_EQ((m.reps[r].effects & model::effect_moving_shadow) != 0, lawn) << m.name_of(node);
    }
}

TEST(MovingShadowBake, IsNotWhereNothingMovesOrIsLitOrIsOpaqueAndSaysSo) {
    importer::Scene still = lawn_and_ball(), glass = lawn_and_ball();
    for (importer::Node& node : still.nodes) node.motion = importer::none;
    glass.materials[1].alpha = model::AlphaMode::blend;
    const std::vector<std::pair<importer::Scene, std::string>> scenes{
        {still, "nothing moves"},
        {glass, "all that moves is transparent"},
        {lawn_and_ball(true), "nothing lit stands within reach of the shadows of what moves"}};
    for (const auto& [scene, why] : scenes) {
        auto m = bake::bake(scene, {}, {});
        ASSERT_TRUE(m.ok());
        EXPECT_FALSE(shadow_finding(*m).called_for);
        EXPECT_EQ(shadow_finding(*m).reason, why);
        EXPECT_EQ(m->called_for() & model::effect_moving_shadow, 0U);
        const test::TemporaryFolder folder;
        ASSERT_TRUE(model::write_walk(folder / "it.walk", *m).ok());
        const auto read = model::read_walk(folder / "it.walk");
        ASSERT_TRUE(read.ok());
        EXPECT_EQ(shadow_finding(*read).looked_for, !m->motions.empty());
        EXPECT_FALSE(read->effects.back().looked_for) << "no later effect is in a file that does not call for it";
        if (!m->motions.empty()) {
            EXPECT_EQ(shadow_finding(*read).reason, why);
        }
    }
}

TEST(MovingShadowBake, IsNotForWhatMovesInAClosedRoom) {
    importer::Scene scene;
    importer::Primitive room;
    lit::add_faces(room, vec3(-3, 0, -3), vec3(3, 4, 3), false);
    lit::add_faces(room, vec3(-2.5F, 0.5F, -2.5F), vec3(2.5F, 3.5F, 2.5F), true);
    lit::put(scene, room, "room", dvec3(0));
    lit::put(scene, lit::floor_of(10, 6), "ground", dvec3(0, -0.01, 0));
    const importer::Index lift = bake::add_mesh(scene, bake::ball(4, 0.3F), "lift");
    bake::place_moving(scene, lift, dvec3(0, 1, 0), bake::add_lift(scene, dvec3(0, 1, 0), 10));
    for (const bool open : {false, true}) {
        if (open) bake::place_moving(scene, lift, dvec3(6, 1, 0), bake::add_lift(scene, dvec3(0, 1, 0), 11));
        bake::BakeOptions full;
        full.quality = bake::Quality::full;
        auto m = bake::bake(scene, full, {});
        ASSERT_TRUE(m.ok());
        EXPECT_EQ(shadow_finding(*m).called_for, open);
        EXPECT_EQ(shadow_finding(*m).reason,
                  open ? "1 of 2 things that move are opaque and within reach of what is lit and stands still"
                       : "all that moves is transparent or sees no sky");
        if (!open) continue;
        PlannedLawn both(*m);
        ASSERT_TRUE(both.shadow.plan(both.at(0), eye_of_lawn));
        EXPECT_EQ(both.shadow.items().size(), 1U) << "that in the room casts as well";
    }
}

/// A pit far from the lawn makes no shadow longer.
TEST(MovingShadowBake, ReachesAsFarAsWhatReceivesIsBelow) {
    importer::Scene scene = lawn_and_ball();
    const auto flag =
        bake::add_mesh(scene, bake::grid_surface(2, 2, [](float u, float v) { return vec3(2 * v, 0, 2 * u); }), "flag");
    bake::place(scene, flag, dvec3(60, 0, 0));     // 10 + 5 * 4 m is less
    bake::place(scene, flag, dvec3(0, -30, 300));  // the pit
    const auto m = bake::bake(scene, {}, {});
    ASSERT_TRUE(m.ok());
    EXPECT_TRUE(shadow_finding(*m).called_for);
    EXPECT_EQ(shadow_finding(*m).triangles, 800U) << "the lawn";
}

TEST(MovingShadowBake, AFileWithoutItIsAsBeforeThereWasAny) {
    const test::TemporaryFolder folder;
    importer::Scene still = lawn_and_ball();
    for (importer::Node& node : still.nodes) node.motion = importer::none;
    auto m = bake::bake(still, {}, {});
    ASSERT_TRUE(m.ok());
    ASSERT_TRUE(model::write_walk(folder / "now.walk", *m).ok());
    auto read = model::read_walk(folder / "now.walk");
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->effects.size(), static_cast<std::size_t>(model::effect_count));
    while (m->effects.back().bit >= model::effect_moving_shadow) m->effects.pop_back();
    ASSERT_TRUE(model::write_walk(folder / "before.walk", *m).ok());
    EXPECT_EQ(*read_file(folder / "now.walk"), *read_file(folder / "before.walk"));
}

/// Where something moves, files have said why it has no shadow; later effects that nothing calls for are not in them.
TEST(MovingShadowBake, AMovingFileWithoutLaterEffectsIsAsBeforeThereWereAny) {
    const test::TemporaryFolder folder;
    auto m = bake::bake(lawn_and_ball(true), {}, {});
    ASSERT_TRUE(m.ok());
    ASSERT_FALSE(shadow_finding(*m).called_for);
    ASSERT_TRUE(model::write_walk(folder / "now.walk", *m).ok());
    while (m->effects.back().bit > model::effect_moving_shadow) m->effects.pop_back();
    ASSERT_TRUE(model::write_walk(folder / "before.walk", *m).ok());
    EXPECT_EQ(*read_file(folder / "now.walk"), *read_file(folder / "before.walk"));
    m->effects.pop_back();
    ASSERT_TRUE(model::write_walk(folder / "less.walk", *m).ok());
    EXPECT_NE(*read_file(folder / "now.walk"), *read_file(folder / "less.walk"));
}

}  // namespace
}  // namespace surefoot
