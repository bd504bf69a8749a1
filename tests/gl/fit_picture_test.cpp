// Pictures in windows of other sizes.
#include "render/gl/fit_picture.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace surefoot::gl {
namespace {

TEST(FitPicture, ItKeepsItsShapeAndStandsInTheMiddle) {
    const Window wide{1920, 1080}, tall{800, 1000};
    EXPECT_TRUE(fitted(1280, 720, wide).fills(wide));
    const WindowPart beside = fitted(1024, 768, wide);
    EXPECT_EQ(beside.width, 1440);
    EXPECT_EQ(beside.height, 1080);
    EXPECT_EQ(beside.x, 240);
    EXPECT_EQ(beside.y, 0);
    const WindowPart above = fitted(1600, 900, tall);
    EXPECT_EQ(above.width, 800);
    EXPECT_EQ(above.height, 450);
    EXPECT_EQ(above.y, 275);
    const WindowPart sliver = fitted(16384, 16, {100, 100});
    EXPECT_EQ(sliver.height, 1) << "never without a row";
    const WindowPart own = fitted(640, 480, {});
    EXPECT_EQ(own.width, 640) << "a window of unknown size has the picture's";
}

/// A picture whose pixel (x, y from below) is 100 * y + x.
std::vector<std::uint32_t> numbered(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) pixels.push_back(100 * y + x);
    return pixels;
}

TEST(FitPicture, RowsAreCopiedFromTheTop) {
    const Window window{3, 2};
    std::vector<std::uint32_t> memory(4 * 2, 9);
    RowCopier(3, 2, window).copy(numbered(3, 2), {memory.data(), 4, window});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{100, 101, 102, 9, 0, 1, 2, 9})) << "beyond a row's pixels nothing is written";
}

TEST(FitPicture, AHalfTurnIsTheSamePictureFromItsLastPixel) {
    const Window window{3, 2, true};
    std::vector<std::uint32_t> memory(3 * 2);
    RowCopier(3, 2, window).copy(numbered(3, 2), {memory.data(), 3, window});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{2, 1, 0, 102, 101, 100}));
}

TEST(FitPicture, ALargerWindowRepeatsPixelsAndHasBlackBorders) {
    const Window window{6, 4};
    std::vector<std::uint32_t> memory(6 * 4, 9);
    RowCopier(2, 2, window).copy(numbered(2, 2), {memory.data(), 6, window});
    EXPECT_EQ(memory, (std::vector<std::uint32_t>{0, 100, 100, 101, 101, 0, 0, 100, 100, 101, 101, 0,
                                                  0, 0,   0,   1,   1,   0, 0, 0,   0,   1,   1,   0}));
}

}  // namespace
}  // namespace surefoot::gl
