// import_files: what a person gets wrong on the command line, and several files in one scene.
#include <gtest/gtest.h>

#include "render/import/formats.hpp"
#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

std::string import_error(const std::vector<std::string>& files) {
    const auto scene = import_files(files, {});
    EXPECT_FALSE(scene.ok());
    if (scene.ok()) return "";
    EXPECT_FALSE(scene.error().place.empty());
    EXPECT_FALSE(scene.error().remedy.empty());
    return scene.error().text();
}

TEST(ImportFiles, EachMistakeHasItsWords) {
    const Folder folder;
    EXPECT_NE(import_error({}).find("No file is given"), std::string::npos);
    EXPECT_NE(import_error({folder.file("none.glb")}).find("There is no such file"), std::string::npos);
    EXPECT_NE(import_error({folder.file("")}).find("is a folder"), std::string::npos);
    EXPECT_NE(import_error({folder.write("a.glb", "")}).find("is empty"), std::string::npos);
    EXPECT_NE(import_error({folder.write("a.xyz", "x")}).find("The ending '.xyz' is unknown"), std::string::npos);
    EXPECT_NE(import_error({folder.write("a", "x")}).find("has no ending"), std::string::npos);
    EXPECT_NE(
        import_error({folder.write("a.glb", "not a model at all, but long enough")}).find("a.glb: The file is not a glTF file"),
        std::string::npos);
}

TEST(ImportFiles, EveryFormatIsExplainedAndFoundByEachOfItsEndings) {
    for (const Format& format : formats()) {
        EXPECT_GT(format.help.size(), 10U) << format.name;
        ASSERT_FALSE(format.endings.empty());
        for (const std::string_view ending : format.endings) {
            EXPECT_EQ(format_of("a/b.c" + std::string(ending)), &format) << ending;
            EXPECT_NE(endings_in_words().find(ending), std::string::npos);
        }
    }
    EXPECT_EQ(format_of("A.GLB"), format_of("a.glb"));
    EXPECT_EQ(format_of("a.xyz"), nullptr);
    EXPECT_EQ(format_of(".obj"), nullptr) << "a hidden file's name is no ending";
    const Folder folder;
    EXPECT_NE(import_error({folder.write("a.xyz", "x")}).find(endings_in_words()), std::string::npos);
}

TEST(ImportFiles, SeveralFilesBecomeOneScene) {
    const Folder folder;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    TriangleGltf gltf;
    gltf.nodes = R"([{"children":[1]},{"mesh":0}])";
    const auto scene =
        import_files({folder.write("a.OBJ", obj), folder.write("b.glb", gltf.file()), folder.write("c.obj", obj)}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->triangles(), 3U);
    EXPECT_EQ(scene->sources.size(), 3U);
    ASSERT_EQ(scene->nodes.size(), 4U);
    EXPECT_EQ(scene->nodes[2].parent, 1U);
    EXPECT_EQ(scene->nodes[2].mesh, 1U);
    for (std::size_t i = 0; i < scene->nodes.size(); ++i)
        EXPECT_TRUE(scene->nodes[i].parent == none || scene->nodes[i].parent < i);
    EXPECT_EQ(scene->materials[scene->meshes[2].primitives[0].material].name, "red");
    EXPECT_EQ(scene->meshes[2].primitives[0].material, 2U);
}

TEST(ImportFiles, DamageIsOfTheFileThatHasIt) {
    const Folder folder;
    const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string bad = folder.write("b.obj", "mtllib gone.mtl\nusemtl red\n" + good);
    const auto scene = import_files({folder.write("a.obj", good), bad, folder.write("c.obj", "mtllib gone.mtl\n" + good)}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    ASSERT_EQ(scene->damage.size(), 1U) << "a library that nothing asks for is only a warning";
    EXPECT_EQ(scene->damage[0].file, bad);
    EXPECT_NE(scene->damage[0].what.find("gone.mtl"), std::string::npos);
}

TEST(ImportFiles, StopIsHeeded) {
    const Folder folder;
    std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    EXPECT_FALSE(import_files({folder.write("a.glb", TriangleGltf{}.file())}, progress).ok());
}

}  // namespace
}  // namespace surefoot::importer::test
