// Which things the bake cuts: what hides itself, and not what one sees whole.
#include <gtest/gtest.h>

#include <algorithm>

#include "render/bake/objects.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

/// Pieces of a thing that is a scene by itself, placed once or many times. They hold all of its triangles.
std::vector<Geometry> pieces_of(importer::Primitive primitive, bool many_times) {
    importer::Mesh mesh;
    mesh.primitives.push_back(std::move(primitive));
    model::Model model;
    model.materials.resize(1);
    Geometry whole = mesh_geometry(mesh, model);
    const dvec3 size = whole.box().max - whole.box().min;
    const std::uint64_t placed = many_times ? 1'000'000 : whole.triangles();
    std::vector<Geometry> pieces = cut(whole, cut_limits({std::max({size.x, size.y, size.z}), 1, placed, true, 8192}));
    if (pieces.empty()) pieces.push_back(whole);
    std::uint64_t held = 0;
    for (const Geometry& piece : pieces) held += piece.triangles();
    EXPECT_EQ(held, whole.triangles());
    return pieces;
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

importer::Primitive sheet(int across, int up) {
    return grid_surface(across, up, [](float u, float v) { return vec3(20 * u, 3 * v, 0); });
}

TEST(Cut, WallsBehindWallsAreThingsOfTheirOwn) {
    EXPECT_GE(pieces_of(walls(8), true).size(), 3U);
    EXPECT_GE(pieces_of(walls(80), true).size(), 5U);  // 1600 triangles: two things by their length alone
}

TEST(Cut, ASheetAndABallOfManyPlacementsAreLeftWhole) {
    EXPECT_EQ(pieces_of(sheet(40, 2), true).size(), 1U);
    EXPECT_EQ(pieces_of(ball(10, 2), true).size(), 1U);
    EXPECT_EQ(pieces_of(walls(3), true).size(), 1U) << "few triangles, however deep";
}

TEST(Cut, WhatIsPlacedOnceHasSmallPieces) {
    const std::vector<Geometry> pieces = pieces_of(sheet(64, 32), false);
    EXPECT_GE(pieces.size(), 4096U / 127);
    for (const Geometry& piece : pieces) {
        EXPECT_GE(piece.triangles(), 64U);
        EXPECT_LT(piece.triangles(), 128U);
        EXPECT_LT(piece.vertices.size(), 3 * piece.triangles()) << "corners are shared, and others are not kept";
    }
    EXPECT_EQ(pieces_of(sheet(31, 2), false).size(), 1U) << "124 triangles";
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
