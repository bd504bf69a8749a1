// The findings of a bake: what a scene calls for, by how many triangles, and why.
#include <gtest/gtest.h>

#include "render/bake/bake.hpp"
#include "render/bake/materials.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

TEST(Findings, NameWhatASceneCallsForAndWhy) {
    test::SmallModel scene;
    auto material = test::plain(1, 1, 1, 1, model::effect_texture | model::effect_sun);
    material.texture = scene.texture({255, 0, 0, 255}, {0, 255, 0, 255});
    scene.square(scene.material(material), test::at(0, 0, -1));
    scene.square(scene.material(test::plain(1, 0, 0)), test::at(0, 0, -2));
    const auto findings = bake::find_effects(scene.finish(), {2, 7});
    ASSERT_EQ(findings.size(), static_cast<std::size_t>(model::effect_count));
    for (std::size_t e = 0; e < findings.size(); ++e) EXPECT_EQ(findings[e].bit, 1U << e);
    EXPECT_TRUE(findings[0].called_for);
    EXPECT_EQ(findings[0].triangles, 2U);
    EXPECT_EQ(findings[0].reason, "1 of 2 materials have an image");
    EXPECT_FALSE(findings[1].called_for);
    EXPECT_EQ(findings[1].triangles, 0U);
    EXPECT_EQ(findings[1].reason, "all vertex colours are white or absent");
    EXPECT_TRUE(findings[2].called_for);
    EXPECT_EQ(findings[2].reason, "1 of 2 materials are lit");
    EXPECT_FALSE(findings[3].called_for);
    EXPECT_FALSE(findings[4].called_for);
}

TEST(Findings, NameWhatOnlyStandInsNeed) {
    test::SmallModel scene;
    scene.square(scene.material(test::plain(1, 1, 1, 1, model::effect_vertex_colour)), test::at(0, 0, -1));
    const auto findings = bake::find_effects(scene.finish(), {0});
    EXPECT_TRUE(findings[1].called_for);
    EXPECT_EQ(findings[1].triangles, 0U);
    EXPECT_NE(findings[1].reason.find("baked representations need it"), std::string::npos) << findings[1].reason;
}

TEST(Findings, OfAnEmptyModelCallForNothing) {
    const auto findings = bake::find_effects({}, {});
    ASSERT_EQ(findings.size(), static_cast<std::size_t>(model::effect_count));
    for (const auto& finding : findings) {
        EXPECT_FALSE(finding.called_for);
        EXPECT_FALSE(finding.reason.empty());
    }
}

TEST(Findings, OfABakedModelCountItsFullDetail) {
    importer::Scene scene;
    scene.materials.emplace_back();
    bake::place(scene, bake::add_mesh(scene, bake::ball(8, 1), "ball"), dvec3(0));
    const auto model = bake::bake(scene, {}, {});
    ASSERT_TRUE(model.ok());
    ASSERT_EQ(model->effects.size(), static_cast<std::size_t>(model::effect_count));
    EXPECT_EQ(model->effects[2].reason, "1 of 1 materials are lit");
    EXPECT_EQ(model->effects[2].triangles, model->triangles());
}

}  // namespace
}  // namespace surefoot
