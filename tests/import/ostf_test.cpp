// OSTF: the thesis' own cube, leaves by offset, what is truncated or lies, and there and back.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "render/import/ostf.hpp"
#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

const std::string triangle =
    "0 0 1\n0 0 0\n1 0 0\n0 0\n\n"
    "0 0 1\n1 0 0\n1 0 0\n1 0\n\n"
    "0 0 1\n0 1 0\n1 0 0\n0 1\n\n";

std::string leaf(const std::string& name, int count, const std::string& texture, const std::string& triangles) {
    return "START_TAG\n" + name + "\n" + std::to_string(count) + "\n" + texture + "\n" + triangles + "END_TAG\n";
}

/// Figure A.3: a container without a texture's line, blank lines anywhere.
std::string cube() {
    return "START_TAG\nCube\n0\n\n" + leaf("face#1", 2, "", triangle + triangle) + leaf("face#2", 1, "", triangle) + "END_TAG\n";
}

Result<OstfIndex> index_of(const std::string& text) {
    const Folder folder;
    return index_ostf(folder.write("a.ostf", text), {});
}

TEST(Ostf, IndexHoldsTheTreeAndItsLines) {
    const auto index = index_of(cube());
    ASSERT_TRUE(index.ok()) << index.error().text();
    ASSERT_EQ(index->objects.size(), 3U);
    EXPECT_EQ(index->objects[0].name, "Cube");
    EXPECT_EQ(index->objects[0].parent, none);
    EXPECT_EQ(index->objects[0].triangles, 0U);
    EXPECT_EQ(index->objects[1].name, "face#1");
    EXPECT_EQ(index->objects[1].parent, 0U);
    EXPECT_EQ(index->objects[1].triangles, 2U);
    EXPECT_EQ(index->objects[1].line, 5U);
    EXPECT_EQ(index->objects[2].parent, 0U);
}

TEST(Ostf, OneLeafIsReadByItsOffset) {
    const Folder folder;
    const auto index = index_ostf(folder.write("a.ostf", cube()), {});
    ASSERT_TRUE(index.ok());
    const auto vertices = read_ostf_leaf(*index, 2);
    ASSERT_TRUE(vertices.ok()) << vertices.error().text();
    ASSERT_EQ(vertices->size(), 3U);
    EXPECT_EQ((*vertices)[1].position, vec3(1, 0, 0));
    EXPECT_EQ((*vertices)[2].normal, vec3(0, 0, 1));
    EXPECT_EQ((*vertices)[2].uv, vec2(0, 1));
    EXPECT_EQ((*vertices)[0].colour, vec3(1, 0, 0));
    EXPECT_FALSE(read_ostf_leaf(*index, 0).ok());
    EXPECT_FALSE(read_ostf_leaf(*index, 9).ok());
}

/// Bytes of address space that this process has.
std::size_t address_space() {
    std::ifstream status("/proc/self/statm");
    std::size_t pages = 0;
    status >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// In a child that may not have more than `room` bytes beside what it has: 0 where every leaf is read and holds `count` triangles
/// each.
int read_leaves_within(std::size_t room, const std::string& file, std::size_t file_bytes, std::uint64_t leaves,
                       std::size_t count) {
    const pid_t child = fork();
    if (child == 0) {
        const rlimit limit{address_space() + room, address_space() + room};
        if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(10);
        if (void* whole = std::malloc(file_bytes)) {  // else the limit limits nothing
            std::free(whole);
            _exit(11);
        }
        const auto index = index_ostf(file, {});
        if (!index.ok() || index->objects.size() != leaves) _exit(12);
        for (std::size_t i = leaves; i-- > 0;) {
            const auto vertices = read_ostf_leaf(*index, static_cast<Index>(i));
            if (!vertices.ok() || vertices->size() != 3 * count) _exit(13);
        }
        _exit(0);
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Ostf, AFileLargerThanMemoryIsReadLeafByLeaf) {
#ifdef SUREFOOT_SANITIZED
    GTEST_SKIP() << "the sanitizers need the address space that this test takes away";
#endif
    const Folder folder;
    constexpr std::size_t leaves = 60, count = 4000;
    std::string triangles;
    for (std::size_t i = 0; i < count; ++i) triangles += triangle;
    std::string text;
    for (std::size_t i = 0; i < leaves; ++i) text += leaf("part" + std::to_string(i), count, "", triangles);
    const std::string file = folder.write("large.ostf", text);
    const std::size_t bytes = text.size();
    std::string().swap(text);
    EXPECT_EQ(read_leaves_within(bytes / 2, file, bytes, leaves, count), 0);
}

TEST(Ostf, TextureNamesAndTheirAbsence) {
    const auto index = index_of(leaf("a", 1, "line.tex", triangle) + leaf("b", 1, "", triangle) + "START_TAG\nc\n0\nsome.tex\n" +
                                leaf("d", 1, "x y.png", triangle) + "END_TAG\n");
    ASSERT_TRUE(index.ok()) << index.error().text();
    EXPECT_EQ(index->objects[0].texture, "line.tex");
    EXPECT_EQ(index->objects[1].texture, "");
    EXPECT_EQ(index->objects[3].texture, "x y.png");
}

TEST(Ostf, ImportWeldsVerticesAndWarnsOfMissingTextures) {
    const Folder folder;
    const auto scene = import_files({folder.write("a.ostf", leaf("sign", 2, "gone.tex", triangle + triangle))}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_EQ(scene->triangles(), 2U);
    EXPECT_EQ(scene->meshes[0].primitives[0].positions.size(), 3U);
    EXPECT_EQ(scene->meshes[0].primitives[0].colours[0], (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
    EXPECT_EQ(scene->meshes[0].primitives[0].uvs[0], vec2(0, 1));
    EXPECT_TRUE(warns(*scene, "Texture 'gone.tex' is left white"));
    EXPECT_TRUE(lacks(*scene, "Texture 'gone.tex' is left white"));
}

TEST(Ostf, ErrorsCarryTheLine) {
    const auto what = [](const std::string& text) {
        const auto index = index_of(text);
        EXPECT_FALSE(index.ok()) << text;
        return index.ok() ? "" : index.error().text();
    };
    EXPECT_NE(what("BEGIN\n").find(":1: The line 'BEGIN' stands where START_TAG"), std::string::npos);
    EXPECT_NE(what("START_TAG\na\nmany\n").find(":3: The text 'many' is not the number"), std::string::npos);
    EXPECT_NE(what(leaf("a", 4, "", triangle + triangle + triangle)).find("'END_TAG' stands among the triangles of 'a'"),
              std::string::npos);
    EXPECT_NE(what(leaf("a", 1, "", triangle + triangle)).find("where START_TAG or END_TAG belongs"), std::string::npos);
    EXPECT_NE(what(leaf("a", 2000000000, "", triangle)).find("more than the file can hold"), std::string::npos);
    EXPECT_NE(what("START_TAG\na\n0\n").find("'a' has no END_TAG"), std::string::npos);
    EXPECT_NE(what("END_TAG\n").find("has no START_TAG"), std::string::npos);
    EXPECT_NE(what("\n \n").find("holds no object"), std::string::npos);
    EXPECT_NE(what(std::string(200000, 'x')).find("longer than 64 KiB"), std::string::npos);
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "START_TAG\nn\n0\n";
    EXPECT_NE(what(deep).find("nested deeper"), std::string::npos);
}

TEST(Ostf, EveryTruncationIsAnError) {
    const std::string whole = cube();
    for (std::size_t length = 0; length + 1 < whole.size(); ++length)
        EXPECT_FALSE(index_of(whole.substr(0, length)).ok()) << length;
}

TEST(Ostf, AnyByteChangedNeverCrashes) {
    const Folder folder;
    const std::string whole = cube();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const char bits : {'\x01', '\x08', '\xff'}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ bits);
            const auto scene = import_files({folder.write("changed.ostf", changed)}, {});
            if (!scene.ok()) {
                EXPECT_FALSE(scene.error().what.empty());
            }
        }
    }
}

TEST(Ostf, LeafWithWordsInItIsAnErrorWhenRead) {
    const Folder folder;
    std::string text = leaf("a", 1, "", triangle);
    text.replace(text.find("1 0 0"), 5, "1 x 0");
    const auto index = index_ostf(folder.write("a.ostf", text), {});
    ASSERT_TRUE(index.ok());
    const auto vertices = read_ostf_leaf(*index, 0);
    ASSERT_FALSE(vertices.ok());
    EXPECT_NE(vertices.error().text().find("'a' from line 1"), std::string::npos);
}

Scene two_instances() {
    Scene scene;
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    p.uvs = {{0, 0}, {1, 0}, {0, 0.75F}};
    p.indices = {0, 1, 2};
    scene.meshes.push_back({"leaf", {p}});
    scene.images.push_back({"red", 1, 1, {255, 0, 0, 255}, false});
    scene.materials.push_back(Material{.name = "m", .colour = {0.5F, 0.5F, 0.5F, 1}, .image = 0});
    dmat4 mirrored(1.0);
    mirrored[0][0] = -1;
    mirrored[3] = dvec4(10, 0, 0, 1);
    scene.nodes = {Node{"root", none, none, dmat4(1.0), 1}, Node{"plain", 0, 0, dmat4(1.0), 1},
                   Node{"mirrored", 0, 0, mirrored, 1}, Node{"empty", none, none, dmat4(1.0), 1}};
    return scene;
}

TEST(Ostf, WrittenAndReadBack) {
    const Folder folder;
    const std::string file = folder.file("out.ostf");
    ASSERT_TRUE(write_ostf(file, two_instances(), {}).ok());
    const auto scene = import_files({file}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    EXPECT_TRUE(scene->warnings.empty());
    EXPECT_EQ(scene->triangles(), 2U);
    ASSERT_EQ(scene->nodes.size(), 5U);  // root, plain, plain.0, mirrored, mirrored.0: the empty one is left out
    EXPECT_EQ(scene->nodes[4].name, "mirrored.0");
    EXPECT_EQ(scene->nodes[4].parent, 3U);
    ASSERT_EQ(scene->images.size(), 1U);
    EXPECT_EQ(scene->images[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255}));
    const Primitive& p = scene->meshes[1].primitives[0];
    const dvec3 a(p.positions[p.indices[0]]), b(p.positions[p.indices[1]]), c(p.positions[p.indices[2]]);
    EXPECT_GT(glm::cross(b - a, c - a).z, 0) << "a mirrored instance keeps its front";
    EXPECT_EQ(p.colours[0], (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
    EXPECT_NEAR(scene->meshes[0].primitives[0].uvs[2].y, 0.75F, 1e-6F);
}

TEST(Ostf, WritingToAnImpossiblePlaceIsAnErrorAndKeepsTheOldFile) {
    const Folder folder;
    EXPECT_FALSE(write_ostf(folder.file("no/such/place.ostf"), two_instances(), {}).ok());
    const std::string old = folder.write("old.ostf", "as it was");
    std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    Scene large = two_instances();
    for (int i = 0; i < 20000; ++i)
        large.meshes[0].primitives[0].indices.insert(large.meshes[0].primitives[0].indices.end(), {0, 1, 2});
    EXPECT_FALSE(write_ostf(old, large, progress).ok());
    std::ifstream in(old);
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "as it was");
}

}  // namespace
}  // namespace surefoot::importer::test
