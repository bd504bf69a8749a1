// Pictures in memory that a screen is read from.
#include "render/gl/pixel_rows.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace surefoot::gl {
namespace {

/// A picture whose pixel (x, y from below) is 100 * y + x.
std::vector<std::uint32_t> numbered(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) pixels.push_back(100 * y + x);
    return pixels;
}

TEST(PixelRows, RowsAreCopiedFromTheTop) {
    const Surface surface{3, 2};
    std::vector<std::uint32_t> memory(4 * 2, 9);
    RowCopier(3, 2, surface).copy(numbered(3, 2), {memory.data(), 4, surface});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{100, 101, 102, 9, 0, 1, 2, 9})) << "beyond a row's pixels nothing is written";
}

TEST(PixelRows, AHalfTurnIsTheSamePictureFromItsLastPixel) {
    const Surface surface{3, 2, true};
    std::vector<std::uint32_t> memory(3 * 2);
    RowCopier(3, 2, surface).copy(numbered(3, 2), {memory.data(), 3, surface});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{2, 1, 0, 102, 101, 100}));
}

TEST(PixelRows, ABorderOfOnePixelIsBlackToo) {
    const Surface surface{4, 2};
    std::vector<std::uint32_t> memory(4 * 2, 9);
    RowCopier(3, 2, surface).copy(numbered(3, 2), {memory.data(), 4, surface});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{100, 101, 102, 0, 0, 1, 2, 0}));
}

TEST(PixelRows, ALargerWindowRepeatsPixelsAndHasBlackBorders) {
    const Surface surface{6, 4};
    std::vector<std::uint32_t> memory(6 * 4, 9);
    RowCopier(2, 2, surface).copy(numbered(2, 2), {memory.data(), 6, surface});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{0, 100, 100, 101, 101, 0, 0, 100, 100, 101, 101, 0,
                                                  0, 0,   0,   1,   1,   0, 0, 0,   0,   1,   1,   0}));
}

}  // namespace
}  // namespace surefoot::gl
