// What importers say of pictures: masks that hide all, and textures that fill memory.
#include <gtest/gtest.h>

#include "render/import/finish.hpp"

namespace surefoot::importer {
namespace {

/// A triangle with a masked picture of 2 x 1 texels of these alphas.
std::vector<std::string> warnings_of_mask(std::uint8_t left, std::uint8_t right, float factor = 1) {
    Scene scene;
    image::Image image;
    image.width = 2, image.height = 1;
    image.rgba = {9, 9, 9, left, 9, 9, 9, right};
    scene.images.push_back(image);
    Material material;
    material.name = "leaf";
    material.image = 0;
    material.alpha = model::AlphaMode::mask;
    material.colour[3] = factor;
    scene.materials.push_back(material);
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.uvs = {{0, 0}, {1, 0}, {0, 1}};
    p.indices = {0, 1, 2};
    scene.meshes.push_back({"card", {p}, {}});
    Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    EXPECT_TRUE(finish(scene, "a.glb", {}).ok());
    EXPECT_EQ(scene.triangles(), 1U) << "the object is kept";
    return scene.warnings;
}

TEST(ImageWarnings, NameAMaskThatHidesAll) {
    const auto warnings = warnings_of_mask(0, 127);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0], "Material 'leaf': its mask hides all that wears it; is its alpha inverted?");
    EXPECT_EQ(warnings_of_mask(255, 255, 0.4F).size(), 1U) << "by the material's factor";
    EXPECT_TRUE(warnings_of_mask(0, 128).empty());
    EXPECT_TRUE(warnings_of_mask(255, 0).empty());
}

TEST(ImageWarnings, NameTexturesOfManyMebibytes) {
    Scene scene;
    image::Image image;
    image.name = "map.png";
    image.width = 16384, image.height = 8192;  // its texels are not looked at
    scene.images.push_back(image);
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.indices = {0, 1, 2};
    scene.meshes.push_back({"card", {p}, {}});
    Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    ASSERT_TRUE(finish(scene, "a.glb", {}).ok());
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_EQ(scene.warnings[0], "Texture 'map.png' of 16384 x 8192 texels takes 683 MiB; is it needed so large?");
}

}  // namespace
}  // namespace surefoot::importer
