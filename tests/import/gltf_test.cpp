// glTF: hierarchy, instances, attributes of every kind, materials, and the traps of each.
#include <gtest/gtest.h>

#include "render/image/image.hpp"
#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

std::string error_of(const TriangleGltf& gltf) {
    auto scene = import_bytes(gltf.file());
    EXPECT_FALSE(scene.ok());
    return scene.ok() ? "" : scene.error().text();
}

dvec3 world_of(const Scene& scene, std::size_t node, const dvec3& p) { return dvec3(scene.nodes[node].world * dvec4(p, 1)); }

TEST(Gltf, SmallestTriangle) {
    const Scene scene = import_good({});
    EXPECT_EQ(scene.triangles(), 1U);
    ASSERT_EQ(scene.nodes.size(), 1U);
    EXPECT_EQ(scene.nodes[0].name, "thing");
    EXPECT_EQ(scene.meshes[0].name, "mesh");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.materials.size(), 1U);
}

TEST(Gltf, HierarchyMultipliesInDoubleAndInstancesShareTheirMesh) {
    TriangleGltf gltf;
    gltf.nodes =
        R"([{"name":"root","translation":[6400000.25,0,0],"children":[1,2]},{"mesh":0,"translation":[0,0,0.125],"scale":[2,2,2]},
                    {"mesh":0,"rotation":[0,0.7071067811865476,0,0.7071067811865476],"extras":{"importance":0.5}}])";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 2U);
    EXPECT_EQ(scene.meshes.size(), 1U);
    ASSERT_EQ(scene.nodes.size(), 3U);
    EXPECT_EQ(scene.nodes[1].parent, 0U);
    EXPECT_EQ(world_of(scene, 1, {1, 0, 0}), dvec3(6400002.25, 0, 0.125));
    EXPECT_NEAR(world_of(scene, 2, {1, 0, 0}).z, -1.0, 1e-12);
    EXPECT_FLOAT_EQ(scene.nodes[2].importance, 0.5F);
}

TEST(Gltf, WhetherAWalkerIsStoppedIsHandedDown) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"name":"hedge","extras":{"walk":"pass"},"children":[1,2,3]},{"mesh":0},{"mesh":0,"extras":{"walk":"block"}},
                     {"mesh":0,"name":"odd","extras":{"walk":"maybe"}}])";
    const Scene scene = import_good(gltf);
    ASSERT_EQ(scene.nodes.size(), 4U);
    EXPECT_EQ(scene.nodes[1].walk, WalkRule::pass);
    EXPECT_EQ(scene.nodes[2].walk, WalkRule::block);
    EXPECT_EQ(scene.nodes[3].walk, WalkRule::pass) << "what is neither word is ignored";
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_NE(scene.warnings[0].find("odd"), std::string::npos);
}

TEST(Gltf, MatrixIsColumnMajor) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1]}])";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(world_of(scene, 0, {1, 0, 0}), dvec3(5, 7, 7));
}

TEST(Gltf, CycleIsRefusedByName) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"name":"hall","children":[1]},{"name":"stair","children":[0]}])";
    EXPECT_NE(error_of(gltf).find("Node 'hall' is its own ancestor"), std::string::npos);
    gltf.scenes = "[]";  // no scene names a root: a cycle has none
    EXPECT_NE(error_of(gltf).find("ancestor"), std::string::npos);
}

TEST(Gltf, SecondParentIsDroppedWithAWarning) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"children":[2]},{"children":[2]},{"mesh":0,"name":"shared"}])";
    gltf.scenes = R"([{"nodes":[0,1]}])";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "Node 'shared' has more than one parent"));
}

TEST(Gltf, DeepChainDoesNotRunOutOfStack) {
    TriangleGltf gltf;
    gltf.nodes = "[";
    constexpr int deep = 50000;
    for (int i = 0; i < deep; ++i) gltf.nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
    gltf.nodes += R"({"mesh":0}])";
    EXPECT_EQ(import_good(gltf).nodes.size(), static_cast<std::size_t>(deep) + 1);
}

TEST(Gltf, DeepExtrasDoNotRunOutOfStack) {
    TriangleGltf gltf;
    gltf.more = R"(,"extras":)" + std::string(200000, '[') + std::string(200000, ']');
    EXPECT_NE(error_of(gltf).find("nested deeper"), std::string::npos);
}

TEST(Gltf, SingularTransformTakesTheMeshOffItsNode) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"name":"flat","scale":[0,0,0]},{"mesh":0}])";
    gltf.scenes = R"([{"nodes":[0,1]}])";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "Node 'flat' is dropped: its transform is singular"));
}

TEST(Gltf, MirroredNodeStaysMirrored) {
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
    EXPECT_LT(glm::determinant(dmat3(import_good(gltf).nodes[0].world)), 0.0);
}

TEST(Gltf, StripsTurnEveryOtherTriangleAndFansKeepTheirHub) {
    TriangleGltf gltf;
    gltf.attributes = R"("POSITION":2)";
    gltf.accessors = R"(,{"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"})";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":48})";
    put(gltf.bytes, std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    gltf.primitive = R"(,"mode":5)";
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}));
    gltf.primitive = R"(,"mode":6)";
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST(Gltf, PointsAndLinesAreDroppedWithAWarning) {
    TriangleGltf gltf;
    gltf.primitive = R"(,"indices":1},{"mode":1,"attributes":{"POSITION":0}},{"mode":0,"attributes":{"POSITION":0})";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "2 primitives of points or lines are dropped"));
    EXPECT_TRUE(scene.damage.empty()) << "useless, not broken";
}

TEST(Gltf, WhatIsBrokenOfThingsThatAreDrawnIsDamage) {
    TriangleGltf gltf;
    gltf.primitive = R"(,"indices":1},{"attributes":{"POSITION":9})";
    EXPECT_TRUE(lacks(import_good(gltf), "A primitive is dropped"));
    gltf.primitive = R"(,"indices":1)";
    gltf.nodes = R"([{"mesh":0,"children":[1]},{"mesh":7}])";
    EXPECT_TRUE(lacks(import_good(gltf), "names mesh 7, which does not exist"));
    gltf.nodes = R"([{"mesh":0,"children":[9]}])";
    EXPECT_TRUE(lacks(import_good(gltf), "Child 9 of"));
}

TEST(Gltf, AccessorsThatReachOutsideAreRefused) {
    const auto with_positions = [](const std::string& accessor, const std::string& view) {
        TriangleGltf gltf;
        gltf.attributes = R"("POSITION":2)";
        gltf.accessors = "," + accessor;
        gltf.views = "," + view;
        return error_of(gltf);
    };
    const std::string view = R"({"buffer":0,"byteLength":36})",
                      good = R"({"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"})";
    EXPECT_NE(
        with_positions(R"({"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"})", view).find("reach beyond buffer view"),
        std::string::npos);
    EXPECT_NE(with_positions(R"({"bufferView":2,"byteOffset":4,"componentType":5126,"count":3,"type":"VEC3"})", view)
                  .find("reach beyond buffer view"),
              std::string::npos);
    EXPECT_NE(with_positions(R"({"bufferView":2,"componentType":5126,"count":4611686018427387904,"type":"VEC3"})", view)
                  .find("reach beyond buffer view"),
              std::string::npos);
    EXPECT_NE(with_positions(good, R"({"buffer":0,"byteOffset":40,"byteLength":36})").find("beyond its buffer"),
              std::string::npos);
    EXPECT_NE(with_positions(good, R"({"buffer":0,"byteOffset":18446744073709551612,"byteLength":36})").find("beyond its buffer"),
              std::string::npos);
    EXPECT_NE(with_positions(good, R"({"buffer":7,"byteLength":36})").find("names a buffer that does not exist"),
              std::string::npos);
    EXPECT_NE(with_positions(good, R"({"buffer":0,"byteLength":36,"byteStride":8})").find("stride of 8"), std::string::npos);
    EXPECT_NE(with_positions(R"({"bufferView":9,"componentType":5126,"count":3,"type":"VEC3"})", view)
                  .find("names a buffer view that does not exist"),
              std::string::npos);
    EXPECT_NE(with_positions(R"({"componentType":5126,"count":4000000000,"type":"VEC3"})", view).find("elements without data"),
              std::string::npos);
    EXPECT_NE(
        with_positions(R"({"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"})", R"({"buffer":0,"byteLength":44})")
            .find("reach"),
        std::string::npos);
}

TEST(Gltf, StrideIsObeyed) {
    TriangleGltf gltf;
    gltf.attributes = R"("POSITION":2)";
    gltf.accessors = R"(,{"bufferView":2,"byteOffset":4,"componentType":5126,"count":3,"type":"VEC3"})";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":48,"byteStride":16})";
    put(gltf.bytes, std::vector<float>{9, 0, 0, 0, 9, 2, 0, 0, 9, 0, 3, 0});
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.meshes[0].primitives[0].positions[1], vec3(2, 0, 0));
    EXPECT_EQ(scene.meshes[0].primitives[0].positions[2], vec3(0, 3, 0));
}

TEST(Gltf, SparseValuesReplaceAndBadSparseIndicesAreRefused) {
    TriangleGltf gltf;
    gltf.attributes = R"("POSITION":2)";
    gltf.accessors =
        R"(,{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}})";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":2},{"buffer":0,"byteOffset":48,"byteLength":12})";
    put(gltf.bytes, std::vector<std::uint16_t>{1, 0});
    put(gltf.bytes, std::vector<float>{7, 0, 0});
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].positions[1], vec3(7, 0, 0));
    gltf.bytes[0] = 3;
    EXPECT_NE(error_of(gltf).find("sparse index 3 of 3"), std::string::npos);
    gltf.bytes.resize(12);
    EXPECT_FALSE(import_bytes(gltf.file()).ok());
}

TEST(Gltf, OutOfRangeIndicesAndNaNPositionsAreDroppedWithCounts) {
    TriangleGltf gltf;
    gltf.indices = {0, 1, 9};
    EXPECT_NE(error_of(gltf).find("1 triangles are dropped: index out of range"), std::string::npos);
    gltf.indices = {0, 1, 2};
    gltf.positions[4] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error_of(gltf).find("position not finite"), std::string::npos);
}

TEST(Gltf, ColoursOfEveryTypeBecomeEncodedBytes) {
    TriangleGltf gltf;
    gltf.attributes = R"("POSITION":0,"COLOR_0":2)";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":48})";
    put(gltf.bytes, std::vector<float>{0.5F, 0, 1, 0.25F, 0.5F, 0, 1, 0.25F, 0.5F, 0, 1, 0.25F});
    gltf.accessors = R"(,{"bufferView":2,"componentType":5126,"count":3,"type":"VEC4"})";
    const std::array<std::uint8_t, 4> half{188, 0, 255, 64};  // 0.5 of light is 188 of 255 in sRGB
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].colours[1], half);
    gltf.bytes.clear();
    put(gltf.bytes, std::vector<std::uint16_t>(24, 32768));
    gltf.accessors = R"(,{"bufferView":2,"componentType":5123,"normalized":true,"count":3,"type":"VEC3"})";
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].colours[2], (std::array<std::uint8_t, 4>{188, 188, 188, 255}));
    gltf.bytes.assign(48, '\x80');
    gltf.accessors = R"(,{"bufferView":2,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"})";
    EXPECT_EQ(import_good(gltf).meshes[0].primitives[0].colours[0], (std::array<std::uint8_t, 4>{188, 188, 188, 128}));
}

TEST(Gltf, MaterialsAreRead) {
    TriangleGltf gltf;
    gltf.primitive = R"(,"indices":1,"material":0)";
    gltf.more =
        R"(,"materials":[{"name":"leaf","alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.5,0,1,0.5]},
                    "extensions":{"KHR_materials_unlit":{}}},{"alphaMode":"BLEND"}],"extensionsUsed":["KHR_materials_unlit"])";
    const Scene scene = import_good(gltf);
    ASSERT_EQ(scene.materials.size(), 3U);  // and the default
    const Material& leaf = scene.materials[0];
    EXPECT_EQ(leaf.name, "leaf");
    EXPECT_EQ(leaf.alpha, model::AlphaMode::mask);
    EXPECT_FLOAT_EQ(leaf.alpha_cutoff, 0.25F);
    EXPECT_TRUE(leaf.two_sided);
    EXPECT_TRUE(leaf.unlit);
    EXPECT_NEAR(leaf.colour[0], image::encode_srgb(0.5F), 1e-6F);
    EXPECT_FLOAT_EQ(leaf.colour[3], 0.5F);
    EXPECT_EQ(scene.materials[1].alpha, model::AlphaMode::blend);
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 0U);
}

TEST(Gltf, MaterialThatDoesNotExistIsTheDefault) {
    TriangleGltf gltf;
    gltf.primitive = R"(,"indices":1,"material":5)";
    EXPECT_EQ(import_good(gltf).materials[0].name, "default");
}

TEST(Gltf, TextureFromBufferViewWithTransformAndClamp) {
    TriangleGltf gltf;
    const std::vector<std::uint8_t> red{255, 0, 0, 255};
    const auto png = image::encode_png(1, 1, red);
    gltf.attributes = R"("POSITION":0,"TEXCOORD_1":2)";
    gltf.primitive = R"(,"indices":1,"material":0)";
    gltf.accessors = R"(,{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"})";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":24},{"buffer":0,"byteOffset":68,"byteLength":)" +
                 std::to_string(png.size()) + "}";
    put(gltf.bytes, std::vector<float>{0, 0, 1, 0, 0, 1});
    put(gltf.bytes, png);
    gltf.more =
        R"(,"images":[{"bufferView":3,"mimeType":"image/png","name":"red"}],"samplers":[{"wrapS":33071,"wrapT":33071}],"textures":[{"source":0,"sampler":0}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,3]}}}}}])";
    const Scene scene = import_good(gltf);
    ASSERT_EQ(scene.images.size(), 1U);
    EXPECT_EQ(scene.images[0].rgba, red);
    EXPECT_TRUE(scene.images[0].clamp);
    const auto& uvs = scene.meshes[0].primitives[0].uvs;
    ASSERT_EQ(uvs.size(), 3U);
    EXPECT_EQ(uvs[1], vec2(2.5F, 0.25F));
    EXPECT_EQ(uvs[2], vec2(0.5F, 3.25F));
}

TEST(Gltf, MissingAndBadTexturesAreWhiteWithAWarning) {
    TriangleGltf gltf;
    gltf.primitive = R"(,"indices":1,"material":0)";
    gltf.more =
        R"(,"images":[{"uri":"not%20there.png"}],"textures":[{"source":0}],"materials":[{"name":"wall","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.materials[0].image, none);
    EXPECT_TRUE(warns(scene, "Texture 'not there.png' is left white"));
    EXPECT_TRUE(lacks(scene, "Texture 'not there.png' is left white"));
    gltf.more =
        R"(,"images":[{"uri":"data:image/png;base64,AAAA"}],"textures":[{"source":0}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    EXPECT_TRUE(warns(import_good(gltf), "neither PNG nor JPEG"));
    EXPECT_TRUE(lacks(import_good(gltf), "neither PNG nor JPEG"));
    gltf.primitive = R"(,"indices":1)";
    EXPECT_TRUE(import_good(gltf).damage.empty()) << "nothing that is drawn uses the material";
    gltf.primitive = R"(,"indices":1,"material":7)";
    EXPECT_TRUE(lacks(import_good(gltf), "Material 7 does not exist"));
    gltf.primitive = R"(,"indices":1,"material":0)";
    gltf.more =
        R"(,"textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    EXPECT_TRUE(lacks(import_good(gltf), "only a WebP picture, which is not read; convert it"));
    gltf.more = R"(,"materials":[{"name":"wall","pbrMetallicRoughness":{"baseColorTexture":{"index":4}}}])";
    EXPECT_TRUE(warns(import_good(gltf), "texture 4 does not exist"));
}

TEST(Gltf, ImageViewOutsideItsBufferIsRefused) {
    TriangleGltf gltf;
    gltf.views = R"(,{"buffer":0,"byteOffset":4000000000,"byteLength":4})";
    gltf.more = R"(,"images":[{"bufferView":2,"mimeType":"image/png"}])";
    EXPECT_NE(error_of(gltf).find("outside its buffer"), std::string::npos);
}

TEST(Gltf, GpuInstancesBecomeNodes) {
    TriangleGltf gltf;
    gltf.nodes =
        R"([{"mesh":0,"name":"tree","translation":[10,0,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}])";
    gltf.accessors = R"(,{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"})";
    gltf.views = R"(,{"buffer":0,"byteOffset":44,"byteLength":24})";
    put(gltf.bytes, std::vector<float>{1, 0, 0, 2, 0, 0});
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 2U);
    ASSERT_EQ(scene.nodes.size(), 3U);
    EXPECT_EQ(scene.nodes[2].name, "tree #1");
    EXPECT_EQ(world_of(scene, 2, {0, 0, 0}), dvec3(12, 0, 0));
}

TEST(Gltf, CompressedFilesAreRefusedWithTheRemedy) {
    TriangleGltf gltf;
    gltf.more = R"(,"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"])";
    EXPECT_NE(error_of(gltf).find("Decompress"), std::string::npos);
}

TEST(Gltf, WithoutNodesEachMeshIsPlacedOnce) {
    TriangleGltf gltf;
    gltf.nodes = "[]";
    gltf.scenes = "[]";
    const Scene scene = import_good(gltf);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "no nodes"));
}

TEST(Gltf, ExternalBuffersAreFoundBesideTheFileAndMayBeLonger) {
    const Folder folder;
    TriangleGltf gltf;
    std::string json = gltf.json();
    json.replace(json.find(R"("buffers":[{)"), 12, R"("buffers":[{"uri":"the%20data.bin",)");
    folder.write("the data.bin", gltf.bin() + "padding");
    auto scene = import_files({folder.write("model.gltf", json)}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->triangles(), 1U);
    folder.write("the data.bin", gltf.bin().substr(0, 20));
    scene = import_files({folder.file("model.gltf")}, {});
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().text().find("the data.bin"), std::string::npos);
    std::filesystem::remove(folder.file("the data.bin"));
    scene = import_files({folder.file("model.gltf")}, {});
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().text().find("the data.bin"), std::string::npos);
}

TEST(Gltf, EveryTruncationIsAnErrorAndNoCrash) {
    const Folder folder;
    TriangleGltf gltf;
    put(gltf.bytes, std::vector<std::uint8_t>(16, 1));
    const std::string whole = gltf.file();
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const auto scene = import_files({folder.write("cut.glb", whole.substr(0, length))}, {});
        EXPECT_FALSE(scene.ok()) << length;
    }
}

TEST(Gltf, AnyByteChangedNeverCrashes) {
    const Folder folder;
    const std::string whole = TriangleGltf{}.file();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const char bits : {'\x01', '\x20', '\xff'}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ bits);
            const auto scene = import_files({folder.write("changed.glb", changed)}, {});
            if (!scene.ok()) {
                EXPECT_FALSE(scene.error().what.empty());
            }
        }
    }
}

TEST(Gltf, SecondChunkHeaderBeyondTheEndIsRefused) {
    std::string bytes = TriangleGltf{}.file();
    bytes.resize(bytes.size() - 8);  // the chunk now lies 8 bytes too far: tinygltf 2.7 alone reads on
    const std::string length = word(static_cast<std::uint32_t>(bytes.size()));
    bytes.replace(8, 4, length);
    const auto scene = import_bytes(bytes);
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().what.find("reaches beyond the end"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::importer::test
