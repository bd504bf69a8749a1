// OBJ and MTL: indices of all forms, polygons, groups, colours, and errors with their line.
#include <gtest/gtest.h>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

Scene import_text(const std::string& text, const std::string& mtl = "") {
    const Folder folder;
    if (!mtl.empty()) folder.write("m.mtl", mtl);
    auto scene = import_files({folder.write("model.obj", text)}, {});
    EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().text());
    return scene.ok() ? std::move(*scene) : Scene{};
}

std::string error_of(const std::string& text) {
    const Folder folder;
    const auto scene = import_files({folder.write("model.obj", text)}, {});
    EXPECT_FALSE(scene.ok());
    return scene.ok() ? "" : scene.error().text();
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, PolygonsNegativeIndicesAndContinuedLines) {
    const Scene scene = import_text(square + "f 1 2 \\\n 3 4\r\nf -4 -3 -2\n");
    EXPECT_EQ(scene.triangles(), 3U);
    EXPECT_EQ(scene.meshes[0].primitives[0].positions.size(), 4U);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Obj, CornersWithEveryMixOfIndicesAndNormalsOnlyWhereGiven) {
    const Scene scene = import_text(square + "vt 0 0\nvt 1 0.25\nvn 0 0 2\nf 1/1/1 2/2/1 3//1\nf 1 3 4\n");
    const Primitive& p = scene.meshes[0].primitives[0];
    EXPECT_EQ(p.indices.size(), 6U);
    ASSERT_EQ(p.uvs.size(), p.positions.size());
    EXPECT_EQ(p.uvs[1], vec2(1, 0.75F));
    for (const vec3& n : p.normals) EXPECT_NEAR(n.z, 1.0F, 1e-6F);
}

TEST(Obj, ConcavePolygonKeepsItsArea) {
    // A C: its fan would cover the notch.
    const Scene scene =
        import_text("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 3 2 0\nv 3 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8\n");
    const Primitive& p = scene.meshes[0].primitives[0];
    double area = 0;
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const dvec3 a(p.positions[p.indices[i]]), b(p.positions[p.indices[i + 1]]), c(p.positions[p.indices[i + 2]]);
        const double z = glm::cross(b - a, c - a).z;
        EXPECT_GT(z, 0);
        area += 0.5 * z;
    }
    EXPECT_NEAR(area, 7.0, 1e-12);
}

TEST(Obj, ObjectsAndGroupsBecomeNodesAndMaterialsPrimitives) {
    const Scene scene = import_text("mtllib m.mtl\n" + square +
                                        "o house\ng wall\nusemtl brick\nf 1 2 3\ng roof\nusemtl tile\nf 1 3 4\nusemtl brick\nf 1 "
                                        "2 4\ng wall\nusemtl brick\nf 2 3 4\n",
                                    "newmtl brick\nKd 0.5 0.25 0.125\nnewmtl tile\nd 0.5\n");
    ASSERT_EQ(scene.nodes.size(), 2U);
    EXPECT_EQ(scene.nodes[0].name, "house/wall");
    EXPECT_EQ(scene.meshes[0].primitives.size(), 1U);
    EXPECT_EQ(scene.meshes[0].primitives[0].indices.size(), 6U);
    EXPECT_EQ(scene.nodes[1].name, "house/roof");
    EXPECT_EQ(scene.meshes[1].primitives.size(), 2U);
    const Material& brick = scene.materials[scene.meshes[0].primitives[0].material];
    EXPECT_EQ(brick.name, "brick");
    EXPECT_FLOAT_EQ(brick.colour[1], 0.25F);
    EXPECT_EQ(scene.materials[scene.meshes[1].primitives[0].material].alpha, model::AlphaMode::blend);
}

TEST(Obj, ObjectsOfOneNameStayApart) {
    const Scene scene = import_text(square + "o chair\nf 1 2 3\no chair\nf 1 3 4\ng a\nf 1 2 4\ng b\nf 2 3 4\ng a\nf 1 2 3\n");
    ASSERT_EQ(scene.nodes.size(), 4U);
    EXPECT_EQ(scene.nodes[1].name, "chair");
    EXPECT_EQ(scene.meshes[2].primitives[0].indices.size(), 6U);
}

TEST(Obj, AnyByteChangedNeverCrashes) {
    const Folder folder;
    const std::string whole = "mtllib m.mtl\n" + square + "vt 0 1\nvn 0 0 1\no a\nusemtl b\nf 1/1/1 2/1/1 3/1/1 -1/-1/-1\n";
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const char bits : {'\x01', '\x08', '\x20', '\xff'}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ bits);
            const auto scene = import_files({folder.write("changed.obj", changed)}, {});
            if (!scene.ok()) {
                EXPECT_FALSE(scene.error().what.empty());
            }
        }
    }
}

TEST(Obj, TextureWithHolesIsMaskedAndMissingOnesAreWhite) {
    const Folder folder;
    const std::vector<std::uint8_t> holes{255, 0, 0, 255, 0, 0, 0, 0};
    ASSERT_TRUE(image::write_png(folder.file("leaf one.png"), 2, 1, holes).ok());
    folder.write("m.mtl", "newmtl leaf\nmap_Kd -s 1 1 1 -clamp on leaf one.png\nnewmtl gone\nmap_Kd no.png\n");
    const auto scene =
        import_files({folder.write("a.obj", "mtllib m.mtl\n" + square + "usemtl leaf\nf 1 2 3\nusemtl gone\nf 1 3 4\n")}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    ASSERT_EQ(scene->images.size(), 1U);
    EXPECT_TRUE(scene->images[0].clamp);
    EXPECT_EQ(scene->materials[0].alpha, model::AlphaMode::mask);
    EXPECT_EQ(scene->materials[1].image, none);
    EXPECT_TRUE(warns(*scene, "Texture 'no.png' is left white"));
    EXPECT_TRUE(lacks(*scene, "Texture 'no.png' is left white"));
}

TEST(Obj, WhatGlows) {
    const Folder folder;
    folder.write("m.mtl",
                 "newmtl lamp\nKe 4 2 1\nnewmtl grey\nKe 0.5\nnewmtl odd\nKe 1 -1 nan\nnewmtl sign\nKe 1 1 1\nmap_Ke no.png\n");
    const auto scene = import_files({folder.write("a.obj", "mtllib m.mtl\n" + square + "usemtl lamp\nf 1 2 3\n")}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    ASSERT_GE(scene->materials.size(), 4U);
    EXPECT_EQ(scene->materials[0].emission, vec3(4, 2, 1));
    EXPECT_EQ(scene->materials[1].emission, vec3(0.5F));
    EXPECT_EQ(scene->materials[2].emission, vec3(1, 0, 0));
    EXPECT_EQ(scene->materials[3].emission, vec3(0));
    EXPECT_TRUE(scene->materials[3].emission_image);
    EXPECT_TRUE(warns(*scene, "Material 'odd': its emission Ke"));
    EXPECT_TRUE(warns(*scene, "Material 'sign': its glow is left out"));
    EXPECT_EQ(scene->warnings.size(), 2U);
}

TEST(Obj, VertexColoursAndNaNColours) {
    const Scene scene = import_text("v 0 0 0 1 0 0.5\nv 1 0 0 nan nan nan\nv 0 1 0\nf 1 2 3\n");
    const auto& colours = scene.meshes[0].primitives[0].colours;
    ASSERT_EQ(colours.size(), 3U);
    EXPECT_EQ(colours[0], (std::array<std::uint8_t, 4>{255, 0, 128, 255}));
    EXPECT_EQ(colours[1], (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
    EXPECT_EQ(colours[2], (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
}

TEST(Obj, MapCoordinatesKeepTheirMillimetres) {
    const Scene scene = import_text("v 3500000.001 5800000 40\nv 3500000.501 5800000 40\nv 3500000.001 5800000.25 40\nf 1 2 3\n");
    const Primitive& p = scene.meshes[0].primitives[0];
    const dvec3 a(scene.nodes[0].world * dvec4(p.positions[0], 1)), b(scene.nodes[0].world * dvec4(p.positions[1], 1));
    EXPECT_NEAR(b.x - a.x, 0.5, 1e-6);
    EXPECT_NEAR(a.x, 3500000.001, 1e-4);
}

TEST(Obj, BadNumbersAreErrorsWithTheirLine) {
    EXPECT_NE(error_of("v 0 0 0\nv 1 bleh 0\n").find("model.obj:2: The word 'bleh' is not a number"), std::string::npos);
    EXPECT_NE(error_of("v 0 0\n").find(":1: A position has only 2 numbers"), std::string::npos);
    EXPECT_NE(error_of(square + "f 1 2 3/1/1/1\n").find(":5:"), std::string::npos);
}

TEST(Obj, FacesOutOfRangeAreDroppedWithTheFirstLine) {
    const Scene scene = import_text(square + "f 1 2 3\nf 1 2 9\nf 0 1 2\nf 1 2\nl 1 2\n");
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "3 faces are dropped"));
    EXPECT_TRUE(lacks(scene, "2 faces are dropped: index out of range")) << "an edge of two corners is none of them";
    EXPECT_TRUE(import_text(square + "f 1 2 3\nf 1 2\nusemtl any\nf 1 3 4\n").damage.empty()) << "no library was named";
    EXPECT_TRUE(lacks(import_text(square + "vt 0 0\nf 1/1 2/1 3/2\n"), "texture coordinate or normal that does not exist"));
    EXPECT_TRUE(warns(scene, "first in line 6"));
    EXPECT_TRUE(warns(scene, "1 point or line is dropped"));
}

TEST(Obj, NothingDrawableIsAnError) {
    EXPECT_NE(error_of("# only words\n").find("nothing drawable"), std::string::npos);
    EXPECT_NE(error_of(square + "f 1 1 2\n").find("repeated index"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::importer::test
