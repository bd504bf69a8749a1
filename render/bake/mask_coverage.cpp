// Alphas between texels as a histogram; the factor is the cutoff over the alpha that splits it as wanted.
#include "render/bake/mask_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace surefoot::bake {

namespace {

constexpr std::size_t bins_an_alpha = 16, bins = 255 * bins_an_alpha + 1;

/// Sample points for each texel and direction. Small images need more points between their texels than large ones.
std::uint32_t points_of(const MaskLevel& level) {
    const std::uint64_t texels = std::uint64_t{level.width} * level.height;
    return texels <= 1U << 12U ? 16 : texels <= 1U << 14U ? 8 : texels <= 1U << 18U ? 4 : texels <= 1U << 22U ? 2 : 1;
}

/// How many points have the alpha of a bin.
std::vector<std::uint64_t> alphas_between(const MaskLevel& level) {
    std::vector<std::uint64_t> histogram(bins, 0);
    const std::uint32_t n = points_of(level);
    const auto alpha = [&](std::uint32_t x, std::uint32_t y) {
        return static_cast<float>(level.rgba[(static_cast<std::size_t>(y) * level.width + x) * 4 + 3]);
    };
    const auto next = [&](std::uint32_t i, std::uint32_t size) { return i + 1 < size ? i + 1 : level.clamp ? i : 0; };
    // Between the middles of four texels; alone, the texel's own middle.
    const auto along = [n](std::uint32_t k) { return n == 1 ? 0.0F : (static_cast<float>(k) + 0.5F) / static_cast<float>(n); };
    for (std::uint32_t y = 0; y < level.height; ++y) {
        const std::uint32_t below = next(y, level.height);
        for (std::uint32_t x = 0; x < level.width; ++x) {
            const std::uint32_t right = next(x, level.width);
            const float a = alpha(x, y), b = alpha(right, y), c = alpha(x, below), d = alpha(right, below);
            if (a == b && a == c && a == d) {
                histogram[static_cast<std::size_t>(a) * bins_an_alpha] += std::uint64_t{n} * n;
                continue;
            }
            for (std::uint32_t j = 0; j < n; ++j) {
                const float left = a + (c - a) * along(j), step = b + (d - b) * along(j) - left;
                for (std::uint32_t i = 0; i < n; ++i)
                    ++histogram[static_cast<std::size_t>((left + step * along(i)) * static_cast<float>(bins_an_alpha))];
            }
        }
    }
    return histogram;
}

std::uint64_t points_in(const MaskLevel& level) {
    return std::uint64_t{level.width} * level.height * points_of(level) * points_of(level);
}

}  // namespace

double mask_coverage(const MaskLevel& level, float cutoff) {
    const std::vector<std::uint64_t> histogram = alphas_between(level);
    const double first = std::ceil(static_cast<double>(cutoff) * bins_an_alpha);
    std::uint64_t shown = 0;
    for (std::size_t bin = bins; bin-- > 0 && static_cast<double>(bin) >= first;) shown += histogram[bin];
    return static_cast<double>(shown) / static_cast<double>(points_in(level));
}

double keep_coverage(const MaskLevel& level, float cutoff, double coverage) {
    if (!(coverage > 0 && coverage < 1)) return 0;
    const std::vector<std::uint64_t> histogram = alphas_between(level);
    const double points = static_cast<double>(points_in(level));
    // Of all splits the one whose share is nearest; in the middle between its two sides, so that rounding moves few across.
    double nearest = coverage, above = 256, split = 0;
    std::uint64_t shown = 0;
    for (std::size_t bin = bins; bin-- > 0;) {
        if (histogram[bin] == 0) continue;
        const double alpha = static_cast<double>(bin) / bins_an_alpha;
        const double off = std::abs(static_cast<double>(shown) / points - coverage);
        if (off <= nearest) split = (above + alpha) / 2;
        nearest = std::min(nearest, off);
        shown += histogram[bin];
        above = alpha;
    }
    if (1 - coverage < nearest) {
        split = above / 2;
        nearest = 1 - coverage;
    }
    if (!(split > 0)) return nearest;
    const double factor = static_cast<double>(cutoff) / split;
    for (std::size_t i = 3; i < level.rgba.size(); i += 4)
        level.rgba[i] = static_cast<std::uint8_t>(std::lround(std::min(255.0, level.rgba[i] * factor)));
    return nearest;
}

}  // namespace surefoot::bake
