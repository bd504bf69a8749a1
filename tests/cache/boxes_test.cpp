// The tree of boxes: its counts, its shape, and the triangles in each box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/cache/boxes.hpp"
#include "rt/base/random.hpp"

namespace surefoot::cache {
namespace {

std::vector<Triangle> cloud(std::size_t count, std::uint64_t seed, const dvec3& size = dvec3(10, 4, 7), double side_m = 1) {
    Random random(seed);
    std::vector<Triangle> out;
    for (std::size_t i = 0; i < count; ++i) {
        const dvec3 at = any_in(random, dvec3(0), size);
        Triangle triangle;
        for (dvec3& corner : triangle) corner = at + any_in(random, dvec3(0), dvec3(side_m));
        out.push_back(triangle);
    }
    return out;
}

TEST(Boxes, HaveTheNumbersOfThePaper) {
    const auto scene = cloud(200, 1);
    for (const auto& [branching, levels, count] : {std::array{4U, 5U, 341U}, {8U, 4U, 585U}, {8U, 3U, 73U}, {2U, 1U, 1U}}) {
        const TreeOptions options{.branching = branching, .levels = levels};
        EXPECT_EQ(full_box_count(options), count);
        const auto tree = make_boxes(scene, options);
        ASSERT_TRUE(tree) << tree.error().text();
        EXPECT_EQ(tree->boxes.size(), count);
    }
}

TEST(Boxes, FillTheirParentsAndAreNearCubes) {
    const auto scene = cloud(500, 2);
    const auto tree = make_boxes(scene, {.branching = 8, .levels = 4});
    ASSERT_TRUE(tree);
    for (Index i = 0; i < tree->boxes.size(); ++i) {
        const CacheBox& box = tree->boxes[i];
        if (box.level >= 2) {
            const dvec3 side = box.box.max - box.box.min;
            const double longest = std::max({side.x, side.y, side.z}), shortest = std::min({side.x, side.y, side.z});
            EXPECT_LE(longest, 2.001 * shortest) << "box " << i;
        }
        if (box.child_count == 0) {
            EXPECT_EQ(box.height, 0U);
            continue;
        }
        EXPECT_GT(box.first_child, i);
        double volume = 0;
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) {
            const CacheBox& part = tree->boxes[child];
            EXPECT_EQ(part.parent, i);
            EXPECT_EQ(part.level, box.level + 1);
            EXPECT_EQ(part.height + 1, box.height);
            EXPECT_TRUE(box.box.contains(part.box));
            const dvec3 side = part.box.max - part.box.min;
            volume += side.x * side.y * side.z;
        }
        const dvec3 side = box.box.max - box.box.min;
        EXPECT_NEAR(volume, side.x * side.y * side.z, 1e-9 * volume);
    }
}

TEST(Boxes, HoldEveryTriangleThatMeetsThem) {
    Random random(3);
    const auto scene = cloud(300, 4);
    const auto tree = make_boxes(scene, {.branching = 4, .levels = 4});
    ASSERT_TRUE(tree);
    std::size_t held = 0;
    for (const CacheBox& box : tree->boxes) {
        const auto from = tree->primitives.begin() + box.first_primitive, to = from + box.primitive_count;
        ASSERT_TRUE(std::is_sorted(from, to));
        held += box.primitive_count;
        for (Index t = 0; t < scene.size(); ++t) {
            if (std::binary_search(from, to, t)) continue;
            for (int i = 0; i < 8; ++i) {  // no point of it is in the box
                const double u = random.unit(), v = random.unit() * (1 - u);
                const dvec3 p = scene[t][0] + u * (scene[t][1] - scene[t][0]) + v * (scene[t][2] - scene[t][0]);
                EXPECT_GT(box.box.distance(p), 0) << "triangle " << t;
            }
        }
    }
    EXPECT_LT(held, 4 * 3 * scene.size()) << "boxes hold what does not meet them";
}

TEST(Boxes, ATriangleThatCrossesWithoutACornerInsideMeets) {
    const Box box{dvec3(0), dvec3(1)};
    EXPECT_TRUE(meets({dvec3(-5, 0.5, 0.5), dvec3(5, 0.5, 0.5), dvec3(0, 9, 0.5)}, box));
    EXPECT_TRUE(meets({dvec3(-9, -9, 0.5), dvec3(9, -9, 0.5), dvec3(0, 20, 0.5)}, box)) << "the box is inside of it";
    EXPECT_TRUE(meets({dvec3(1, 0, 0), dvec3(2, 0, 0), dvec3(2, 1, 0)}, box)) << "at a corner";
    EXPECT_FALSE(meets({dvec3(1.5, 0.5, 0), dvec3(0.5, 1.6, 0), dvec3(1.6, 1.6, 0)}, box)) << "its box meets, it does not";
    EXPECT_FALSE(meets({dvec3(2), dvec3(3), dvec3(2, 3, 2)}, box));
    const auto slanted = [](double at) { return Triangle{dvec3(at, 0, 0), dvec3(0, at, 0), dvec3(0, 0, at)}; };
    EXPECT_TRUE(meets(slanted(2.99), box)) << "cuts a corner off";
    EXPECT_FALSE(meets(slanted(3.01), box)) << "passes it";
    EXPECT_TRUE(meets({dvec3(0.5), dvec3(0.5), dvec3(0.5)}, box)) << "a point";
}

TEST(Boxes, StopSplittingWhereThereIsLittle) {
    auto scene = cloud(400, 5, dvec3(1), 0.1);
    for (const Triangle& far : cloud(3, 6, dvec3(1), 0.1)) scene.push_back({far[0] + 9.0, far[1] + 9.0, far[2] + 9.0});
    const auto full = make_boxes(scene, {.branching = 8, .levels = 4});
    const auto lean = make_boxes(scene, {.branching = 8, .levels = 4, .min_primitives = 10});
    ASSERT_TRUE(full && lean);
    EXPECT_EQ(full->boxes.size(), 585U);
    EXPECT_LT(lean->boxes.size(), 200U);
    for (const CacheBox& box : lean->boxes)
        if (box.child_count > 0) {
            EXPECT_GE(box.primitive_count, 10U);
        }
    EXPECT_TRUE(std::any_of(full->boxes.begin(), full->boxes.end(), [](const CacheBox& b) { return b.primitive_count == 0; }));
}

TEST(Boxes, AreMadeOfOneTriangleAndOfOneBox) {
    const std::vector<Triangle> flat = {{dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, 1)}};
    const std::vector<Triangle> point = {{dvec3(2), dvec3(2), dvec3(2)}};
    for (const auto& scene : {flat, point}) {
        for (const std::uint32_t levels : {1U, 3U}) {
            const auto tree = make_boxes(scene, {.branching = 8, .levels = levels});
            ASSERT_TRUE(tree);
            EXPECT_EQ(tree->boxes.size(), levels == 1 ? 1U : 73U);
            EXPECT_EQ(tree->boxes.front().primitive_count, 1U);
        }
    }
}

TEST(Boxes, BadInputIsRefusedByName) {
    const auto scene = cloud(10, 7);
    const auto kind = [](const Result<BoxTree>& tree) { return tree ? ErrorKind::failed : tree.error().kind; };
    EXPECT_EQ(kind(make_boxes({}, {})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.branching = 6})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.branching = 1})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.branching = 128})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.levels = 0})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.levels = 17})), ErrorKind::misuse);
    EXPECT_EQ(kind(make_boxes(scene, {.branching = 64, .levels = 5})), ErrorKind::out_of_limits);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        auto broken = scene;
        broken[3][1].y = bad;
        const auto tree = make_boxes(broken, {});
        ASSERT_FALSE(tree);
        EXPECT_NE(tree.error().text().find("triangle 3"), std::string::npos) << tree.error().text();
    }
}

}  // namespace
}  // namespace surefoot::cache
