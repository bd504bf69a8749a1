// Effects by region of the hierarchy, with reasons; and where along a path an effect is drawn first.
#include "tools/accuracy/effect_regions.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "render/model/effects_below.hpp"
#include "tests/accuracy/effect_scene.hpp"
#include "tools/accuracy/effect_use.hpp"

namespace surefoot::accuracy {
namespace {

using test::EffectScene;

TEST(EffectRegions, SayWhatIsCalledForAndWhatOnlyCoarseFormsNeed) {
    EffectScene scene;
    const auto regions = regions_of(scene.model);
    ASSERT_EQ(regions.size(), 3U) << "the root's children";
    EXPECT_EQ(regions[0].triangles + regions[1].triangles + regions[2].triangles, scene.model.triangles());
    for (const EffectRegion& region : regions) {
        const bool is_wall = region.name.find("wall") == 0;
        EXPECT_EQ(region.effects.size(), static_cast<std::size_t>(model::effect_count));
        EXPECT_EQ(effects_in_words(region), is_wall ? "sun" : "texture") << region.name;
        EXPECT_EQ(reasons_in_words(region), is_wall ? "sun: 5 of 5 triangles have it" : "sun: nothing is lit") << region.name;
        for (const RegionEffect& effect : region.effects) EXPECT_FALSE(effect.reason.empty()) << effect.name;
        using Lines = std::vector<std::string>;
        const std::string white = "vertex_colour: all vertices here are white, or have no colours";
        EXPECT_EQ(reason_lines(region),
                  is_wall ? (Lines{"texture: no material here has an image", white, "sun: 5 of 5 triangles have it"})
                          : (Lines{"texture: 6 of 10 triangles have it", white, "sun: nothing is lit"}))
            << region.name;
    }
    scene.model.nodes[0].child_count = 0;  // the cluster's form is full detail now
    const auto one = regions_of(scene.model);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_EQ(effects_in_words(one[0]), "vertex_colour");
}

/// Of effects that the model calls for, and this region does not.
TEST(EffectRegions, EachEffectHasItsOwnReason) {
    EffectScene scene;
    for (model::EffectFinding& finding : scene.model.effects) finding.called_for = true;
    const auto regions = regions_of(scene.model);
    ASSERT_EQ(regions.size(), 3U);
    std::set<std::string> reasons;
    for (const RegionEffect& effect : regions[0].effects) reasons.insert(effect.reason);
    EXPECT_EQ(reasons.size(), regions[0].effects.size());
    EXPECT_EQ(reason_lines(regions[0]).size(), static_cast<std::size_t>(model::effect_count));
    for (const std::string& line : reason_lines(regions[0])) {
        EXPECT_EQ(line.find("by hand"), std::string::npos) << line << ": that is the whole model's";
        EXPECT_EQ(line.find("no material here has it"), std::string::npos) << line << " has no reason of its own";
    }
}

TEST(EffectRegions, OfARoomSeeNoSky) {
    EffectScene scene;
    scene.model.materials[EffectScene::lit].effects = model::effect_openness;
    scene.model.reps[EffectScene::wall].effects = model::effect_openness;
    const auto regions = regions_of(scene.model);
    for (const EffectRegion& region : regions)
        if (region.name.find("wall") == 0) {
            EXPECT_EQ(reasons_in_words(region), "sun: no vertex sees any sky");
            EXPECT_EQ(effects_in_words(region), "openness");
            for (const RegionEffect& effect : region.effects)
                if (effect.name == "baked_shadow" || effect.name == "moving_shadow") {
                    EXPECT_EQ(effect.reason, "the sun reaches nothing");
                }
        }
}

TEST(EffectRegions, AddUpFromTheLeaves) {
    const EffectScene scene;
    const auto below = model::effects_below(scene.model);
    EXPECT_EQ(below[0].full, std::uint32_t{model::effect_texture} | model::effect_sun);
    EXPECT_EQ(below[0].coarse, std::uint32_t{model::effect_vertex_colour}) << "the cluster's form";
    EXPECT_EQ(below[0].triangles, 25U);
    EXPECT_EQ(below[0].with_effect[0], 12U);
    EXPECT_EQ(below[0].leaves, 3U);
    EXPECT_FALSE(model::has_rooms_apart(scene.model));
}

TEST(EffectUse, TheFirstFrameWithAnEffectIsNamed) {
    const EffectScene scene;
    const auto of_reps = triangles_of_reps(scene.model);
    FramesInUse frames;
    const auto draw = [&](std::vector<model::Index> reps) { frames.add(scene.model, of_reps, reps); };
    draw({EffectScene::lamp_a});
    draw({EffectScene::lamp_a, EffectScene::wall});
    draw({EffectScene::wall, EffectScene::lamp_a, EffectScene::lamp_b});
    EXPECT_EQ(frames.frames_with[2], 2U);
    EXPECT_EQ(frames.items_with[2], 2U);
    EXPECT_EQ(frames.first_frame[2], 1U);
    EXPECT_EQ(frames.first_rep[2], EffectScene::wall);
    EXPECT_EQ(frames.items_with[0], 4U);
    EXPECT_EQ(frames.items_with[1], 0U);
    EXPECT_EQ(node_of(scene.model, EffectScene::wall), 3U);
    EXPECT_EQ(node_of(scene.model, 99), model::none);
}

}  // namespace
}  // namespace surefoot::accuracy
