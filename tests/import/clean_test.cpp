// clean(): each kind of bad triangle goes with its count, the good ones stay, normals end up unit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/import/finish.hpp"
#include "render/import/scene.hpp"

namespace surefoot::importer {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Primitive square() {
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    p.indices = {0, 1, 2, 0, 2, 3};
    return p;
}

std::vector<std::string> cleaned(Primitive& p) {
    std::vector<std::string> warnings;
    clean(p, "lamp", warnings);
    return warnings;
}

TEST(Clean, LeavesGoodAloneAndMakesNormals) {
    Primitive p = square();
    EXPECT_TRUE(cleaned(p).empty());
    EXPECT_EQ(p.indices.size(), 6U);
    ASSERT_EQ(p.normals.size(), 4U);
    for (const vec3& n : p.normals) EXPECT_FLOAT_EQ(n.z, 1.0F);
}

TEST(Clean, NotFiniteGoesAndTakesItsVertexAlong) {
    Primitive p = square();
    p.positions[3].x = nan;
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings[0], "Mesh 'lamp': 1 triangles are dropped: position not finite");
    EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(p.positions.size(), 3U);
}

TEST(Clean, OutOfRangeIndexGoes) {
    Primitive p = square();
    p.indices = {0, 1, 2, 0, 2, 4, 0xffffffffU, 1, 2};
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("2 triangles are dropped: index out of range"), std::string::npos);
    EXPECT_EQ(p.indices.size(), 3U);
}

TEST(Clean, RepeatedIndexAndZeroAreaAreCountedApart) {
    Primitive p = square();
    p.positions.push_back({2, 0, 0});
    p.positions.push_back({0, 0, 0});
    p.indices.insert(p.indices.end(), {0, 0, 1, 0, 1, 4, 0, 5, 1});  // repeated, collinear, two corners in one place
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_NE(warnings[0].find("1 triangles are dropped: repeated index"), std::string::npos);
    EXPECT_NE(warnings[1].find("2 triangles are dropped: zero area"), std::string::npos);
    EXPECT_EQ(p.indices.size(), 6U);
    EXPECT_EQ(p.positions.size(), 4U);
}

TEST(Clean, TinyAndThinTrianglesAreNotZeroArea) {
    Primitive p;
    p.positions = {{0, 0, 0}, {1e-12F, 0, 0}, {0, 1e-12F, 0}, {0, 0, 0}, {1e5F, 0, 0}, {5e4F, 1e-3F, 0}};
    p.indices = {0, 1, 2, 3, 4, 5};
    EXPECT_TRUE(cleaned(p).empty());
    EXPECT_EQ(p.indices.size(), 6U);
}

TEST(Clean, EnormousCoordinatesAreRefused) {
    Primitive p = square();
    p.positions[3].y = 2e12F;
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("beyond 1e12"), std::string::npos);
    EXPECT_EQ(p.indices.size(), 3U);
}

TEST(Clean, NormalsAreRenormalisedAndBadOnesMadeAnew) {
    Primitive p = square();
    p.normals = {{0, 0, 5}, {0, 0, 0}, {nan, 0, 0}, {0, 0, 0.1F}};
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("2 normals"), std::string::npos);
    for (const vec3& n : p.normals) EXPECT_NEAR(n.z, 1.0F, 1e-6F);
}

TEST(Clean, NormalsThatCancelAreThoseOfATriangle) {
    Primitive p;
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.indices = {0, 1, 2, 0, 2, 1};  // both sides of one triangle
    EXPECT_TRUE(cleaned(p).empty());
    for (const vec3& n : p.normals) EXPECT_NEAR(std::abs(n.z), 1.0F, 1e-6F);
}

TEST(Clean, ArraysOfTheWrongLengthAndBadCoordinatesAreMended) {
    Primitive p = square();
    p.uvs = {{0, 0}, {1, nan}, {0, 1}, {1, 1}};
    p.colours.resize(3);
    const auto warnings = cleaned(p);
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_TRUE(p.colours.empty());
    EXPECT_EQ(p.uvs[1], vec2(0));
}

TEST(Flat, TrianglesShareNoVertexAndKeepWhatTheirCornersHave) {
    Primitive p;  // the two sides of a tent share the edge 0-1
    p.positions = {{0, 1, 0}, {0, 1, 1}, {1, 0, 0}, {-1, 0, 0}};
    p.uvs = {{0, 0}, {1, 0}, {0, 1}, {0.5F, 0.5F}};
    p.colours = {{1, 0, 0, 255}, {2, 0, 0, 255}, {3, 0, 0, 255}, {4, 0, 0, 255}};
    p.indices = {0, 1, 2, 1, 0, 3};
    const Primitive before = p;
    EXPECT_TRUE(cleaned(p).empty());
    EXPECT_NEAR(p.normals[0].y, 1.0F, 1e-6F) << "the mean of both sides: what is smooth";
    make_flat(p);
    EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
    ASSERT_EQ(p.positions.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
        const std::uint32_t from = before.indices[i];
        EXPECT_EQ(p.positions[i], before.positions[from]);
        EXPECT_EQ(p.uvs[i], before.uvs[from]);
        EXPECT_EQ(p.colours[i], before.colours[from]);
        EXPECT_NEAR(p.normals[i].x, i < 3 ? std::sqrt(0.5F) : -std::sqrt(0.5F), 1e-6F);
        EXPECT_NEAR(p.normals[i].y, std::sqrt(0.5F), 1e-6F);
    }
}

TEST(Clean, AreaWeighsInSharedNormals) {
    Primitive p;  // a large triangle in z = 0 and a small one in y = 0 share the edge 0-1
    p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 10, 0}, {0, 0, 1}};
    p.indices = {0, 1, 2, 0, 1, 3};
    EXPECT_TRUE(cleaned(p).empty());
    EXPECT_GT(p.normals[0].z, 0.99F);
}

}  // namespace
}  // namespace surefoot::importer
