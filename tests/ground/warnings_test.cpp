// What the bake says of scenes on which nobody can walk, and what a scene's author may rule.
#include <gtest/gtest.h>

#include "render/bake/ground.hpp"
#include "render/import/scene.hpp"

namespace surefoot::bake {

namespace {

/// A square, `size` metres wide, level or upright.
importer::Scene square(float size, bool upright = false) {
    importer::Scene scene;
    scene.materials.emplace_back();
    importer::Primitive p;
    for (const vec2 c : {vec2(0, 0), vec2(0, size), vec2(size, size), vec2(size, 0)})
        p.positions.push_back(upright ? vec3(c.x, c.y, 0) : vec3(c.x, 0, c.y));
    p.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back({"square", {p}, {}});
    importer::Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    return scene;
}

std::vector<std::string> warnings_of(const importer::Scene& scene) {
    Box box;
    for (const vec3& p : scene.meshes[0].primitives[0].positions) box.grow(dvec3(p));
    return ground_warnings(make_ground(scene, {}), box);
}

}  // namespace

TEST(GroundWarnings, SayWhatIsGuessed) {
    EXPECT_TRUE(warnings_of(square(10)).empty());
    ASSERT_EQ(warnings_of(square(0.5F)).size(), 1U);
    EXPECT_NE(warnings_of(square(0.5F))[0].find("0.5 m wide"), std::string::npos);
    EXPECT_NE(warnings_of(square(1e6F))[0].find("1e+03 km wide"), std::string::npos);
    EXPECT_NE(warnings_of(square(0.001F))[0].find("nothing blocks"), std::string::npos) << "smaller than a foot";
    ASSERT_EQ(warnings_of(square(10, true)).size(), 1U) << "a wall, and no floor";
    EXPECT_NE(warnings_of(square(10, true))[0].find("nothing level enough"), std::string::npos);
    importer::Scene inside_out = square(10);
    std::swap(inside_out.meshes[0].primitives[0].indices[1], inside_out.meshes[0].primitives[0].indices[2]);
    std::swap(inside_out.meshes[0].primitives[0].indices[4], inside_out.meshes[0].primitives[0].indices[5]);
    EXPECT_TRUE(warnings_of(inside_out).empty()) << "a floor holds from both sides";
}

TEST(GroundWarnings, AFloorIsFoundWhateverItsSize) {
    for (const float size : {0.31F, 1.0F, 1000.0F, 1e6F}) {
        const model::Ground ground = make_ground(square(size), {});
        EXPECT_EQ(ground.triangles, 2U) << size;
        EXPECT_TRUE(model::validate(ground).ok()) << size;
    }
}

TEST(GroundRules, OfTheAuthorOverruleTheBakes) {
    importer::Scene scene = square(10);
    scene.nodes[0].walk = importer::WalkRule::pass;
    EXPECT_EQ(make_ground(scene, {}).triangles, 0U);
    scene = square(0.1F);
    scene.nodes[0].walk = importer::WalkRule::block;
    EXPECT_EQ(make_ground(scene, {}).triangles, 2U);
    scene = square(10);
    scene.materials[0].alpha = model::AlphaMode::blend;
    scene.materials[0].colour[3] = 0.5F;
    EXPECT_EQ(make_ground(scene, {}).triangles, 0U) << "water";
    scene.nodes[0].walk = importer::WalkRule::block;
    EXPECT_EQ(make_ground(scene, {}).triangles, 2U);
}

}  // namespace surefoot::bake
