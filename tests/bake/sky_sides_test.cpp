// What sees no sky becomes pieces apart from what does: walls with two sides, and one mesh in places of both kinds.
#include "render/bake/sky_sides.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "render/bake/bake.hpp"
#include "render/bake/closed_pieces.hpp"
#include "render/bake/cluster.hpp"
#include "render/bake/objects.hpp"
#include "render/model/effects_below.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot {
namespace {

model::Model baked_house(const importer::Scene& scene, bake::Quality quality = bake::Quality::full, int workers = 0) {
    bake::BakeOptions options;
    options.quality = quality;
    options.workers = workers;
    auto model = bake::bake(scene, options, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    return std::move(*model);
}

/// Leaves of a name, and the effects of their full detail.
std::vector<std::pair<model::Index, model::EffectMask>> leaves_named(const model::Model& m, const std::string& name) {
    std::vector<std::pair<model::Index, model::EffectMask>> out;
    for (model::Index n = 0; n < m.nodes.size(); ++n)
        if (m.nodes[n].child_count == 0 && name == m.name_of(m.nodes[n]))
            out.emplace_back(n, m.reps[m.nodes[n].first_rep + m.nodes[n].rep_count - 1].effects);
    return out;
}

bool has_sun(model::EffectMask effects) { return (effects & model::effect_sun) != 0; }

TEST(SkySides, AWallsInnerSideIsAPieceWithoutTheSun) {
    const model::Model m = baked_house(lit::house_scene());
    std::uint64_t with = 0, without = 0;
    const auto pieces = leaves_named(m, "house");
    ASSERT_GE(pieces.size(), 2U);
    for (const auto& [n, effects] : pieces) {
        EXPECT_EQ(m.nodes[n].kind, model::NodeKind::piece);
        (has_sun(effects) ? with : without) += m.nodes[n].triangles;
        if (has_sun(effects)) continue;
        EXPECT_NE(effects & model::effect_openness, 0U);
        for (model::Index r = m.nodes[n].first_rep; r < m.nodes[n].first_rep + m.nodes[n].rep_count; ++r)
            EXPECT_FALSE(has_sun(m.reps[r].effects)) << "nor has a coarse form of a closed room: " << r;
    }
    EXPECT_GE(without, 300U) << "of the closed room";
    EXPECT_GE(with, 250U) << "of the outer side, without its floor";
}

TEST(SkySides, AMeshInRoomsAndOutsideHasTheSunOutsideAlone) {
    const model::Model m = baked_house(lit::house_scene());
    const auto cups = leaves_named(m, "cup");
    ASSERT_EQ(cups.size(), 6U) << "one form serves each place";
    std::size_t lit = 0;
    for (const auto& [n, effects] : cups) {
        EXPECT_EQ(has_sun(effects), m.nodes[n].box.centre().z > 5) << n;
        EXPECT_EQ(m.nodes[n].kind, model::NodeKind::object);
        lit += has_sun(effects) ? 1 : 0;
        const model::Representation& full = m.reps[m.nodes[n].first_rep + m.nodes[n].rep_count - 1];
        const model::Part& part = m.parts[full.first_part];
        if (!has_sun(effects)) {
            EXPECT_EQ(m.vertices[part.first_vertex].hidden[0], 255) << "the one outside is no part of its mean";
        }
    }
    EXPECT_EQ(lit, 1U);
}

TEST(SkySides, RegionsThatSeeNoSkyCallForNoSun) {
    const model::Model m = baked_house(lit::house_scene());
    const std::vector<model::RegionEffects> below = model::effects_below(m);
    ASSERT_EQ(m.nodes[0].child_count, 2U) << "closed rooms, and the rest";
    const model::RegionEffects &rooms = below[m.nodes[0].first_child], &open = below[m.nodes[0].first_child + 1];
    EXPECT_FALSE(has_sun(rooms.full | rooms.coarse)) << "no form of it, clusters included";
    EXPECT_TRUE(has_sun(open.full));
    EXPECT_TRUE(has_sun(below[0].full));
    EXPECT_EQ(rooms.triangles + open.triangles, m.triangles());
    EXPECT_EQ(below[0].with_effect[2], open.with_effect[2]);
    EXPECT_EQ(rooms.with_effect[2], 0U);
    std::uint64_t triangles = 0;
    for (const model::Index n : model::main_regions(m, 8)) triangles += m.nodes[n].triangles;
    EXPECT_EQ(triangles, m.triangles()) << "regions hold each leaf once";
}

TEST(SkySides, ASheetWithASideInTheOpenKeepsTheSun) {
    importer::Scene scene = lit::house_scene();
    scene.materials.resize(2);
    scene.materials[1].two_sided = true;
    // A shed of four sheets and a roof: each sees the room on one side and the sky on the other.
    importer::Primitive shed;
    lit::add_faces(shed, vec3(-2, 0, -2), vec3(2, 3, 2), false);
    shed.material = 1;
    lit::put(scene, std::move(shed), "shed", dvec3(0, 0, 12));
    const model::Model m = baked_house(scene);
    std::uint64_t lit = 0;
    for (const auto& [n, effects] : leaves_named(m, "shed")) {
        EXPECT_TRUE(has_sun(effects) || m.nodes[n].box.max.y < 0.05) << n << ": only its floor sees no sky on either side";
        lit += has_sun(effects) ? m.nodes[n].triangles : 0;
    }
    EXPECT_GE(lit, 5U * 32);
}

TEST(SkySides, DraftsAndScenesInTheOpenAreNotDivided) {
    const model::Model draft = baked_house(lit::house_scene(), bake::Quality::draft);
    for (const auto& [n, effects] : leaves_named(draft, "house")) EXPECT_TRUE(has_sun(effects)) << n;
    EXPECT_EQ(leaves_named(draft, "cup").size(), 6U);
    importer::Scene open;
    lit::put(open, lit::floor_of(20, 20), "ground", dvec3(0));
    for (int i = 0; i < 12; ++i) lit::put(open, lit::post(), "post", dvec3(3 * i - 15, 0, 2));
    const model::Model full = baked_house(open);
    EXPECT_EQ(leaves_named(full, "post").size(), 12U);
    for (const model::Representation& rep : full.reps) EXPECT_TRUE(has_sun(rep.effects));
}

TEST(SkySides, AreTheSameAtAnyNumberOfWorkers) {
    const test::TemporaryFolder folder;
    std::vector<std::string> files;
    for (const int workers : {1, 3}) {
        const std::string file = folder / ("house" + std::to_string(workers) + ".walk");
        ASSERT_TRUE(model::write_walk(file, baked_house(lit::house_scene(), bake::Quality::full, workers)).ok());
        files.push_back(*read_text(file));
    }
    EXPECT_TRUE(files[0] == files[1]) << "the same bytes";
}

/// A floor over a closed cellar, and one wall below its eastern edge. They share vertices there, so the edge is in the open.
importer::Primitive floor_with_a_wall() {
    constexpr std::uint32_t across = 4, along = 14, down = 4;
    importer::Primitive p;
    const auto add = [&](const vec3& at, const vec3& normal) {
        p.positions.push_back(at);
        p.normals.push_back(glm::normalize(normal));
    };
    for (std::uint32_t i = 0; i <= along + down; ++i)
        for (std::uint32_t j = 0; j <= across; ++j) {
            const float z = -1.8F + 0.9F * static_cast<float>(j);
            if (i < along)
                add(vec3(-6 + 12.0F / along * static_cast<float>(i), 0.2F, z), vec3(0, 1, 0));
            else
                add(vec3(6, 0.2F - 0.8F * static_cast<float>(i - along), z), i == along ? vec3(1, 1, 0) : vec3(1, 0, 0));
        }
    for (std::uint32_t i = 0; i < along + down; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t a = i * (across + 1) + j, b = a + 1, c = a + across + 1, d = c + 1;
            p.indices.insert(p.indices.end(), {a, b, c, b, d, c});
        }
    lit::add_faces(p, vec3(-5, -3, -1.5F), vec3(5, 0, 1.5F), true);
    p.uvs.resize(p.positions.size());
    return p;
}

/// The floor in a hall over it, and once more in the open.
importer::Scene floor_in_a_hall() {
    importer::Scene scene;
    const importer::Index mesh = lit::put(scene, floor_with_a_wall(), "floor", dvec3(0));
    bake::place(scene, mesh, dvec3(0, 0, 40));
    importer::Primitive hall;
    lit::add_faces(hall, vec3(-6.1F, 0.1F, -1.9F), vec3(6, 3, 1.9F), true);
    lit::put(scene, std::move(hall), "hall", dvec3(0));
    return scene;
}

TEST(SkySides, APieceIsClosedByItsOwnTrianglesInEachPlace) {
    const model::Model m = baked_house(floor_in_a_hall());
    std::array<std::uint64_t, 2> floors{};
    for (const auto& [n, effects] : leaves_named(m, "floor")) {
        const Box& box = m.nodes[n].box;
        if (box.max.y - box.min.y > 0.05 || box.min.y < 0.1) continue;
        const bool open = box.min.z > 20;
        EXPECT_EQ(has_sun(effects), open) << n << ": " << box.min.x << " to " << box.max.x;
        floors[open ? 1 : 0] += m.nodes[n].triangles;
    }
    EXPECT_GE(floors[0], 2U * 14 * 4) << "up to its edge";
    EXPECT_EQ(floors[1], floors[0]);
}

/// By place: whether the scene's first mesh sees no sky there. All of the scene is opaque.
std::vector<bool> closed_in(const importer::Scene& scene, bool two_sided, const std::vector<dmat4>& places) {
    model::Model model;
    model.materials.resize(1);
    model.materials[0].effects = model::effect_sun;
    model.materials[0].two_sided = two_sided;
    const bake::Geometry geometry = bake::mesh_geometry(scene.meshes[0], model);
    const auto rays = bake::make_light_rays(scene, {});
    const std::vector<bake::MeshInPlaces> meshes = {{&geometry, places}};
    return bake::find_closed(meshes, model.materials, rays->opaque, 1000, lit::one_by_one, [] { return true; })[0];
}

TEST(SkySides, AWallBetweenSillsIsInTheOpenThoughItsCornersLieInThem) {
    const auto wall_with = [](bool covered) {
        importer::Scene scene;
        lit::put(scene, lit::sheet(vec3(0), vec3(2, 0, 0), vec3(0, 1.25F, 0), 1), "wall", dvec3(0));
        importer::Primitive sills;
        for (const float y : {-1.25F, 1.25F})
            lit::add_faces(sills, vec3(-2.1F, y - 0.12F, -0.05F), vec3(2.1F, y + 0.12F, 0.15F), false);
        if (covered) lit::add_faces(sills, vec3(-2.2F, -1.4F, -0.1F), vec3(2.2F, 1.4F, 0.2F), false);
        lit::put(scene, std::move(sills), "sills", dvec3(0));
        return closed_in(scene, false, {dmat4(1)});
    };
    EXPECT_FALSE(wall_with(false)[0]) << "between its corners it sees sky";
    EXPECT_TRUE(wall_with(true)[0]) << "in a casing it sees none";
}

TEST(SkySides, APieceOfWhatMovesIsNotClosedByItself) {
    importer::Scene scene;
    lit::put(scene, lit::sheet(vec3(0), vec3(1, 0, 0), vec3(0, 0, -1), 1), "plate", dvec3(0, 1, 0));
    importer::Primitive room;
    lit::add_faces(room, vec3(-3, 0, -3), vec3(3, 3, 3), true);
    lit::put(scene, std::move(room), "room", dvec3(0));
    model::Model model;
    model.materials.resize(1);
    model.materials[0].effects = model::effect_sun;
    std::vector<std::vector<bake::MeshForm>> by_mesh(1);
    by_mesh[0].resize(2);
    for (bake::MeshForm& piece : by_mesh[0]) piece.chain.full = bake::mesh_geometry(scene.meshes[0], model);
    std::vector<bake::PlacedObject> objects(2);
    for (bake::PlacedObject& object : objects) object.world = glm::translate(dmat4(1), dvec3(0, 1, 0));
    for (bake::PlacedObject& object : objects) object.box = {dvec3(-3, 0, -3), dvec3(3, 3, 3)};
    objects[1].motion = 0;
    const auto rays = bake::make_light_rays(scene, {});
    ASSERT_TRUE(bake::find_closed_pieces(by_mesh, objects, model, *rays, {}));
    for (const bake::MeshForm& piece : by_mesh[0])
        EXPECT_EQ(piece.closed_in, (std::vector<bool>{true, false})) << "it may come out";
}

TEST(SkySides, WhatLiesCloseOnAFloorIsClosedInARoom) {
    importer::Scene scene;
    lit::put(scene, lit::sheet(vec3(0), vec3(0, 0, 1), vec3(1, 0, 0), 1), "plate", dvec3(0, 0.1, 0));
    importer::Primitive room;
    lit::add_faces(room, vec3(-3, 0, -3), vec3(3, 3, 3), true);
    lit::put(scene, std::move(room), "room", dvec3(0));
    const auto at = [](const dvec3& place) { return glm::translate(dmat4(1), place); };
    const std::vector<bool> closed = closed_in(scene, true, {at({0, 0.1, 0}), at({20, 0.1, 0}), at({0, 3.1, 0})});
    EXPECT_TRUE(closed[0]) << "of its underside no point sees more than a gap";
    EXPECT_FALSE(closed[1]);
    EXPECT_FALSE(closed[2]) << "on the roof its upper side sees sky";
}

TEST(Clusters, OfTwoKindsAreApartBelowTheRoot) {
    std::vector<Box> boxes;
    std::vector<bool> kind;
    for (int i = 0; i < 40; ++i) {
        const dvec3 at(i % 8, 0, i / 8);
        boxes.push_back({at, at + dvec3(0.5)});
        kind.push_back(i % 3 == 0);
    }
    const bake::ClusterTree tree = bake::grow_clusters_apart(boxes, kind, 8);
    ASSERT_EQ(tree.root, 40 + tree.clusters.size() - 1);
    ASSERT_EQ(tree.clusters.back().children.size(), 2U);
    std::vector<int> found(40, 0);
    for (std::size_t k = 0; k < 2; ++k) {
        std::vector<std::uint32_t> open{tree.clusters.back().children[k]};
        while (!open.empty()) {
            const std::uint32_t e = open.back();
            open.pop_back();
            if (e < 40) {
                ++found[e];
                EXPECT_EQ(kind[e], k == 0);
                continue;
            }
            const auto& cluster = tree.clusters[e - 40];
            open.insert(open.end(), cluster.children.begin(), cluster.children.end());
        }
    }
    EXPECT_EQ(std::count(found.begin(), found.end(), 1), 40) << "each box once";
    const bake::ClusterTree one = bake::grow_clusters_apart(boxes, std::vector<bool>(40, true), 8);
    EXPECT_EQ(one.clusters.size(), bake::grow_clusters(boxes, 8).clusters.size()) << "one kind needs no root of two";
}

}  // namespace
}  // namespace surefoot
