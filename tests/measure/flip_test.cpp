// FLIP of pictures whose value can be worked out by hand, and what must hold of every picture.
#include "render/measure/flip.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace surefoot::measure {
namespace {

using Picture = std::vector<std::uint8_t>;
constexpr std::uint32_t side = 48;

Picture flat(std::array<int, 3> rgb) {
    Picture picture;
    for (std::uint32_t i = 0; i < side * side; ++i) {
        for (const int c : rgb) picture.push_back(static_cast<std::uint8_t>(c));
        picture.push_back(255);
    }
    return picture;
}

double flip_of(const Picture& a, const Picture& b) { return flip(a, b, side, side); }

/// A square of a colour in the middle.
Picture with_square(Picture picture, std::uint32_t half, std::array<int, 3> rgb) {
    for (std::uint32_t y = side / 2 - half; y < side / 2 + half; ++y)
        for (std::uint32_t x = side / 2 - half; x < side / 2 + half; ++x)
            for (std::size_t c = 0; c < 3; ++c) picture[(y * side + x) * 4 + c] = static_cast<std::uint8_t>(rgb[c]);
    return picture;
}

TEST(Flip, EqualPicturesAreZeroAndGreenAgainstBlueIsOne) {
    EXPECT_EQ(flip_of(flat({10, 200, 30}), flat({10, 200, 30})), 0);
    EXPECT_NEAR(flip_of(flat({0, 255, 0}), flat({0, 0, 255})), 1, 1e-4) << "the largest difference of colours, by definition";
}

TEST(Flip, BlackAgainstWhiteIsWhatTheFormulaGives) {
    // Lab by hand: green (87.735, -86.183, 83.180), blue (32.297, 79.188, -107.860). Hunt: a and b times 0.01 L.
    const double hyab =
        (87.735 - 32.297) + std::hypot(0.87735 * -86.183 - 0.32297 * 79.188, 0.87735 * 83.180 + 0.32297 * 107.860);
    const double cmax = std::pow(hyab, 0.7), black_white = std::pow(100, 0.7);
    const double expected = 0.95 + (black_white - 0.4 * cmax) / (0.6 * cmax) * 0.05;
    EXPECT_NEAR(flip_of(flat({0, 0, 0}), flat({255, 255, 255})), expected, 1e-4);
}

TEST(Flip, IsSymmetricAndGrowsWithTheDifference) {
    const Picture grey = flat({120, 120, 120});
    double before = 0;
    for (const int level : {124, 136, 160, 255}) {
        const Picture other = with_square(grey, 8, {level, level, level});
        const double value = flip_of(grey, other);
        EXPECT_GT(value, before) << level;
        EXPECT_LT(value, 1);
        EXPECT_NEAR(value, flip_of(other, grey), 1e-9);
        before = value;
    }
}

TEST(Flip, FineNoiseIsSeenLessFromFartherAway) {
    const Picture grey = flat({120, 120, 120});
    Picture noise = grey;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x)
            for (std::size_t c = 0; c < 3; ++c) noise[(y * side + x) * 4 + c] = (x + y) % 2 == 0 ? 100 : 140;
    EXPECT_LT(flip(noise, grey, side, side, 120), flip(noise, grey, side, side, 30));
}

TEST(Flip, AnEdgeThatIsMissingCountsMoreThanItsColourAlone) {
    const Picture grey = flat({120, 120, 120});
    // The same share of pixels differs by as much: once in one block with edges, once in a whole flat picture.
    const double whole = flip_of(grey, flat({150, 150, 150}));
    const double edges = flip_of(grey, with_square(grey, 4, {150, 150, 150})) * side * side / 64.0;
    EXPECT_GT(edges, whole);
}

TEST(Flip, WrongSizesGiveZero) {
    const Picture grey = flat({1, 2, 3});
    EXPECT_EQ(flip(grey, {}, side, side), 0);
    EXPECT_EQ(flip({}, {}, 0, 0), 0);
    EXPECT_EQ(flip(grey, grey, side, side + 1), 0);
    const Picture one = {9, 9, 9, 255}, other = {200, 9, 9, 255};
    EXPECT_GT(flip(one, other, 1, 1), 0) << "one pixel is a picture";
}

}  // namespace
}  // namespace surefoot::measure
