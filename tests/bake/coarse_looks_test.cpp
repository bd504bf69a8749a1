// What coarse forms look like: colours from the part of a picture that is shown, corners that face as their triangles do.
#include <gtest/gtest.h>

#include <cmath>

#include "render/bake/baked_colours.hpp"
#include "render/bake/corners.hpp"
#include "render/bake/materials.hpp"
#include "render/bake/objects.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

/// An atlas of 64 x 64: its lower left sixteenth light, to the right ever lighter; black all about.
model::Model atlas() {
    model::Model m;
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const auto c = static_cast<std::uint8_t>(x < 16 && y < 16 ? 150 + 4 * x : 0);
            rgba.insert(rgba.end(), {c, c, c, 255});
        }
    }
    add_texture(m, rgba, 64, 64, false, 32);
    model::Material material;
    material.colour = {1, 1, 1, 1};
    material.texture = 0;
    m.materials.push_back(material);
    return m;
}

/// A square of 2 m that shows the light part, and nothing else.
importer::Primitive square() {
    importer::Primitive p;
    p.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    p.normals.assign(4, {0, 0, 1});
    p.uvs = {{0, 0}, {0.25F, 0}, {0.25F, 0.25F}, {0, 0.25F}};
    p.indices = {0, 1, 2, 0, 2, 3};
    return p;
}

TEST(BakedColours, OfAnAtlasAreOfThePartThatIsShown) {
    const model::Model m = atlas();
    const std::vector<model::Vertex> vertices(4);
    const auto colours = baked_colours(m, square(), vertices);
    ASSERT_EQ(colours.size(), 4U);
    for (const auto& c : colours) {
        EXPECT_GE(c[0], 150) << "black is beside what is shown";
        EXPECT_LE(c[0], 210);
        EXPECT_EQ(c[3], 255);
    }
    EXPECT_GT(colours[1][0], colours[0][0] + 15) << "each corner's own part";
    EXPECT_GT(colours[2][0], colours[3][0] + 15);
}

TEST(BakedColours, OfARepeatedPictureAreItsMeanAndOfOneTexelThatTexels) {
    const model::Model m = atlas();
    const std::vector<model::Vertex> vertices(4);
    importer::Primitive p = square();
    for (vec2& uv : p.uvs) uv = uv * 400.0F + 3.7F;  // a hundred times across
    for (const auto& c : baked_colours(m, p, vertices)) EXPECT_NEAR(c[0], 180.0 / 16, 8);
    for (vec2& uv : p.uvs) uv = {8.5F / 64, 8.5F / 64};
    for (const auto& c : baked_colours(m, p, vertices)) EXPECT_NEAR(c[0], 150 + 4 * 8, 1);
}

TEST(BakedColours, WithoutTrianglesPicturesOrSenseAreStillColours) {
    model::Model m = atlas();
    const std::vector<model::Vertex> vertices(4);
    importer::Primitive p = square();
    p.indices.clear();
    EXPECT_EQ(baked_colours(m, p, vertices).size(), 4U);
    p = square();
    p.uvs.clear();
    EXPECT_EQ(baked_colours(m, p, vertices)[0], baked_colour(m, m.materials[0], vertices[0]));
    p = square();
    p.uvs.assign(4, {1e30F, -1e30F});
    EXPECT_EQ(baked_colours(m, p, vertices).size(), 4U);
    m.materials[0].texture = model::none;
    m.materials[0].colour = {0.5F, 1, 0, 1};
    EXPECT_EQ(baked_colours(m, square(), vertices)[2], (std::array<std::uint8_t, 4>{128, 255, 0, 255}));
}

/// A slab of 1 x 2 x 0.05 m, each face with vertices, colour and picture of its own: its large faces are light, its edges dark.
Geometry slab() {
    Geometry g;
    GeometryPart part{0, {}};
    const vec3 half(0.5F, 1, 0.025F);
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, w = (axis + 2) % 3;
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        const float side = face % 2 == 0 ? -1.0F : 1.0F;
        for (int corner = 0; corner < 4; ++corner) {
            model::Vertex v{};
            v.position[axis] = side * half[axis];
            v.position[u] = (corner == 1 || corner == 2 ? side : -side) * half[u];
            v.position[w] = (corner >= 2 ? 1.0F : -1.0F) * half[w];
            v.normal[axis] = static_cast<std::int8_t>(side * 127);
            g.vertices.push_back(v);
            const std::uint8_t c = axis == 2 ? 200 : 20;
            g.baked.push_back({c, c, c, 255});
        }
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) part.indices.push_back(base + i);
    }
    g.parts = {part};
    return g;
}

TEST(Corners, GoToTheVertexInTheirPlaceThatFacesAsTheirTriangleDoes) {
    Geometry g = slab();
    const CoincidentVertices coincident(g);
    Level level;
    level.parts = g.parts;
    // As a simplifier leaves it: every corner of the front is one of an edge's.
    std::vector<std::uint32_t>& indices = level.parts[0].indices;
    std::size_t moved = 0;
    for (std::size_t i = 30; i < 36; ++i) {
        for (const std::uint32_t other : coincident.with(indices[i])) {
            if (g.vertices[other].normal[2] != 0) continue;
            indices[i] = other;
            ++moved;
            break;
        }
    }
    ASSERT_EQ(moved, 6U);
    repair_corners(g, coincident, level.parts[0]);
    EXPECT_EQ(g.vertices.size(), 24U) << "there was one that fits";
    for (std::size_t i = 30; i < 36; ++i) {
        EXPECT_EQ(g.vertices[indices[i]].normal[2], 127);
        EXPECT_EQ(g.baked[indices[i]][0], 200);
    }
}

TEST(Corners, WhereNoneFitsGetTheTrianglesNormalAndOtherMaterialsAreLeftAlone) {
    Geometry g = slab();
    // The front is of another material now: its vertices are not to be borrowed.
    GeometryPart front{1, {g.parts[0].indices.end() - 6, g.parts[0].indices.end()}};
    g.parts[0].indices.resize(30);
    g.parts.push_back(front);
    const CoincidentVertices coincident(g);
    const auto at = [&](int axis, const vec3& place) {  // of the face across that axis
        for (std::uint32_t v = 0; v < 20; ++v)
            if (g.vertices[v].normal[axis] != 0 && position_of(g.vertices[v]) == place) return v;
        return model::none;
    };
    GeometryPart part{0, {at(0, {-0.5F, -1, 0.025F}), at(1, {0.5F, -1, 0.025F}), at(0, {0.5F, 1, 0.025F})}};
    for (const std::uint32_t i : part.indices) ASSERT_NE(i, model::none);
    repair_corners(g, coincident, part);
    for (const std::uint32_t i : part.indices) {
        EXPECT_GE(i, 24U);
        EXPECT_EQ(std::abs(g.vertices[i].normal[2]), 127);
        EXPECT_EQ(g.baked[i][0], 20) << "its own colour";
    }
}

TEST(Box, EachFaceHasTheColourOfWhatFacesThatWay) {
    importer::Mesh mesh;
    mesh.primitives = {ball(24, 1)};
    Geometry g = mesh_geometry(mesh, atlas());
    for (std::size_t v = 0; v < g.vertices.size(); ++v) {
        const bool above = g.vertices[v].position[1] > 0;
        g.baked[v] = above ? std::array<std::uint8_t, 4>{200, 0, 0, 255} : std::array<std::uint8_t, 4>{0, 0, 200, 255};
    }
    ChainOptions options;
    options.proxy_material = 1;
    options.smallest = 200;  // ends before a level of fewer than a box has
    const LodChain chain = make_chain(std::move(g), options);
    const Level& box = chain.levels.front();
    ASSERT_EQ(box.triangles, 12U);
    bool up = false, down = false;
    for (const std::uint32_t i : box.parts.front().indices) {
        const model::Vertex& v = chain.full.vertices[i];
        if (v.normal[1] > 0) up = v.colour[0] > 190 && v.colour[2] < 10;
        if (v.normal[1] < 0) down = v.colour[2] > 190 && v.colour[0] < 10;
        if (v.normal[1] == 0) {
            EXPECT_NEAR(v.colour[0], 100, 15);
        }
    }
    EXPECT_TRUE(up && down);
}

TEST(Corners, ThatAreBentInTheFullDetailStayBent) {
    Geometry g = slab();
    for (model::Vertex& v : g.vertices) {  // as grass is: lit from above, whichever way it faces
        v.normal[0] = v.normal[2] = 0;
        v.normal[1] = 127;
    }
    const CoincidentVertices coincident(g);
    GeometryPart part{0, g.parts[0].indices};
    part.indices = {part.indices.end() - 6, part.indices.end()};
    const std::vector<std::uint32_t> before = part.indices;
    repair_corners(g, coincident, part);
    EXPECT_EQ(part.indices, before);
}

}  // namespace
}  // namespace surefoot::bake
