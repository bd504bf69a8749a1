// Where a picture lies in a window of another size.
#include "render/gl/window_fit.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace surefoot::gl {
namespace {

TEST(WindowFit, EqualSizesAreLeftAlone) { EXPECT_EQ(fit_picture(1280, 720, 1280, 720), (FittedPicture{0, 0, 1280, 720})); }

TEST(WindowFit, TheShapeIsKeptAndTheRestIsOnBothSides) {
    EXPECT_EQ(fit_picture(1280, 720, 1920, 1080), (FittedPicture{0, 0, 1920, 1080}));
    EXPECT_EQ(fit_picture(1280, 720, 1280, 1024), (FittedPicture{0, 152, 1280, 720}));
    EXPECT_EQ(fit_picture(640, 480, 1920, 1080), (FittedPicture{240, 0, 1440, 1080}));
    EXPECT_EQ(fit_picture(640, 480, 320, 1000), (FittedPicture{0, 380, 320, 240}));
}

TEST(WindowFit, AnyTwoSizesFit) {
    for (std::uint32_t w = 1; w < 3000; w = w * 3 + 1)
        for (std::uint32_t h = 1; h < 3000; h = h * 2 + 1)
            for (std::uint32_t x = 1; x < 5000; x = x * 4 + 1)
                for (std::uint32_t y = 1; y < 5000; y = y * 3 + 2) {
                    const FittedPicture f = fit_picture(w, h, x, y);
                    const auto wide = static_cast<std::int32_t>(x), high = static_cast<std::int32_t>(y);
                    ASSERT_TRUE(f.x >= 0 && f.y >= 0 && f.width > 0 && f.height > 0);
                    ASSERT_TRUE(f.x + f.width <= wide && f.y + f.height <= high) << w << "x" << h << " in " << x << "x" << y;
                    ASSERT_TRUE(f.width == wide || f.height == high) << "one way is filled";
                    ASSERT_LE(std::abs(wide - f.width - 2 * f.x), 1);
                    ASSERT_LE(std::abs(high - f.height - 2 * f.y), 1);
                }
}

}  // namespace
}  // namespace surefoot::gl
