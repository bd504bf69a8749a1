// Stand-ins of artists: MSFT_lod, names in extras, the list beside a scene, and what is wrong with each.
#include "render/import/stand_ins.hpp"

#include <gtest/gtest.h>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

Scene imported(const Folder& folder, const TriangleGltf& gltf) {
    auto scene = import_files({folder.write("model.glb", gltf.file())}, {});
    EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().text());
    return scene.ok() ? std::move(*scene) : Scene{};
}

Scene imported(const std::string& nodes, const std::string& roots = "[0]") {
    const Folder folder;
    TriangleGltf gltf;
    gltf.nodes = nodes;
    gltf.scenes = R"([{"nodes":)" + roots + "}]";
    return imported(folder, gltf);
}

/// A scene of two drawn nodes, oak and far, and a list beside it.
Result<Scene> imported_with_list(const std::string& list, const std::string& other_file = {}) {
    const Folder folder;
    TriangleGltf gltf;
    gltf.nodes = R"([{"mesh":0,"name":"oak","translation":[5,0,0]},{"name":"far","translation":[9,9,9],"children":[2]},
                     {"mesh":0,"name":"crown","translation":[0,2,0]}])";
    gltf.scenes = R"([{"nodes":[0,1]}])";
    const std::string file = folder.write("model.glb", gltf.file());
    folder.write("model.stand_ins.toml", list);
    if (!other_file.empty()) folder.write("oak_far.glb", other_file);
    return import_files({file}, {});
}

vec3 corner(const StandIn& stand_in, std::size_t primitive = 0) { return stand_in.mesh.primitives.at(primitive).positions.at(0); }

TEST(StandIns, OfMsftLodAreReadWithWhatIsBelowThemAndAreNotDrawn) {
    // The stand-in's place is given by the object's parent, as the extension has it.
    const Scene scene = imported(
        R"([{"mesh":0,"name":"oak","translation":[5,0,0],"extensions":{"MSFT_lod":{"ids":[1]}}},
            {"name":"far","translation":[6,0,0],"children":[2]},{"mesh":0,"translation":[0,2,0]}])");
    ASSERT_EQ(scene.stand_ins.size(), 1U);
    EXPECT_EQ(scene.stand_ins[0].name, "far");
    EXPECT_EQ(scene.stand_ins[0].of, 0U);
    EXPECT_EQ(corner(scene.stand_ins[0]), vec3(1, 2, 0));
    EXPECT_EQ(scene.nodes.size(), 1U);
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(StandIns, OfMsftLodInTheSceneAreNotDrawnEither) {
    const Scene scene =
        imported(R"([{"mesh":0,"extensions":{"MSFT_lod":{"ids":[1,2]}}},{"mesh":0,"name":"nearer"},{"mesh":0,"name":"farther"}])",
                 "[0,1,2]");
    EXPECT_EQ(scene.triangles(), 1U);
    ASSERT_EQ(scene.stand_ins.size(), 2U);
    EXPECT_EQ(scene.stand_ins[1].name, "farther");
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(StandIns, OfExtrasAreLaidOnTheObjectsFrame) {
    for (const char* names : {R"("far")", R"(["far"])"}) {
        const Scene scene = imported(std::string(R"([{"mesh":0,"name":"oak","translation":[5,0,0],"extras":{"stand_ins":)") +
                                         names + R"(}},{"mesh":0,"name":"far","translation":[100,0,0]}])",
                                     "[0,1]");
        ASSERT_EQ(scene.stand_ins.size(), 1U);
        EXPECT_EQ(corner(scene.stand_ins[0]), vec3(0, 0, 0));
        EXPECT_EQ(scene.triangles(), 1U);
    }
}

TEST(StandIns, ThatAreMissingAreNamedAndTheObjectIsDrawn) {
    const Scene scene = imported(
        R"([{"mesh":0,"name":"oak","extras":{"stand_ins":["nowhere"]},"extensions":{"MSFT_lod":{"ids":[7,"x",0,1]}}},{"name":"empty"}])");
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(scene.stand_ins.empty());
    EXPECT_TRUE(warns(scene, "Stand-in 'nowhere' of 'oak' is left out: there is no such node"));
    EXPECT_TRUE(warns(scene, "Stand-in 'node 7' of 'oak' is left out: there is no such node"));
    EXPECT_TRUE(warns(scene, "Stand-in 'node 0' of 'oak' is left out: the object is a part of it"));
    EXPECT_TRUE(warns(scene, "Stand-in 'empty' of 'oak' is left out: it has no mesh"));
    EXPECT_TRUE(scene.damage.empty());
}

TEST(StandIns, WithAnObjectBelowThemAreLeftOut) {
    const Scene scene = imported(R"([{"name":"all","children":[1]},{"mesh":0,"name":"oak","extras":{"stand_ins":"all"}}])");
    EXPECT_EQ(scene.triangles(), 1U);
    EXPECT_TRUE(warns(scene, "the object is a part of it"));
}

TEST(StandIns, AreOnePerMeshWhateverNumberOfNodesNamesThem) {
    const Scene scene = imported(
        R"([{"mesh":0,"name":"oak","extensions":{"MSFT_lod":{"ids":[2]}}},{"mesh":0,"name":"oak.001","extensions":{"MSFT_lod":{"ids":[3]}}},
            {"mesh":0,"name":"far"},{"mesh":0,"name":"far.001"}])",
        "[0,1,2,3]");
    EXPECT_EQ(scene.triangles(), 2U);
    EXPECT_EQ(scene.stand_ins.size(), 1U);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(StandIns, InChainsAndCirclesHideNoObject) {
    const Scene circle = imported(
        R"([{"mesh":0,"name":"a","extras":{"stand_ins":"b"}},{"mesh":0,"name":"b","extras":{"stand_ins":"a"}}])", "[0,1]");
    EXPECT_EQ(circle.triangles(), 1U);
    EXPECT_EQ(circle.stand_ins.size(), 1U);
    EXPECT_TRUE(warns(circle, "Stand-in 'a' of 'b' is left out: its object is a stand-in itself"));
    const Scene chain = imported(
        R"([{"mesh":0,"name":"b","extras":{"stand_ins":"c"}},{"mesh":0,"name":"a","extras":{"stand_ins":"b"}},{"mesh":0,"name":"c"}])",
        "[0,1,2]");
    EXPECT_EQ(chain.triangles(), 2U);
    EXPECT_TRUE(warns(chain, "Stand-in 'b' of 'a' is left out: it has a stand-in of its own"));
}

TEST(StandIns, WithNonsenseForANameAreNamed) {
    for (const char* value : {R"([3])", R"("")", R"({"a":1})", "7"})
        EXPECT_TRUE(
            warns(imported(std::string(R"([{"mesh":0,"name":"oak","extras":{"stand_ins":)") + value + R"(}},{"mesh":0}])"),
                  "Stand-in 'extras.stand_ins' of 'oak' is left out: it is no name"))
            << value;
    EXPECT_TRUE(warns(imported(R"([{"mesh":0,"name":"oak","extensions":{"MSFT_lod":{"ids":3}}}])"), "it has no list of ids"));
}

// A cycle, or a mesh that does not exist, below a stand-in.
TEST(StandIns, ThatAreBrokenDoNotRefuseTheScene) {
    for (const char* nodes :
         {R"([{"mesh":0,"name":"oak","extras":{"stand_ins":"far"}},{"name":"far","children":[2]},{"mesh":0,"children":[1]}])",
          R"([{"mesh":0,"name":"oak","extras":{"stand_ins":"far"}},{"mesh":9,"name":"far"}])"}) {
        const Scene scene = imported(nodes);
        EXPECT_EQ(scene.triangles(), 1U);
        EXPECT_TRUE(scene.stand_ins.empty());
        EXPECT_TRUE(scene.damage.empty());
        EXPECT_TRUE(warns(scene, "Stand-in 'far' of 'oak' is left out"));
    }
}

TEST(StandIns, ThatLackATextureAreNamed) {
    TriangleGltf other;
    other.primitive += R"(,"material":0)";
    other.more =
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],"images":[{"uri":"no.png"}])";
    const auto scene = imported_with_list("[[stand_in]]\nobject = \"oak\"\nfile = \"oak_far.glb\"\n", other.file());
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_TRUE(scene->stand_ins.empty());
    EXPECT_TRUE(scene->damage.empty());
    EXPECT_TRUE(warns(*scene, "Stand-in 'oak_far.glb' of 'oak' is left out: Texture 'no.png'"));
}

TEST(StandIns, OfAMirroredNodeFaceOutwards) {
    const Scene scene = imported(
        R"([{"mesh":0,"name":"oak","extras":{"stand_ins":"far"}},{"name":"far","children":[2]},{"mesh":0,"scale":[-1,1,1]}])");
    ASSERT_EQ(scene.stand_ins.size(), 1U);
    const Primitive& p = scene.stand_ins[0].mesh.primitives.at(0);
    const vec3 a = p.positions[p.indices[0]], b = p.positions[p.indices[1]], c = p.positions[p.indices[2]];
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), p.normals[0]), 0.0F);
}

TEST(StandIns, OfAListTakeANodeOfTheScene) {
    const auto scene = imported_with_list("[[stand_in]]\nobject = \"oak\"\nnode = \"far\"\n");
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    // A mesh that is in both is drawn once, where the object is.
    EXPECT_EQ(scene->triangles(), 1U);
    ASSERT_EQ(scene->stand_ins.size(), 1U);
    EXPECT_EQ(corner(scene->stand_ins[0]), vec3(0, 2, 0));
    EXPECT_EQ(scene->sources.size(), 2U);
}

TEST(StandIns, OfAListTakeAnotherFileWithItsMaterials) {
    TriangleGltf other;
    other.primitive += R"(,"material":0)";
    other.more = R"(,"materials":[{"name":"leaves"}])";
    const auto scene = imported_with_list("[[stand_in]]\nobject = \"oak\"\nfile = \"oak_far.glb\"\n", other.file());
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->triangles(), 2U);
    ASSERT_EQ(scene->stand_ins.size(), 1U);
    EXPECT_EQ(scene->materials.at(scene->stand_ins[0].mesh.primitives.at(0).material).name, "leaves");
    EXPECT_EQ(scene->sources.size(), 3U);
}

TEST(StandIns, OfAListMayStandForSeveralObjects) {
    const auto scene = imported_with_list(
        "[[stand_in]]\nobject = \"oak\"\nnode = \"far\"\n[[stand_in]]\nobject = \"mesh\"\nnode = \"far\"\n"
        "[[stand_in]]\nobject = \"far\"\nnode = \"oak\"\n");
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->stand_ins.size(), 2U);
    EXPECT_EQ(scene->triangles(), 1U);
    EXPECT_TRUE(warns(*scene, "Stand-in 'oak' of 'far' is left out"));
}

TEST(StandIns, OfAListThatAreNotThereAreNamed) {
    const auto scene = imported_with_list(
        "[[stand_in]]\nobject = \"oka\"\nnode = \"far\"\n[[stand_in]]\nobject = \"oak\"\nnode = \"fra\"\n"
        "[[stand_in]]\nobject = \"oak\"\nfile = \"none.glb\"\n");
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->triangles(), 2U);
    EXPECT_TRUE(scene->stand_ins.empty());
    EXPECT_TRUE(
        warns(*scene, "Stand-in 'far' of 'oka' is left out: no node with triangles has the object's name (did you mean 'oak'?)"));
    EXPECT_TRUE(warns(*scene, "Stand-in 'fra' of 'oak' is left out: no node has that name (did you mean 'far'?)"));
    EXPECT_TRUE(warns(*scene, "There is no such file"));
}

TEST(StandIns, OfAListWithMistakesAreRefusedByLine) {
    const auto unknown = imported_with_list("[[stand_in]]\nobject = \"oak\"\nnod = \"far\"\n");
    ASSERT_FALSE(unknown.ok());
    EXPECT_NE(unknown.error().text().find("model.stand_ins.toml:3: The key 'stand_in.nod' is unknown. Did you mean 'node'?"),
              std::string::npos)
        << unknown.error().text();
    for (const char* list :
         {"[[stand_in]]\nnode = \"far\"\n", "[[stand_in]]\nobject = \"oak\"\n",
          "[[stand_in]]\nobject = \"oak\"\nnode = \"far\"\nfile = \"x.glb\"\n", "stand_in = 3\n", "[[stand_in\n"})
        EXPECT_FALSE(imported_with_list(list).ok()) << list;
}

TEST(StandIns, OfSeveralFilesKeepTheirMeshes) {
    const Folder folder;
    TriangleGltf plain, with;
    with.nodes = R"([{"mesh":0,"name":"oak","extras":{"stand_ins":"far"}},{"mesh":0,"name":"far"}])";
    const auto scene = import_files({folder.write("a.glb", plain.file()), folder.write("b.glb", with.file())}, {});
    ASSERT_TRUE(scene.ok());
    ASSERT_EQ(scene->stand_ins.size(), 1U);
    EXPECT_EQ(scene->stand_ins[0].of, 1U);
    EXPECT_LT(scene->stand_ins[0].mesh.primitives.at(0).material, scene->materials.size());
}

}  // namespace
}  // namespace surefoot::importer::test
