// The town with its lamps: what shines and glows, that all else is the town without them, and what comes back from its file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/temporary_folder.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {
namespace {

using importer::Index;
using importer::Lamp;
using importer::none;

GeneratedScene town(bool lamps, double scale = 1, std::uint64_t seed = 1) {
    auto scene = generate(town_name, scale, seed, lamps);
    EXPECT_TRUE(scene.ok()) << scene.error().text();
    return std::move(*scene);
}

std::vector<importer::Material> glowing(const importer::Scene& scene) {
    std::vector<importer::Material> out;
    for (const importer::Material& material : scene.materials)
        if (material.emission != vec3(0)) out.push_back(material);
    return out;
}

TEST(TownLamps, OnlyTheTownHasThemAndOnlyWhenAskedFor) {
    for (const std::string& name : scene_names()) {
        const auto plain = generate(name, 0.1, 1);
        ASSERT_TRUE(plain.ok());
        EXPECT_TRUE(plain->scene.lamps.empty() && glowing(plain->scene).empty()) << name;
        const auto lit = generate(name, 0.1, 1, true);
        EXPECT_EQ(lit.ok(), name == town_name) << name;
        if (lit.ok()) continue;
        EXPECT_EQ(lit.error().kind, ErrorKind::misuse);
        EXPECT_NE(lit.error().text().find("no lamps"), std::string::npos) << lit.error().text();
        EXPECT_NE(lit.error().remedy.find("town"), std::string::npos);
    }
}

TEST(TownLamps, EachStreetLampShinesDownFromBelowItsHeadAndTheKitchenHasOne) {
    const GeneratedScene lit = town(true);
    std::vector<dvec3> posts;
    for (const importer::Node& node : lit.scene.nodes)
        if (node.name == "street lamp") posts.push_back(dvec3(node.world[3]));
    ASSERT_GT(posts.size(), 60U);
    ASSERT_EQ(lit.scene.lamps.size(), posts.size() + 1);
    std::size_t in_rooms = 0;
    double nearest_m = 1e9;
    for (const Lamp& lamp : lit.scene.lamps) {
        EXPECT_TRUE(lamp.candela >= 30 && lamp.candela <= 80 && lamp.range_m >= 12 && lamp.range_m <= 20);
        EXPECT_TRUE(lamp.colour.r > lamp.colour.g && lamp.colour.g > lamp.colour.b) << "warm";
        if (lamp.name != "street lamp") {
            ++in_rooms;
            EXPECT_FALSE(lamp.spot());
            for (const PathSample& sample : lit.path.samples)
                nearest_m = std::min(nearest_m, glm::length(sample.pose.position - lamp.at));
            continue;
        }
        EXPECT_TRUE(lamp.spot());
        EXPECT_EQ(lamp.towards, dvec3(0, -1, 0));
        const auto under = std::count_if(posts.begin(), posts.end(), [&](const dvec3& post) {
            const dvec3 arm = lamp.at - post;
            return std::abs(std::hypot(arm.x, arm.z) - 0.7) < 1e-9 && arm.y > 2.9 && arm.y < 3.13;
        });
        EXPECT_EQ(under, 1);
    }
    EXPECT_EQ(in_rooms, 1U);
    EXPECT_LT(nearest_m, 3.0) << "in the house that the path goes through";
    EXPECT_GT(nearest_m, 0.5);
}

TEST(TownLamps, AboutTwoWindowsOfFiveGlowAndHousesDiffer) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const GeneratedScene lit = town(true, 1, seed);
        EXPECT_EQ(glowing(lit.scene).size(), 2U) << "heads of lamps and windows";
        std::size_t panes = 0, glow = 0;
        std::set<Index> meshes;
        for (const importer::Node& node : lit.scene.nodes) {
            if (node.name != "windows") continue;
            meshes.insert(node.mesh);
            for (const importer::Primitive& p : lit.scene.meshes[node.mesh].primitives) {
                const importer::Material& material = lit.scene.materials[p.material];
                if (material.alpha != model::AlphaMode::blend) continue;
                panes += p.indices.size() / 6;
                glow += material.emission != vec3(0) ? p.indices.size() / 6 : 0;
            }
        }
        EXPECT_GT(panes, 500U);
        EXPECT_NEAR(static_cast<double>(glow) / static_cast<double>(panes), 0.4, 0.03) << "seed " << seed;
        EXPECT_GE(meshes.size(), 12U) << "of four choices for each of four kinds of houses";
    }
}

TEST(TownLamps, AllElseIsTheTownWithoutThem) {
    const GeneratedScene lit = town(true, 0.3, 5), plain = town(false, 0.3, 5);
    std::vector<importer::Node> others;
    for (const importer::Node& node : lit.scene.nodes)
        if (node.name != "bulb") others.push_back(node);
    ASSERT_EQ(others.size(), plain.scene.nodes.size());
    ASSERT_EQ(others.size() + 1, lit.scene.nodes.size());
    for (std::size_t i = 0; i < others.size(); ++i) {
        ASSERT_EQ(others[i].name, plain.scene.nodes[i].name);
        ASSERT_EQ(others[i].world, plain.scene.nodes[i].world);
        ASSERT_EQ(others[i].mesh == none, plain.scene.nodes[i].mesh == none);
        if (others[i].mesh == none) continue;
        std::size_t corners = 0, plain_corners = 0;
        for (const importer::Primitive& p : lit.scene.meshes[others[i].mesh].primitives) corners += p.indices.size();
        for (const importer::Primitive& p : plain.scene.meshes[plain.scene.nodes[i].mesh].primitives)
            plain_corners += p.indices.size();
        EXPECT_EQ(corners, plain_corners) << others[i].name;
    }
    EXPECT_EQ(lit.scene.images.size(), plain.scene.images.size());
    EXPECT_EQ(lit.path.samples.size(), plain.path.samples.size());
    EXPECT_TRUE(lit.scene.warnings.empty());
}

TEST(TownLamps, ComeBackFromAGlb) {
    const test::TemporaryFolder folder;
    GeneratedScene lit = town(true, 0.1);
    Lamp aslant{.name = "aslant", .at = {1, 2, 3}, .towards = glm::normalize(dvec3(1, -2, 3)), .colour = {0.5F, 1, 0}};
    aslant.cos_inner = aslant.cos_outer = 0.5;
    lit.scene.lamps.push_back(aslant);
    aslant.name = "backwards";
    aslant.towards = dvec3(0, 0, 1);
    lit.scene.lamps.push_back(aslant);
    ASSERT_TRUE(write_scene(folder / "town.glb", lit).ok());
    const auto back = importer::import_files({folder / "town.glb"}, {});
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_TRUE(back->warnings.empty());
    EXPECT_EQ(back->triangles(), lit.scene.triangles());
    EXPECT_EQ(back->nodes.size(), lit.scene.nodes.size() + lit.scene.lamps.size());
    ASSERT_EQ(back->lamps.size(), lit.scene.lamps.size());
    for (std::size_t i = 0; i < back->lamps.size(); ++i) {
        const Lamp &a = back->lamps[i], &b = lit.scene.lamps[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.at, b.at);
        EXPECT_EQ(a.spot(), b.spot());
        EXPECT_LT(glm::length(a.towards - b.towards), 1e-12) << b.name;
        EXPECT_EQ(a.colour, b.colour);
        EXPECT_EQ(a.candela, b.candela);
        EXPECT_EQ(a.range_m, b.range_m);
        EXPECT_NEAR(a.cos_inner, b.cos_inner, 1e-12);
        EXPECT_NEAR(a.cos_outer, b.cos_outer, 1e-12);
    }
    const auto a = glowing(*back), b = glowing(lit.scene);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(glm::length(a[i].emission - b[i].emission), 1e-5F) << b[i].name;
}

TEST(TownLamps, AFormatWithoutLampsIsRefusedWithTheRemedy) {
    EXPECT_TRUE(check_ending("a.glb", true).ok());
    EXPECT_TRUE(check_ending("a.ostf", false).ok());
    const auto refused = check_ending("a.ostf", true);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().what.find("no lamps"), std::string::npos) << refused.error().text();
    EXPECT_NE(refused.error().remedy.find(".glb"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::scenes
