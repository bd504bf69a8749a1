// The item buffer against pictures worked out by hand.
#include "render/prepare/item_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"

namespace surefoot::prepare {
namespace {

constexpr int points = ItemBuffer::columns * ItemBuffer::rows;
using Pieces = std::vector<model::SeenPiece>;

/// Two triangles at a depth; -1..1 is the picture.
Pieces square(float left, float low, float right, float high, float depth, bool masked = false) {
    const auto at = [&](float x, float y) { return vec3(x * depth, y * depth, depth); };
    return {{{at(left, low), at(right, low), at(right, high)}, 0, masked},
            {{at(left, low), at(right, high), at(left, high)}, 0, masked}};
}
Pieces sample(float x, float y, float depth, float pixels) {
    const vec3 at(x * depth, y * depth, depth);
    return {{{at, at, at}, pixels, false}};
}
ItemBuffer::Item item(std::uint32_t number) { return {.number = number, .seed = number, .point_px = 64}; }
int count(const ItemBuffer& buffer, std::uint32_t item) {
    return static_cast<int>(
        std::count_if(buffer.points().begin(), buffer.points().end(), [&](const auto& p) { return p.item == item; }));
}

TEST(ItemBuffer, EachPointIsOfTheNearestInAnyOrder) {
    for (const bool near_first : {true, false}) {
        ItemBuffer buffer;
        if (near_first) buffer.draw(item(1), square(-1, -1, 0, 1, 5));
        buffer.draw(item(2), square(-1, -1, 1, 1, 10));
        if (!near_first) buffer.draw(item(1), square(-1, -1, 0, 1, 5));
        EXPECT_EQ(count(buffer, 1), points / 2);
        EXPECT_EQ(count(buffer, 2), points / 2);
        EXPECT_NEAR(buffer.at(3, 80).depth, 5, 1e-4);
        EXPECT_NEAR(buffer.at(150, 2).depth, 10, 1e-4);
        buffer.clear();
        EXPECT_EQ(count(buffer, ItemBuffer::none), points);
    }
}

TEST(ItemBuffer, DepthIsTrueAlongASlope) {
    ItemBuffer buffer;  // ground one metre below, from before the eye to far away; the picture is 2 m high at 1 m
    const float far = 1000;
    buffer.draw(item(7), Pieces{{{vec3(-far, -1, -1), vec3(far, -1, -1), vec3(far, -1, far)}, 0, false, 0},
                                {{vec3(-far, -1, -1), vec3(far, -1, far), vec3(-far, -1, far)}, 0, false, 1}});
    for (const int row : {0, 10, 30, 43}) {
        const float down = 1 - (static_cast<float>(row) + 0.5F) / 45;  // of one metre at one metre
        EXPECT_NEAR(buffer.at(80, row).depth, 1 / down, 2e-3 / down) << row;
        EXPECT_EQ(buffer.at(80, row).item, 7U);
    }
    EXPECT_EQ(buffer.at(80, 45).item, ItemBuffer::none) << "above the horizon";
    // Its right edge, one metre to the right of the eye, is where it is: straight below the middle it is at 45 degrees.
    buffer.clear();
    buffer.draw(item(8), Pieces{{{vec3(-far, -1, -far), vec3(1, -1, -far), vec3(1, -1, far)}, 0, false, 0},
                                {{vec3(-far, -1, -far), vec3(1, -1, far), vec3(-far, -1, far)}, 0, false, 1}});
    EXPECT_EQ(buffer.at(120, 5).item, 8U) << "within: half way to the right, nearly at the bottom";
    EXPECT_EQ(buffer.at(150, 5).item, 8U);
    EXPECT_EQ(buffer.at(150, 30).item, ItemBuffer::none) << "beyond the edge";
    EXPECT_EQ(buffer.at(84, 43).item, ItemBuffer::none) << "beyond the edge, near the horizon";
    EXPECT_EQ(buffer.at(79, 43).item, 8U);
}

TEST(ItemBuffer, ASampleFillsItsPixelsAndASmallOneAPointByChance) {
    ItemBuffer buffer;
    buffer.draw(item(1), sample(0.1F, 0.1F, 5, 64 * 100));
    EXPECT_NEAR(count(buffer, 1), 100, 21) << "ten by ten, and a row or a column";
    buffer.clear();
    Pieces dots;
    for (int i = 0; i < 400; ++i) {
        const float x = -0.95F + 0.09F * static_cast<float>(i % 20), y = -0.95F + 0.0045F * static_cast<float>(i - i % 20);
        dots.push_back(sample(x, y, 5, 16).front());
        dots.back().number = static_cast<std::uint32_t>(i);  // a quarter of a point
    }
    buffer.draw(item(2), dots);
    EXPECT_NEAR(count(buffer, 2), 100, 30);
}

TEST(ItemBuffer, OfAMaskedSurfaceHalfOfThePointsShowWhatIsBehind) {
    ItemBuffer buffer;
    buffer.draw(item(1), square(-1, -1, 1, 1, 5, true));
    buffer.draw(item(2), square(-1, -1, 1, 1, 10));
    EXPECT_NEAR(count(buffer, 1), 0.5 * points, 0.02 * points);
    EXPECT_EQ(count(buffer, 1) + count(buffer, 2), points);
}

TEST(ItemBuffer, StaysInItsRectangleAndEndsWithItsWork) {
    ItemBuffer buffer;
    ItemBuffer::Item some = item(1);
    some.within = {10, 20, 29, 39};
    buffer.draw(some, square(-1, -1, 1, 1, 5));
    buffer.draw(some, sample(0, 0, 4, 64 * 1e6F));
    EXPECT_EQ(count(buffer, 1), 20 * 20);
    ItemBuffer::Item little = item(2);
    little.work = 1000;
    Pieces walls;
    for (int i = 0; i < 100; ++i)
        for (const auto& piece : square(-1, -1, 1, 1, 3)) walls.push_back(piece);
    EXPECT_LE(buffer.draw(little, walls), 1000U + points + 1) << "the piece that it ends with is drawn whole";
    EXPECT_GE(buffer.draw(item(3), walls), 100U * points);
}

TEST(ItemBuffer, OddPiecesFillNothingOrStayInThePicture) {
    ItemBuffer buffer;
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Pieces odd{{{vec3(0), vec3(0), vec3(0)}}, {{vec3(1, 1, -5), vec3(2, 1, -5), vec3(1, 2, -5)}}};
    for (const float bad : {inf, -inf, nan, 1e30F, -1e30F}) {
        odd.push_back({{vec3(bad, 0, 1), vec3(1, 0, 1), vec3(0, 1, 1)}});
        odd.push_back({{vec3(-1, -1, 1), vec3(1, bad, 1), vec3(0, 1, bad)}});
        odd.push_back({{vec3(bad), vec3(bad), vec3(bad)}, 100});
        odd.push_back({{vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, 1)}, std::abs(bad)});
    }
    Random random(5);
    for (int i = 0; i < 20000; ++i) {
        Pieces piece(1);
        for (vec3& v : piece[0].at)
            for (int k = 0; k < 3; ++k) v[k] = static_cast<float>(random.range(-1, 1) * std::pow(10.0, random.range(-6, 9)));
        odd.push_back(piece[0]);
    }
    buffer.draw(item(3), odd);
    buffer.draw(item(4), square(-1, -1, 1, 1, 0.051F));
    for (const ItemBuffer::Point& p : buffer.points()) {
        if (p.item != ItemBuffer::none) {
            ASSERT_GT(p.depth, 0.0F);
        }
    }
}

}  // namespace
}  // namespace surefoot::prepare
