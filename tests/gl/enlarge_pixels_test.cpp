// Enlarging by the processor: exact to one step of 255 at any size, and what a constant picture becomes.
#include "render/gl/enlarge_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "rt/base/random.hpp"

namespace surefoot::gl {
namespace {

int channel(const std::vector<std::uint32_t>& pixels, std::uint32_t width, std::uint32_t x, std::uint32_t y, unsigned c) {
    return static_cast<int>((pixels[std::size_t{y} * width + x] >> (8 * c)) & 255U);
}

/// The two pixels between which the centre of pixel i of `to` lies, and how far behind the first.
struct Between {
    std::uint32_t first, second;
    double share;
};
Between between(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, from - 1.0);
    const auto first = static_cast<std::uint32_t>(at);
    return {first, std::min(first + 1, from - 1), at - first};
}

int worst_error(model::Viewport from, model::Viewport to, const std::vector<std::uint32_t>& source,
                const std::vector<std::uint32_t>& result) {
    int worst = 0;
    for (std::uint32_t y = 0; y < to.height; ++y) {
        for (std::uint32_t x = 0; x < to.width; ++x) {
            const Between u = between(x, from.width, to.width), v = between(y, from.height, to.height);
            for (unsigned c = 0; c < 4; ++c) {
                const auto row = [&](std::uint32_t at) {
                    return (1 - u.share) * channel(source, from.width, u.first, at, c) +
                           u.share * channel(source, from.width, u.second, at, c);
                };
                const double exact = (1 - v.share) * row(v.first) + v.share * row(v.second);
                worst = std::max(worst, std::abs(static_cast<int>(std::lround(exact)) - channel(result, to.width, x, y, c)));
            }
        }
    }
    return worst;
}

struct Sizes {
    model::Viewport from, to;
    int worst;
};

// Sides that are no multiples of 8 have shares that are not whole 128ths.
TEST(EnlargePixels, AreNearlyExactAtAnySize) {
    Random random(5);
    const std::vector<Sizes> sizes = {{{640, 360}, {1280, 720}, 1}, {{800, 450}, {1280, 720}, 1}, {{84, 42}, {96, 48}, 1},
                                      {{1, 1}, {1, 1}, 0},          {{1, 1}, {3, 2}, 0},          {{2, 1}, {3, 1}, 3},
                                      {{1, 7}, {2, 13}, 3},         {{7, 3}, {13, 5}, 3},         {{5, 5}, {5, 5}, 0},
                                      {{3, 2}, {640, 2}, 3},        {{883, 589}, {1009, 673}, 3}};
    for (const auto& [from, to, worst] : sizes) {
        std::vector<std::uint32_t> source(std::size_t{from.width} * from.height), result(std::size_t{to.width} * to.height);
        for (std::uint32_t& p : source) {  // mostly extremes
            const std::uint64_t bits = random.next();
            p = (bits & 7U) == 0 ? static_cast<std::uint32_t>(bits >> 32U)
                                 : 0xffU * static_cast<std::uint32_t>((bits >> 8U) & 0x01010101U);
        }
        PixelEnlarger enlarger(from, to);
        for (int times = 0; times < 2; ++times) {  // nothing is left of the last picture
            enlarger.enlarge(source, result);
            EXPECT_LE(worst_error(from, to, source, result), worst) << from.width << "x" << from.height << " to " << to.width;
            std::reverse(source.begin(), source.end());
        }
    }
}

TEST(EnlargePixels, LeaveAConstantPictureAsItIs) {
    for (const std::uint32_t colour : {0U, 0xffffffffU, 0x80ff0001U}) {
        const std::vector<std::uint32_t> source(5 * 3, colour);
        std::vector<std::uint32_t> result(8 * 6);
        PixelEnlarger({5, 3}, {8, 6}).enlarge(source, result);
        EXPECT_TRUE(std::all_of(result.begin(), result.end(), [&](std::uint32_t p) { return p == colour; }));
    }
}

}  // namespace
}  // namespace surefoot::gl
