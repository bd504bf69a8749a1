// Picture metrics: the zero cases that the published formula leaves open, and values worked out by hand or by brute force.
#include "render/measure/image_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"

namespace surefoot::measure {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Image = std::vector<std::uint8_t>;

Image filled(std::size_t pixels, std::uint8_t grey, std::uint8_t alpha = 255) {
    Image image(pixels * 4, grey);
    for (std::size_t i = 3; i < image.size(); i += 4) image[i] = alpha;
    return image;
}

Image noise(std::size_t pixels, std::uint64_t seed) {
    Random random(seed);
    Image image(pixels * 4);
    for (auto& v : image) v = static_cast<std::uint8_t>(random.below(256));
    return image;
}

TEST(Snr, EqualPicturesAreInfiniteAndDefined) {
    const auto image = noise(100, 1);
    const auto result = snr(image, image);
    EXPECT_TRUE(result.defined);
    EXPECT_EQ(result.db, infinity);
    EXPECT_EQ(result.mse, 0);
}

TEST(Snr, BlackAgainstBlackIsInfiniteNotZeroOverZero) {
    const auto result = snr(filled(64, 0), filled(64, 0));
    EXPECT_TRUE(result.defined);
    EXPECT_EQ(result.db, infinity);
    EXPECT_EQ(result.var_reference_db, infinity);
}

TEST(Snr, ConstantSimplifiedPictureWithErrorIsUndefined) {
    const auto result = snr(filled(100, 77), noise(100, 2));
    EXPECT_FALSE(result.defined);
    EXPECT_GT(result.mse, 0);
    EXPECT_TRUE(std::isfinite(result.var_reference_db));
}

TEST(Snr, ValueWorkedOutByHand) {
    // Simplified bytes 0 and 10 in equal parts: VAR 25. Every byte off by 5: MSE 25. SNR 0 dB.
    Image simplified = filled(2, 0);
    Image reference = filled(2, 5);
    for (std::size_t c = 4; c < 7; ++c) simplified[c] = 10;
    const auto result = snr(simplified, reference);
    EXPECT_TRUE(result.defined);
    EXPECT_DOUBLE_EQ(result.mse, 25);
    EXPECT_NEAR(result.db, 0, 1e-12);
    EXPECT_EQ(result.var_reference_db, -infinity);
}

TEST(Snr, TenTimesTheVarianceIsTenDecibels) {
    Image simplified = filled(10, 100);
    for (std::size_t p = 0; p < 5; ++p)
        for (std::size_t c = 0; c < 3; ++c) simplified[p * 4 + c] = 110;  // VAR 25
    Image reference = simplified;
    for (std::size_t c = 0; c < 3; ++c) reference[c] = 115;  // 3 of 30 bytes off by 5: MSE 2.5
    EXPECT_NEAR(snr(simplified, reference).db, 10, 1e-9);
}

TEST(Snr, AlphaIsIgnored) { EXPECT_EQ(snr(filled(16, 3, 0), filled(16, 3, 255)).db, infinity); }

TEST(Snr, DifferentOrEmptySizesAreUndefined) {
    EXPECT_FALSE(snr(filled(4, 0), filled(5, 0)).defined);
    EXPECT_FALSE(snr({}, {}).defined);
}

TEST(Ssim, EqualPicturesAreOne) {
    for (const auto& image : {noise(64 * 24, 3), filled(64 * 24, 0), filled(64 * 24, 200)})
        EXPECT_NEAR(ssim(image, image, 64, 24), 1.0, 1e-12);
}

TEST(Ssim, ConstantPicturesHaveTheLuminanceTermOnly) {
    const double c1 = 6.5025;
    const double expected = (2.0 * 100 * 150 + c1) / (100.0 * 100 + 150.0 * 150 + c1);
    EXPECT_NEAR(ssim(filled(256, 100), filled(256, 150), 16, 16), expected, 1e-5);
}

/// The definition, window by window, two passes, in double: nothing shared with the room's code.
double brute_force_ssim(const Image& a, const Image& b, int width, int height) {
    const auto y_of = [&](const Image& image, int x, int y) {
        const auto* p = &image[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 4];
        return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
    };
    double total = 0;
    int windows = 0;
    for (int wy = 0; wy + 8 <= height; wy += 4)
        for (int wx = 0; wx + 8 <= width; wx += 4) {
            double mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, cov = 0;
            for (int i = 0; i < 64; ++i) {
                mean_a += y_of(a, wx + i % 8, wy + i / 8) / 64;
                mean_b += y_of(b, wx + i % 8, wy + i / 8) / 64;
            }
            for (int i = 0; i < 64; ++i) {
                const double da = y_of(a, wx + i % 8, wy + i / 8) - mean_a;
                const double db = y_of(b, wx + i % 8, wy + i / 8) - mean_b;
                var_a += da * da / 64;
                var_b += db * db / 64;
                cov += da * db / 64;
            }
            total += (2 * mean_a * mean_b + 6.5025) * (2 * cov + 58.5225) /
                     ((mean_a * mean_a + mean_b * mean_b + 6.5025) * (var_a + var_b + 58.5225));
            ++windows;
        }
    return total / windows;
}

TEST(Ssim, MatchesTheDefinitionByBruteForce) {
    const auto a = noise(40 * 28, 4);
    auto b = a;
    const auto other = noise(40 * 28, 5);
    for (std::size_t i = 0; i < b.size(); i += 3) b[i] = other[i];
    EXPECT_NEAR(ssim(a, b, 40, 28), brute_force_ssim(a, b, 40, 28), 1e-5);
}

TEST(Ssim, LastColumnsCountWhereTheSizeIsNoMultipleOfTheStride) {
    const auto a = filled(19 * 10, 90);
    auto b = a;
    for (std::size_t y = 0; y < 10; ++y) b[(y * 19 + 18) * 4] = 255;
    EXPECT_LT(ssim(a, b, 19, 10), 0.999);
}

TEST(Ssim, SmallAndMismatchedPictures) {
    EXPECT_NEAR(ssim(filled(6, 9), filled(6, 9), 3, 2), 1.0, 1e-12);
    EXPECT_EQ(ssim(filled(6, 9), filled(6, 9), 4, 2), 0);
    EXPECT_EQ(ssim({}, {}, 0, 0), 0);
}

TEST(ShareWithin, CountsPixelsNotBytes) {
    const auto a = filled(10, 100);
    auto b = a;
    b[0] = 101;  // one step: within 1
    b[4] = 103;  // a pixel with one channel off
    b[11] = 0;   // alpha: ignored
    EXPECT_DOUBLE_EQ(share_within(a, b, 1), 0.9);
    EXPECT_DOUBLE_EQ(share_within(a, b, 0), 0.8);
    EXPECT_DOUBLE_EQ(share_within(a, filled(9, 100), 255), 0);
}

TEST(DifferenceImage, IsAmplifiedClampedAndOpaque) {
    const Image a{10, 20, 200, 0};
    const Image b{13, 20, 100, 0};
    EXPECT_EQ(difference_image(a, b), (Image{12, 0, 255, 255}));
    EXPECT_TRUE(difference_image(a, Image{}).empty());
}

}  // namespace
}  // namespace surefoot::measure
