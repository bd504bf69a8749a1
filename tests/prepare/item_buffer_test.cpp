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
int count(const ItemBuffer& buffer, std::uint32_t item) {
    return static_cast<int>(
        std::count_if(buffer.points().begin(), buffer.points().end(), [&](const auto& p) { return p.item == item; }));
}

TEST(ItemBuffer, EachPointIsOfTheNearestInAnyOrder) {
    for (const bool near_first : {true, false}) {
        ItemBuffer buffer;
        if (near_first) buffer.draw(1, square(-1, -1, 0, 1, 5), 64);
        buffer.draw(2, square(-1, -1, 1, 1, 10), 64);
        if (!near_first) buffer.draw(1, square(-1, -1, 0, 1, 5), 64);
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
    buffer.draw(7,
                Pieces{{{vec3(-far, -1, -1), vec3(far, -1, -1), vec3(far, -1, far)}},
                       {{vec3(-far, -1, -1), vec3(far, -1, far), vec3(-far, -1, far)}}},
                64);
    for (const int row : {0, 10, 30, 43}) {
        const float down = 1 - (static_cast<float>(row) + 0.5F) / 45;  // of one metre at one metre
        EXPECT_NEAR(buffer.at(80, row).depth, 1 / down, 2e-3 / down) << row;
        EXPECT_EQ(buffer.at(80, row).item, 7U);
    }
    EXPECT_EQ(buffer.at(80, 46).item, ItemBuffer::none) << "above the horizon";
}

TEST(ItemBuffer, ASampleFillsItsPixelsAndASmallOneAPointByChance) {
    ItemBuffer buffer;
    buffer.draw(1, sample(0.1F, 0.1F, 5, 64 * 100), 64);
    EXPECT_NEAR(count(buffer, 1), 100, 21) << "ten by ten, and a row or a column";
    buffer.clear();
    Pieces dots;
    for (int i = 0; i < 400; ++i) {
        const float x = -0.95F + 0.09F * static_cast<float>(i % 20), y = -0.95F + 0.09F * static_cast<float>(i / 20);
        dots.push_back(sample(x, y, 5, 16).front());  // a quarter of a point
    }
    buffer.draw(2, dots, 64);
    EXPECT_NEAR(count(buffer, 2), 100, 30);
}

TEST(ItemBuffer, OfAMaskedSurfaceHalfOfThePointsShowWhatIsBehind) {
    ItemBuffer buffer;
    buffer.draw(1, square(-1, -1, 1, 1, 5, true), 64);
    buffer.draw(2, square(-1, -1, 1, 1, 10), 64);
    EXPECT_NEAR(count(buffer, 1), points / 2, points / 50);
    EXPECT_EQ(count(buffer, 1) + count(buffer, 2), points);
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
    buffer.draw(3, odd, 64);
    buffer.draw(4, square(-1, -1, 1, 1, 0.051F), 64);
    for (const ItemBuffer::Point& p : buffer.points()) {
        if (p.item != ItemBuffer::none) {
            ASSERT_GT(p.depth, 0.0F);
        }
    }
}

}  // namespace
}  // namespace surefoot::prepare
