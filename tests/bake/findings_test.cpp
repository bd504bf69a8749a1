// The findings of a bake: what a scene calls for, by how many triangles, and why.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/materials.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/gl/small_models.hpp"
#include "tests/temporary_folder.hpp"

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

TEST(Findings, CountLampsThatShineOnCopiesWithoutTheSunAsTheOriginals) {
    test::SmallModel scene;
    const auto original = scene.material(test::plain(1, 1, 1, 1, model::effect_sun | model::effect_openness));
    scene.square(original, test::at(0, 0, -1));
    const auto copy = scene.material(test::plain(1, 1, 1, 1, model::effect_openness | model::effect_lamps));
    scene.square(copy, test::at(0, 0, -2));
    bake::SceneLight light;
    light.openness.measured = true;
    light.openness.triangles = 4;
    light.openness.closed = 2;
    light.openness.copies = {{copy, original}};
    light.baked.lit = 17;
    const auto findings = bake::find_effects(scene.finish(), {4}, light);
    EXPECT_TRUE(findings[7].called_for);
    EXPECT_EQ(findings[7].triangles, 4U);
    EXPECT_EQ(findings[7].reason, "1 of 1 materials are lit by lamps; 17 vertices are lit or glow");
    EXPECT_EQ(findings[2].triangles, 2U);
    EXPECT_FALSE(findings[6].called_for);
}

TEST(Findings, OfShadowsAndFogNameVerticesAndMetres) {
    test::SmallModel scene;
    scene.square(scene.material(test::plain(1, 1, 1, 1, model::effect_sun | model::effect_shadow | model::effect_fog)),
                 test::at(0, 0, -1));
    bake::SceneLight light;
    light.baked.vertices = 20;
    light.baked.in_shadow = 3;
    model::Model m = scene.finish();
    m.light.fog_visibility_m = 250;
    const auto findings = bake::find_effects(m, {2}, light);
    EXPECT_EQ(findings[6].reason, "1 of 1 materials lie in shadow; 3 of 20 vertices in the sun lie in shadow at some hour");
    EXPECT_EQ(findings[8].reason, "1 of 1 materials lie in fog; one sees 250 m far");
    EXPECT_FALSE(findings[7].called_for);
    EXPECT_EQ(findings[7].reason, "no lamp and nothing that glows, or the bake is of quality draft");
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

TEST(Findings, OfASkyNameWhoAsksForItAndAFileWithoutItHasNone) {
    constexpr std::size_t sky = std::countr_zero(model::effect_sky + 0U);
    importer::Scene scene;
    scene.materials.emplace_back();
    bake::place(scene, bake::add_mesh(scene, bake::ball(8, 1), "ball"), dvec3(0));
    const test::TemporaryFolder folder;
    const auto bytes_of = [&](const model::Model& model) {
        EXPECT_TRUE(model::write_walk(folder / "it.walk", model).ok());
        return *read_file(folder / "it.walk");
    };
    bake::BakeOptions with_sky;
    with_sky.sky = true;
    importer::Scene extra = scene;
    extra.sky = true;
    auto without = bake::bake(scene, {}, {});
    const auto by_bake = bake::bake(scene, with_sky, {}), by_file = bake::bake(extra, {}, {});
    const auto by_both = bake::bake(extra, with_sky, {});
    ASSERT_TRUE(without.ok() && by_bake.ok() && by_file.ok() && by_both.ok());
    EXPECT_EQ(without->effects[sky].bit, model::effect_sky);
    EXPECT_FALSE(without->effects[sky].called_for);
    EXPECT_EQ(without->effects[sky].reason, "neither the scene nor the bake names a sky");
    for (const auto* model : {&*by_bake, &*by_file, &*by_both}) {
        EXPECT_TRUE(model->effects[sky].called_for);
        EXPECT_EQ(model->effects[sky].triangles, 0U);
        for (std::size_t e = 0; e < sky; ++e) EXPECT_EQ(model->effects[e].reason, without->effects[e].reason);
        for (const model::Material& material : model->materials) EXPECT_EQ(material.effects & model::effect_sky, 0U);
    }
    EXPECT_EQ(by_bake->effects[sky].reason, "a sky is behind everything, as bake --sky says");
    EXPECT_EQ(by_file->effects[sky].reason, "a sky is behind everything, as the scene's file says");
    EXPECT_EQ(by_both->effects[sky].reason, by_file->effects[sky].reason);
    EXPECT_EQ(bytes_of(*by_file), bytes_of(*by_both));
    const auto read = model::read_walk(folder / "it.walk");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->effects[sky].reason, by_file->effects[sky].reason);
    const auto none = bytes_of(*without);
    EXPECT_NE(none, bytes_of(*by_bake));
    without->effects.resize(sky);  // as before there was any
    EXPECT_EQ(none, bytes_of(*without));
    bytes_of(*by_bake);
    EXPECT_TRUE(model::read_walk(folder / "it.walk")->effects[sky].called_for);
}

TEST(Findings, OfWaterGoByExtrasAndByNamesWhereTheseAreAsked) {
    for (const char* name : {"water", "Water", "Pond_water.001", "oceanicWater.png", "swamp water", "WATER-2"})
        EXPECT_TRUE(bake::is_named_water(name)) << name;
    for (const char* name :
         {"waterfall", "waterRockA.png", "underwater", "UNDERWATER", "stktex_waterLily_a.png", "wate", "", "12"})
        EXPECT_FALSE(bake::is_named_water(name)) << name;
    importer::Scene scene;
    scene.materials.resize(3);
    scene.materials[0].name = "lakeWater";
    scene.materials[1].name = "still water";
    scene.materials[1].water = false;
    scene.materials[2].water = true;
    for (const bool by_name : {false, true}) {
        model::Model model;
        bake::add_materials(scene, model, {.water_by_name = by_name});
        EXPECT_EQ((model.materials[0].effects & model::effect_water) != 0, by_name);
        EXPECT_EQ(model.materials[1].effects & model::effect_water, 0U);
        EXPECT_NE(model.materials[2].effects & model::effect_water, 0U);
    }
}

TEST(Findings, OfLightByThePixelGoByExtrasAndByTheBakeWhereTheseSayNothing) {
    using importer::LightPlace;
    importer::Scene scene;
    for (const LightPlace light :
         {LightPlace::by_bake, LightPlace::flat, LightPlace::vertex, LightPlace::pixel, LightPlace::pixel}) {
        scene.materials.emplace_back();
        scene.materials.back().light = light;
    }
    scene.materials.back().unlit = true;
    const auto finding_of = [](const std::vector<model::EffectFinding>& findings) {
        const auto found = std::ranges::find(findings, model::effect_light_by_pixel + 0U, &model::EffectFinding::bit);
        return found != findings.end() ? *found : model::EffectFinding{};
    };
    for (const bool all : {false, true}) {
        model::Model model;
        const model::Index proxy = bake::add_materials(scene, model, {.light_by_pixel = all});
        const auto by_pixel = [&](model::Index m) { return (model.materials[m].effects & model::effect_light_by_pixel) != 0; };
        EXPECT_EQ(by_pixel(0), all);
        EXPECT_FALSE(by_pixel(1)) << "flat: all its pixels have the same normal";
        EXPECT_FALSE(by_pixel(2));
        EXPECT_TRUE(by_pixel(3));
        EXPECT_FALSE(by_pixel(4)) << "unlit";
        EXPECT_FALSE(by_pixel(proxy)) << "coarse forms of several materials";
        const model::EffectFinding found = finding_of(bake::find_effects(model, {1, 1, 1, 1, 1}));
        EXPECT_TRUE(found.called_for);
        EXPECT_EQ(found.reason, all ? "2 of 5 materials are lit by the pixel" : "1 of 5 materials are lit by the pixel");
        EXPECT_EQ(found.triangles, all ? 2U : 1U);
    }
    scene.materials.resize(3);
    model::Model model;
    bake::add_materials(scene, model);
    const model::EffectFinding none = finding_of(bake::find_effects(model, {1, 1, 1}));
    EXPECT_FALSE(none.called_for);
    EXPECT_NE(none.reason.find("by its extras or by bake --light-by-pixel"), std::string::npos) << none.reason;
}

}  // namespace
}  // namespace surefoot
