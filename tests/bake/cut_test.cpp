// Which things the bake cuts: what hides itself, and not what one sees whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "render/bake/bake.hpp"
#include "render/bake/objects.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

/// Leaves of a scene of one thing, which hold all of its triangles.
std::size_t leaves_of(importer::Primitive primitive) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    const std::uint64_t triangles = primitive.indices.size() / 3;
    place(scene, add_mesh(scene, std::move(primitive), "thing"), dvec3(0));
    const auto model = bake(scene, {}, {});
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    if (!model.ok()) return 0;
    std::size_t leaves = 0;
    std::uint64_t held = 0;
    for (const model::Node& node : model->nodes) {
        if (node.child_count > 0) continue;
        ++leaves;
        held += model->reps[node.first_rep + node.rep_count - 1].triangles;
    }
    EXPECT_EQ(held, triangles);
    return leaves;
}

importer::Primitive walls(int count) {
    importer::Primitive all;
    for (int w = 0; w < count; ++w) {
        const auto wall = grid_surface(5, 2, [=](float u, float v) { return vec3(20 * u, 3 * v, 2.5F * static_cast<float>(w)); });
        const auto base = static_cast<std::uint32_t>(all.positions.size());
        all.positions.insert(all.positions.end(), wall.positions.begin(), wall.positions.end());
        all.normals.insert(all.normals.end(), wall.normals.begin(), wall.normals.end());
        all.uvs.insert(all.uvs.end(), wall.uvs.begin(), wall.uvs.end());
        for (const std::uint32_t i : wall.indices) all.indices.push_back(base + i);
    }
    return all;
}

TEST(Cut, WallsBehindWallsAreThingsOfTheirOwn) {
    EXPECT_GE(leaves_of(walls(8)), 3U);
    EXPECT_GE(leaves_of(walls(80)), 5U);  // 1600 triangles: two things by their length alone
}

TEST(Cut, ASheetAndABallAreLeftWhole) {
    EXPECT_EQ(leaves_of(grid_surface(40, 2, [](float u, float v) { return vec3(20 * u, 3 * v, 0); })), 1U);
    EXPECT_EQ(leaves_of(ball(10, 2)), 1U);
}

TEST(Cut, ThingsOfFewTrianglesAreLeftWholeHoweverDeep) { EXPECT_EQ(leaves_of(walls(3)), 1U); }

/// Pieces of a textured sheet that is a scene by itself. They hold all of its triangles.
std::vector<Geometry> pieces_of_sheet(int across, int up) {
    importer::Mesh mesh;
    mesh.primitives.push_back(grid_surface(across, up, [](float u, float v) { return vec3(20 * u, 3 * v, 0); }));
    model::Model model;
    model.materials.resize(1);
    const Geometry whole = mesh_geometry(mesh, model);
    std::vector<Geometry> pieces = cut(whole, cut_limits({20, 1, whole.triangles(), true, 8192}));
    if (pieces.empty()) pieces.push_back(whole);
    std::uint64_t held = 0;
    for (const Geometry& piece : pieces) held += piece.triangles();
    EXPECT_EQ(held, whole.triangles());
    return pieces;
}

TEST(Cut, WhatHasTexturesHasSmallPieces) {
    const std::vector<Geometry> pieces = pieces_of_sheet(64, 32);
    EXPECT_GE(pieces.size(), 4096U / 127);
    for (const Geometry& piece : pieces) {
        EXPECT_GE(piece.triangles(), 64U);
        EXPECT_LT(piece.triangles(), 128U);
        EXPECT_LT(piece.vertices.size(), 3 * piece.triangles()) << "corners are shared, and others are not kept";
    }
    EXPECT_EQ(pieces_of_sheet(31, 2).size(), 1U) << "124 triangles";
}

/// Levels of a sheet of triangles that is a piece of something larger.
std::vector<Level> levels_of_piece(int across, int up, double ratio, Geometry& whole) {
    importer::Mesh mesh;
    mesh.primitives.push_back(
        grid_surface(across, up, [](float u, float v) { return vec3(20 * u, 3 * v, std::sin(9 * u) * (v - 0.5F)); }));
    model::Model model;
    model.materials.resize(1);
    ChainOptions options;
    options.is_piece = true;
    options.proxy_material = model::none;
    options.ratio = ratio;
    LodChain chain = make_chain(mesh_geometry(mesh, model), options);
    whole = std::move(chain.full);
    return std::move(chain.levels);
}

bool on_border(const vec3& at) {
    constexpr float near = 1e-4F;
    return at.x < near || at.x > 20 - near || at.y < near || at.y > 3 - near;
}

TEST(Cut, APieceThatIsAllBorderHasLevels) {
    Geometry whole;
    const std::vector<Level> levels = levels_of_piece(50, 1, 0.45, whole);
    ASSERT_GE(levels.size(), 2U);
    EXPECT_LE(levels.front().triangles, 50U);
    EXPECT_EQ(levels.back().triangles, 100U);
}

TEST(Cut, APieceKeepsItsBorderWhereThatGivesALevel) {
    Geometry whole;
    const std::vector<Level> levels = levels_of_piece(20, 2, 0.3, whole);  // with its border, half of it is left
    ASSERT_GE(levels.size(), 2U);
    const Level& finest = levels[levels.size() - 2];  // but for full detail
    EXPECT_LE(finest.triangles, 0.8 * 80);
    std::set<std::uint32_t> kept, all;
    for (const GeometryPart& part : finest.parts) kept.insert(part.indices.begin(), part.indices.end());
    for (const GeometryPart& part : levels.back().parts) all.insert(part.indices.begin(), part.indices.end());
    for (const std::uint32_t vertex : all) {
        if (!on_border(position_of(whole.vertices[vertex]) + vec3(whole.centre))) continue;
        EXPECT_TRUE(kept.contains(vertex)) << vertex;
    }
}

TEST(Cut, AHundredthOfTheSceneIsShortEnough) {
    EXPECT_EQ(cut_limits({500, 1, 1000, true, 8192}).longest_m, 5);
    EXPECT_EQ(cut_limits({500, 2, 1000, true, 8192}).longest_m, 2.5) << "a mesh that is placed twice as large";
    EXPECT_EQ(cut_limits({500, 1, 131'072, true, 8192}).longest_m, 5);
    EXPECT_EQ(cut_limits({500, 1, 131'073, true, 8192}).longest_m, 62.5) << "many placements";
    EXPECT_EQ(cut_limits({500, 1, 1000, false, 8192}).longest_m, 62.5) << "of plain colours";
    EXPECT_EQ(cut_limits({500, 1, 131'073, true, 4096}).max_triangles, 4096U);
}

}  // namespace
}  // namespace surefoot::bake
