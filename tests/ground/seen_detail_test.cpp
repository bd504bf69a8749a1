// What rays see of a ground: fronts of different blocks, near enough, whatever hides them.
#include "render/bake/seen_detail.hpp"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/ground/judged_scene.hpp"

namespace surefoot::test {

namespace {

/// A wall of 20 by 20 squares of half a metre at z = 0, which faces +z.
importer::Primitive wall_of_squares() {
    importer::Primitive p;
    for (std::uint32_t y = 0; y <= 20; ++y)
        for (std::uint32_t x = 0; x <= 20; ++x)
            p.positions.emplace_back(0.5F * static_cast<float>(x) - 5, 0.5F * static_cast<float>(y), 0);
    for (std::uint32_t y = 0; y < 20; ++y) {
        for (std::uint32_t x = 0; x < 20; ++x) {
            const std::uint32_t a = 21 * y + x;
            for (const std::uint32_t i : {a, a + 1, a + 22, a, a + 22, a + 21}) p.indices.push_back(i);
        }
    }
    return p;
}

JudgedScene walls(const std::vector<dmat4>& places) {
    JudgedScene of;
    of.scene.materials.emplace_back();
    of.scene.meshes.push_back({"wall", {wall_of_squares()}, {}});
    for (const dmat4& place : places) {
        importer::Node node;
        node.mesh = 0;
        node.world = place;
        of.scene.nodes.push_back(node);
    }
    of.finish();
    return of;
}

dmat4 at(const dvec3& where, const dvec3& scale = dvec3(1)) { return glm::scale(glm::translate(dmat4(1.0), where), scale); }

std::size_t seen(const JudgedScene& of, const dvec3& eye, double reach_m = 60) {
    return bake::blocks_seen(of.ground, eye, reach_m);
}

}  // namespace

TEST(SeenDetail, CountsFrontsOfDifferentBlocksWithinReach) {
    const JudgedScene of = walls({at({0, 0, -4})});
    EXPECT_GE(seen(of, {0, 1.7, 0}), 4U);
    EXPECT_EQ(seen(of, {0, 1.7, -8}), 0U) << "its back";
    EXPECT_EQ(seen(of, {0, 1.7, 0}, 3), 0U) << "too far";
    EXPECT_EQ(seen(of, {0, 10.5, 0}), 0U) << "no ray goes down";
    EXPECT_EQ(bake::blocks_seen({}, {0, 1.7, 0}, 60), 0U);
}

TEST(SeenDetail, AMirroredWallHasItsFrontWhereItIsDrawn) {
    for (const auto& places : {std::vector{at({0, 0, -4}, {-1, 1, 1})},  // once: in the world's tree
                               std::vector{at({0, 0, -4}, {-1, 1, 1}), at({0, 0, -9}, {-1, 1, 1})}}) {  // shared
        const JudgedScene of = walls(places);
        EXPECT_EQ(of.ground.instances.size(), places.size() > 1 ? places.size() : 0U);
        EXPECT_GE(seen(of, {0, 1.7, 0}), 4U);
        EXPECT_EQ(seen(of, {0, 1.7, -14}), 0U);
    }
}

TEST(SeenDetail, WhatStandsBehindAWallIsHidden) {
    const JudgedScene two = walls({at({0, 0, -2}), at({0, 0, -3})});
    const JudgedScene one = walls({at({0, 0, -2})});
    EXPECT_LE(seen(two, {0, 1.7, 0}), seen(one, {0, 1.7, 0}) + 2) << "but for what is seen past its ends";
    const JudgedScene back = walls({at({0, 0, -2}, {1, 1, -1}), at({0, 0, -2.5}), at({0, 0, 2}), at({0, 0, 2}, {1, 1, -1})});
    EXPECT_LE(seen(back, {0, 1.7, 0}), seen(one, {0, 1.7, 0}) + 2) << "a back hides too";
}

}  // namespace surefoot::test
