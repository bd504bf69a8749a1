// Generated scenes: counts, the same bits each time, nothing to repair, paths that one could walk, and there and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>

#include "render/model/view.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;
namespace fs = std::filesystem;

GeneratedScene made(std::string_view name, double scale, std::uint64_t seed = 1) {
    auto scene = generate(name, scale, seed);
    EXPECT_TRUE(scene.ok()) << scene.error().text();
    return std::move(*scene);
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const importer::Primitive& a, const importer::Primitive& b) {
    return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) && same_bytes(a.uvs, b.uvs) &&
           same_bytes(a.colours, b.colours) && a.indices == b.indices && a.material == b.material;
}

TEST(Scenes, HaveThePromisedSizes) {
    EXPECT_EQ(made("forest", 1).scene.triangles(), 105000U);
    EXPECT_NEAR(static_cast<double>(made("forest", 10).scene.triangles()), 1050000, 20);
    EXPECT_NEAR(static_cast<double>(made("room", 1).scene.triangles()), 60000, 6000);
    EXPECT_NEAR(static_cast<double>(made("town", 1).scene.triangles()), 1.0e6, 1.2e5);
    EXPECT_NEAR(static_cast<double>(made("garden", 1).scene.triangles()), 143000, 7000);
}

TEST(Scenes, GrowWithScale) {
    for (const std::string& name : scene_names()) {
        std::uint64_t before = 0;
        for (const double scale : {0.05, 0.3, 1.0, 3.0}) {
            const std::uint64_t triangles = made(name, scale).scene.triangles();
            std::cout << name << " at " << scale << ": " << triangles << " triangles\n";
            EXPECT_GT(triangles, before) << name << " at " << scale;
            before = triangles;
        }
    }
}

TEST(Scenes, AreTheSameBitsEachTimeAndOthersWithAnotherSeed) {
    for (const std::string& name : scene_names()) {
        const GeneratedScene a = made(name, 0.2, 7), b = made(name, 0.2, 7), c = made(name, 0.2, 8);
        ASSERT_EQ(a.scene.meshes.size(), b.scene.meshes.size());
        for (std::size_t i = 0; i < a.scene.meshes.size(); ++i) {
            ASSERT_EQ(a.scene.meshes[i].primitives.size(), b.scene.meshes[i].primitives.size());
            for (std::size_t k = 0; k < a.scene.meshes[i].primitives.size(); ++k)
                EXPECT_TRUE(same(a.scene.meshes[i].primitives[k], b.scene.meshes[i].primitives[k]));
        }
        ASSERT_EQ(a.scene.nodes.size(), b.scene.nodes.size());
        bool differs = a.scene.nodes.size() != c.scene.nodes.size();
        for (std::size_t i = 0; i < a.scene.nodes.size(); ++i) {
            EXPECT_EQ(a.scene.nodes[i].world, b.scene.nodes[i].world);
            differs = differs || a.scene.nodes[i].world != c.scene.nodes[i].world;
        }
        EXPECT_TRUE(differs) << name;
        for (std::size_t i = 0; i < a.scene.images.size(); ++i) EXPECT_EQ(a.scene.images[i].rgba, b.scene.images[i].rgba);
        ASSERT_EQ(a.path.samples.size(), b.path.samples.size());
        for (std::size_t i = 0; i < a.path.samples.size(); ++i)
            EXPECT_EQ(a.path.samples[i].pose.position, b.path.samples[i].pose.position);
    }
}

TEST(Scenes, HoldNothingToMend) {
    for (const std::string& name : scene_names()) {
        GeneratedScene generated = made(name, 0.3);
        std::vector<std::string> warnings = generated.scene.warnings;
        for (importer::Mesh& mesh : generated.scene.meshes) {
            EXPECT_FALSE(mesh.primitives.empty());
            for (importer::Primitive& p : mesh.primitives) {
                ASSERT_EQ(p.normals.size(), p.positions.size()) << mesh.name;
                ASSERT_LT(p.material, generated.scene.materials.size());
                clean(p, mesh.name, warnings);
            }
        }
        for (const std::string& warning : warnings) ADD_FAILURE() << name << ": " << warning;
        for (std::size_t i = 0; i < generated.scene.nodes.size(); ++i) {
            const importer::Node& node = generated.scene.nodes[i];
            ASSERT_TRUE(node.parent == none || node.parent < i);
            ASSERT_TRUE(node.mesh == none || node.mesh < generated.scene.meshes.size());
            EXPECT_GT(glm::determinant(dmat3(node.world)), 0.01) << node.name;
        }
    }
}

TEST(Scenes, ShareMeshesAmongInstances) {
    for (const auto& [name, share] : {std::pair{"forest", 3.0}, {"town", 20.0}}) {
        const GeneratedScene generated = made(name, 1);
        EXPECT_GT(static_cast<double>(generated.scene.nodes.size()), share * static_cast<double>(generated.scene.meshes.size()))
            << name;
    }
}

TEST(Scenes, TownCallsForTexturesMasksAndBlending) {
    const GeneratedScene generated = made("town", 0.1);
    bool masked = false, blended = false;
    for (const importer::Material& material : generated.scene.materials) {
        masked = masked || (material.alpha == model::AlphaMode::mask && material.image != none);
        blended = blended || material.alpha == model::AlphaMode::blend;
    }
    EXPECT_TRUE(masked && blended);
    for (const importer::Material& material : made("forest", 0.1).scene.materials) EXPECT_EQ(material.image, none);
}

TEST(Scenes, TheGardenIsOfMaskedCardsAndOfThinThings) {
    const GeneratedScene garden = made("garden", 1);
    std::uint64_t cards = 0, all = 0;
    std::size_t masks = 0;
    for (const importer::Material& material : garden.scene.materials)
        masks += material.alpha == model::AlphaMode::mask && material.image != none;
    std::map<std::string, std::size_t> named;
    for (const importer::Node& node : garden.scene.nodes) {
        if (node.mesh == none) continue;
        ++named[node.name.substr(0, node.name.find_first_of("0123456789 "))];
        for (const importer::Primitive& p : garden.scene.meshes[node.mesh].primitives) {
            all += p.indices.size() / 3;
            if (garden.scene.materials[p.material].alpha == model::AlphaMode::mask) cards += p.indices.size() / 3;
        }
    }
    EXPECT_EQ(masks, 5U) << "four of plants, one of wire";
    EXPECT_GT(2 * cards, all);
    for (const char* kind : {"apple", "hedge", "fern", "rose", "tuft", "front", "back", "left", "right", "wire"})
        EXPECT_GT(named[kind], 8U) << kind;
}

TEST(Scenes, FurnitureInterpenetrates) {
    const GeneratedScene room = made("room", 1);
    const auto box_of = [&](const importer::Node& node) {
        Box box;
        for (const importer::Primitive& p : room.scene.meshes[node.mesh].primitives) {
            for (const vec3& v : p.positions) box.grow(dvec3(node.world * dvec4(v, 1)));
        }
        return box;
    };
    Box table;
    std::vector<Box> chairs;
    for (const importer::Node& node : room.scene.nodes) {
        if (node.name == "dining table") table = box_of(node);
        if (node.name == "chair") chairs.push_back(box_of(node));
    }
    ASSERT_EQ(chairs.size(), 6U);
    for (const Box& chair : chairs) {
        EXPECT_TRUE(glm::all(glm::lessThan(chair.min, table.max)) && glm::all(glm::greaterThan(chair.max, table.min)));
    }
}

/// Distance from p to the triangle a, b, c (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return glm::length(ap);
    const dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return glm::length(bp);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return glm::length(p - (a + ab * (d1 / (d1 - d3))));
    const dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return glm::length(cp);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return glm::length(p - (a + ac * (d2 / (d2 - d6))));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return glm::length(p - (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))));
    const double s = 1 / (va + vb + vc);
    return glm::length(p - (a + ab * (vb * s) + ac * (vc * s)));
}

struct Nearest {
    double distance = 1e9;
    std::string node;
    double time_s = 0;
};

/// Of every tenth eye from everything but leaves.
Nearest nearest_solid(const GeneratedScene& generated) {
    Nearest nearest;
    Box walked;
    for (const PathSample& sample : generated.path.samples) walked.grow(sample.pose.position);
    for (const importer::Node& node : generated.scene.nodes) {
        if (node.mesh == none) continue;
        for (const importer::Primitive& p : generated.scene.meshes[node.mesh].primitives) {
            if (generated.scene.materials[p.material].name.find("lea") == 0) continue;
            std::vector<dvec3> world;
            Box box;
            for (const vec3& v : p.positions) {
                world.emplace_back(node.world * dvec4(v, 1));
                box.grow(world.back());
            }
            for (std::size_t s = 0; s < generated.path.samples.size(); s += 10) {
                const dvec3& eye = generated.path.samples[s].pose.position;
                if (box.distance(eye) >= std::min(nearest.distance, 0.5)) continue;
                for (std::size_t i = 0; i < p.indices.size(); i += 3) {
                    const double d = distance_to(eye, world[p.indices[i]], world[p.indices[i + 1]], world[p.indices[i + 2]]);
                    if (d < nearest.distance) nearest = {d, node.name, generated.path.samples[s].time_s};
                }
            }
        }
    }
    return nearest;
}

TEST(Paths, KeepClearOfWallsTrunksAndFurniture) {
    for (const auto& [name, scale] : {std::pair{"forest", 1.0},
                                      {"forest", 4.0},
                                      {"room", 1.0},
                                      {"room", 3.0},
                                      {"town", 1.0},
                                      {"town", 0.1},
                                      {"garden", 1.0},
                                      {"garden", 0.2}}) {
        for (const std::uint64_t seed : {1U, 2U, 3U}) {
            const Nearest nearest = nearest_solid(made(name, scale, seed));
            std::cout << name << " at " << scale << ", seed " << seed << ": nearest " << nearest.distance << " m ('"
                      << nearest.node << "' at " << nearest.time_s << " s)\n";
            EXPECT_GT(nearest.distance, 0.22)
                << name << " at " << scale << ", seed " << seed << ": '" << nearest.node << "' at " << nearest.time_s << " s";
        }
    }
}

/// Of a path's views, one a second: what stands near, how far one sees, and how much there is to draw.
struct Views {
    double nearest_m = 1e9, farthest_m = 0;
    std::uint64_t min_triangles = ~0ULL, max_triangles = 0;                ///< in view
    std::uint64_t min_triangles_passed = ~0ULL, max_triangles_passed = 0;  ///< triangles of a thing within three metres, in view
    std::size_t max_near = 0;                                              ///< things within three metres and in view at once
};

Views views_of(const GeneratedScene& generated) {
    struct PlacedObject {
        Box box;
        std::uint64_t triangles = 0;
    };
    std::vector<PlacedObject> objects;
    Box whole;
    for (const importer::Node& node : generated.scene.nodes) {
        if (node.mesh == none) continue;
        PlacedObject object;
        for (const importer::Primitive& p : generated.scene.meshes[node.mesh].primitives) {
            for (const vec3& v : p.positions) object.box.grow(dvec3(node.world * dvec4(v, 1)));
            object.triangles += p.indices.size() / 3;
        }
        whole.grow(object.box.min);
        whole.grow(object.box.max);
        objects.push_back(object);
    }
    Views views;
    for (std::size_t s = 0; s < generated.path.samples.size(); s += 30) {
        const Pose& pose = generated.path.samples[s].pose;
        const model::Frustum frustum = model::make_frustum(pose, {1280, 720}, whole.diagonal());
        std::uint64_t triangles = 0;
        std::size_t near = 0;
        for (const PlacedObject& object : objects) {
            if (!model::visible(frustum, object.box)) continue;
            triangles += object.triangles;
            const double distance = object.box.distance(pose.position);
            views.farthest_m = std::max(views.farthest_m, distance);
            if (distance > 3) continue;
            if (distance > 0) views.nearest_m = std::min(views.nearest_m, distance);  // 0: ground, walls about the eye
            views.min_triangles_passed = std::min(views.min_triangles_passed, object.triangles);
            views.max_triangles_passed = std::max(views.max_triangles_passed, object.triangles);
            ++near;
        }
        views.max_near = std::max(views.max_near, near);
        views.min_triangles = std::min(views.min_triangles, triangles);
        views.max_triangles = std::max(views.max_triangles, triangles);
    }
    return views;
}

TEST(Paths, PassNearClutterAndFarViewsTheSimpleAndTheComplex) {
    for (const auto& [name, far_m] : {std::pair{"forest", 40.0}, {"room", 5.0}, {"town", 100.0}, {"garden", 25.0}}) {
        const Views v = views_of(made(name, 1));
        std::cout << name << ": " << v.nearest_m << " to " << v.farthest_m << " m; at most " << v.max_near
                  << " things within 3 m, of " << v.min_triangles_passed << " to " << v.max_triangles_passed << " triangles; "
                  << v.min_triangles << " to " << v.max_triangles << " triangles in view\n";
        EXPECT_LT(v.nearest_m, 1.0) << name;
        EXPECT_GE(v.max_near, 5U) << name;
        EXPECT_GT(v.farthest_m, far_m) << name;
        EXPECT_LE(v.min_triangles_passed, 60U) << name;
        EXPECT_GE(v.max_triangles_passed, 900U) << name;
        EXPECT_GE(v.max_triangles, 3 * v.min_triangles) << name;
    }
}

TEST(Paths, AreSmoothAndLastAMinute) {
    for (const std::string& name : scene_names()) {
        const Path path = made(name, 1).path;
        EXPECT_NEAR(path.duration_s(), 60.0, 0.1);
        double fastest = 0, fastest_turn = 0, hardest = 0;
        for (std::size_t i = 2; i < path.samples.size(); ++i) {
            const PathSample &a = path.samples[i - 2], &b = path.samples[i - 1], &c = path.samples[i];
            const double dt = c.time_s - b.time_s;
            const dvec3 v0 = (b.pose.position - a.pose.position) / dt, v1 = (c.pose.position - b.pose.position) / dt;
            fastest = std::max(fastest, glm::length(v1));
            hardest = std::max(hardest, glm::length(v1 - v0) / dt);
            fastest_turn = std::max(
                fastest_turn, 2 * std::acos(std::min(1.0, std::abs(glm::dot(b.pose.orientation, c.pose.orientation)))) / dt);
            EXPECT_NEAR(glm::length(c.pose.orientation), 1.0, 1e-9);
            EXPECT_GT(glm::dot(b.pose.orientation, c.pose.orientation), 0.9);
            EXPECT_NEAR(c.pose.right().y, 0.0, 1e-9) << "the horizon is level";
        }
        std::cout << name << ": at most " << fastest << " m/s, " << fastest_turn * 57.3 << " deg/s, " << hardest << " m/s^2\n";
        EXPECT_LT(fastest, 4.0);
        EXPECT_LT(fastest_turn, 2.6);
        EXPECT_LT(hardest, 16.0);
    }
}

TEST(WriteScene, GlbComesBackAsItWas) {
    const test::TemporaryFolder folder;
    for (const std::string& name : scene_names()) {
        const GeneratedScene out = made(name, 0.1);
        const std::string file = (folder / name + ".glb");
        ASSERT_TRUE(write_scene(file, out).ok());
        const auto back = importer::import_files({file}, {});
        ASSERT_TRUE(back.ok()) << back.error().text();
        EXPECT_TRUE(back->warnings.empty());
        EXPECT_EQ(back->triangles(), out.scene.triangles());
        ASSERT_EQ(back->meshes.size(), out.scene.meshes.size());
        for (std::size_t i = 0; i < back->meshes.size(); ++i) {
            for (std::size_t k = 0; k < back->meshes[i].primitives.size(); ++k) {
                const importer::Primitive &a = back->meshes[i].primitives[k], &b = out.scene.meshes[i].primitives[k];
                EXPECT_TRUE(same_bytes(a.positions, b.positions));
                EXPECT_TRUE(a.colours == b.colours);
                EXPECT_TRUE(a.indices == b.indices);
                EXPECT_TRUE(same_bytes(a.uvs, b.uvs));
            }
        }
        ASSERT_EQ(back->images.size(), out.scene.images.size());
        ASSERT_EQ(back->nodes.size(), out.scene.nodes.size());
        std::uint64_t placed = 0;
        for (const importer::Node& node : back->nodes) placed += node.mesh == none ? 0 : 1;
        EXPECT_GT(placed, 0U);
        for (std::size_t i = 0; i < out.scene.materials.size(); ++i) {
            EXPECT_EQ(back->materials[i].alpha, out.scene.materials[i].alpha);
            for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(back->materials[i].colour[c], out.scene.materials[i].colour[c], 1e-5);
        }
        const auto path = read_path(folder / name + ".path.csv");
        ASSERT_TRUE(path.ok()) << path.error().text();
        EXPECT_EQ(path->samples.size(), out.path.samples.size());
    }
}

TEST(WriteScene, WritesTheSameBytesTwice) {
    const test::TemporaryFolder folder;
    const GeneratedScene out = made("room", 0.05);
    ASSERT_TRUE(write_scene(folder / "a.glb", out).ok());
    ASSERT_TRUE(write_scene(folder / "b.glb", made("room", 0.05)).ok());
    const auto read = [&](const char* name) {
        auto bytes = std::vector<char>(fs::file_size(folder / name));
        std::FILE* file = std::fopen((folder / name).c_str(), "rb");
        EXPECT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
        (void)std::fclose(file);
        return bytes;
    };
    EXPECT_EQ(read("a.glb"), read("b.glb"));
}

TEST(WriteScene, OstfKeepsTheTriangles) {
    const test::TemporaryFolder folder;
    const GeneratedScene out = made("room", 0.05);
    const std::string file = folder / "room.ostf";
    ASSERT_TRUE(write_scene(file, out).ok());
    EXPECT_TRUE(fs::exists(folder / "room.path.csv"));
    const auto back = importer::import_files({file}, {});
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(back->triangles(), out.scene.triangles());
    EXPECT_TRUE(back->warnings.empty()) << back->warnings.front();
    EXPECT_GE(back->images.size() + 1, out.scene.images.size());  // OSTF names only those that are seen
}

TEST(WriteScene, WhatIsOnlyReadIsRefusedWithTheRemedy) {
    const test::TemporaryFolder folder;
    for (const char* ending : {".obj", ".OBJ", ".gltf"}) {
        const auto refused = write_scene(folder / (std::string("a") + ending), made("forest", 0.01));
        ASSERT_FALSE(refused.ok()) << ending;
        EXPECT_NE(refused.error().what.find("only read"), std::string::npos) << refused.error().text();
        EXPECT_NE(refused.error().remedy.find(".glb"), std::string::npos) << refused.error().text();
        EXPECT_FALSE(fs::exists(folder / "a.path.csv"));
    }
}

TEST(WriteScene, ErrorsAreNamed) {
    EXPECT_FALSE(generate("desert", 1, 1).ok());
    EXPECT_NE(generate("desert", 1, 1).error().remedy.find("forest, room, town"), std::string::npos);
    EXPECT_FALSE(generate("forest", 0, 1).ok());
    EXPECT_FALSE(generate("forest", std::nan(""), 1).ok());
    EXPECT_FALSE(generate("forest", 1e9, 1).ok());
    const test::TemporaryFolder folder;
    EXPECT_FALSE(write_scene(folder / "a.dae", made("forest", 0.01)).ok());
    EXPECT_FALSE(write_scene(folder / "no/such/folder.glb", made("forest", 0.01)).ok());
}

}  // namespace
}  // namespace surefoot::scenes
