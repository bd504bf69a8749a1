// Real models: exact triangle counts, and verdicts on everything that is hard.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

namespace fs = std::filesystem;

struct Known {
    const char* file;
    std::uint64_t triangles;  ///< after dropping
    std::uint64_t in_origin;  ///< as its ORIGIN.txt counts, with degenerate triangles and nodes of scale 0
    std::size_t meshes;
};

std::uint64_t unique_triangles(const Scene& scene) {
    std::uint64_t sum = 0;
    for (const Mesh& mesh : scene.meshes) {
        for (const Primitive& p : mesh.primitives) sum += p.indices.size() / 3;
    }
    return sum;
}

void expect_sound(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
        for (const Primitive& p : mesh.primitives) {
            ASSERT_EQ(p.normals.size(), p.positions.size());
            ASSERT_TRUE(p.uvs.empty() || p.uvs.size() == p.positions.size());
            ASSERT_TRUE(p.colours.empty() || p.colours.size() == p.positions.size());
            ASSERT_LT(p.material, scene.materials.size());
            for (const std::uint32_t i : p.indices) ASSERT_LT(i, p.positions.size());
            for (const vec3& n : p.normals) ASSERT_NEAR(glm::length(n), 1.0F, 1e-4F);
        }
    }
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        ASSERT_TRUE(scene.nodes[i].parent == none || scene.nodes[i].parent < i);
        ASSERT_TRUE(scene.nodes[i].mesh == none || scene.nodes[i].mesh < scene.meshes.size());
    }
    for (const Material& material : scene.materials) ASSERT_TRUE(material.image == none || material.image < scene.images.size());
}

TEST(RealData, GlbsHaveTheirTriangles) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUREFOOT_DATA does not name a folder";
    // Dropped: 16 of zero area in the mansion and 6 x 40 under nodes of scale 0; 12 x 40 such in the city; in keflavik
    // 9028 with repeated indices and 2441 of zero area (11 469 unique, 14 158 with instances); 16 of zero area in the kitchen.
    for (const Known& known : {Known{"interior/hospital/hospital_three_floors.glb", 435855, 435855, 36},
                               Known{"interior/ravenbridge-mansion/ravenbridge_mansion.glb", 274668, 274924, 56},
                               Known{"outdoor/candela-city/candela_city.glb", 444458, 444938, 67},
                               Known{"outdoor/flightgear-keflavik/keflavik.glb", 392299, 406457, 748},
                               Known{"interior/tum-kitchen/tum_kitchen.glb", 94900, 94916, 82}}) {
        const auto scene = import_files({(*data / known.file).string()}, {});
        ASSERT_TRUE(scene.ok()) << scene.error().text();
        std::cout << known.file << ": " << scene->triangles() << " of " << known.in_origin << " triangles, "
                  << unique_triangles(*scene) << " unique, " << scene->warnings.size() << " warnings\n";
        EXPECT_EQ(scene->triangles(), known.triangles) << known.file;
        EXPECT_LE(scene->triangles(), known.in_origin);
        EXPECT_EQ(scene->meshes.size(), known.meshes);
        EXPECT_TRUE(scene->damage.empty()) << known.file << ": " << scene->damage[0].what;
        expect_sound(*scene);
    }
}

TEST(RealData, ObjsHaveTheirTriangles) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUREFOOT_DATA does not name a folder";
    for (const auto& [file, triangles] : {std::pair{"classic/cow/cow.obj", 5804U},
                                          {"classic/stanford-bunny/stanford-bunny.obj", 69451U},
                                          {"classic/armadillo/armadillo.obj", 86482U},
                                          {"classic/utah-teapot/teapot.obj", 6320U},
                                          {"classic/spot/spot.obj", 5856U},
                                          {"outdoor/trees-sweethome3d/pine/pine.obj", 108810U}}) {
        const auto scene = import_files({(*data / file).string()}, {});
        ASSERT_TRUE(scene.ok()) << scene.error().text();
        EXPECT_EQ(scene->triangles(), triangles) << file;
        expect_sound(*scene);
    }
}

TEST(RealData, HardFilesEndInASceneOrANamedError) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUREFOOT_DATA does not name a folder";
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(*data / "hard")) {
        const std::string ending = entry.path().extension().string();
        if (entry.is_regular_file() && (ending == ".gltf" || ending == ".glb" || ending == ".obj")) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    ASSERT_GT(files.size(), 40U);
    for (const fs::path& file : files) {
        const auto scene = import_files({file.string()}, {});
        if (scene.ok()) {
            std::cout << "read    " << fs::relative(file, *data / "hard").string() << ": " << scene->triangles() << " triangles, "
                      << scene->warnings.size() << " warnings\n";
            EXPECT_GT(scene->triangles(), 0U);
            expect_sound(*scene);
        } else {
            std::cout << "refused " << fs::relative(file, *data / "hard").string() << ": " << scene.error().what << "\n";
            EXPECT_NE(scene.error().place.find(file.filename().string()), std::string::npos);
            EXPECT_FALSE(scene.error().what.empty());
        }
    }
}

TEST(RealData, TruncatedGlbIsAnErrorAtManyLengths) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUREFOOT_DATA does not name a folder";
    const Folder folder;
    for (const auto& [file, step] :
         {std::pair{"hard/trimesh/boolean.glb", 331U}, {"interior/hospital/hospital_three_floors.glb", 100003U}}) {
        std::ifstream in(*data / file, std::ios::binary);
        const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
        for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : step) {
            std::string cut = whole.substr(0, length);
            EXPECT_FALSE(import_files({folder.write("cut.glb", cut)}, {}).ok()) << file << ": " << length;
            if (length < 12) continue;
            cut.replace(8, 4, word(static_cast<std::uint32_t>(length)));  // a header that says so: the chunks still do not fit
            EXPECT_FALSE(import_files({folder.write("cut.glb", cut)}, {}).ok()) << file << ": " << length;
        }
    }
}

TEST(RealData, EarthCentredTileKeepsItsPlace) {
    const auto data = data_folder();
    if (!data) GTEST_SKIP() << "SUREFOOT_DATA does not name a folder";
    const auto scene = import_files({(*data / "hard/obj-gltf-misc/huge_coordinates_ecef_tile_2582128.glb").string()}, {});
    ASSERT_TRUE(scene.ok()) << scene.error().text();
    double farthest = 0, largest_local = 0;
    for (const Node& node : scene->nodes) {
        if (node.mesh != none) farthest = std::max(farthest, glm::length(dvec3(node.world[3])));
    }
    for (const vec3& p : scene->meshes[0].primitives[0].positions)
        largest_local = std::max<double>(largest_local, glm::length(p));
    EXPECT_GT(farthest, 6.0e6);
    EXPECT_LT(largest_local, 1.0e5);
}

}  // namespace
}  // namespace surefoot::importer::test
