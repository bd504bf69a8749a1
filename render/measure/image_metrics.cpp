// Pictures against pictures: plain sums in a fixed order, so that every machine gets the same figures.
#include "render/measure/image_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace surefoot::measure {

namespace {

constexpr std::size_t channels = 4;  // RGBA8; alpha is no part of what is seen

struct Sums {
    std::uint64_t sum = 0, squares = 0;
};

Sums sums_of(std::span<const std::uint8_t> rgba) {
    Sums sums;
    for (std::size_t i = 0; i < rgba.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint64_t v = rgba[i + c];
            sums.sum += v;
            sums.squares += v * v;
        }
    return sums;
}

/// 1/N sum (s_i - mean)^2, from exact integer sums; exactly 0 where all bytes are equal.
double variance(const Sums& sums, double count) {
    const double mean = static_cast<double>(sums.sum) / count;
    return std::max(0.0, static_cast<double>(sums.squares) / count - mean * mean);
}

bool constant(std::span<const std::uint8_t> rgba) {
    for (std::size_t i = 0; i < rgba.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c)
            if (rgba[i + c] != rgba[0]) return false;
    return true;
}

double decibels(double variance_of_image, double mse) {
    if (mse == 0) return std::numeric_limits<double>::infinity();
    if (variance_of_image == 0) return -std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(variance_of_image / mse);
}

/// Luma of Rec. 601 on the sRGB bytes, 0..255.
std::vector<float> luma(std::span<const std::uint8_t> rgba) {
    std::vector<float> y(rgba.size() / channels);
    for (std::size_t i = 0; i < y.size(); ++i) {
        const auto* p = rgba.data() + i * channels;
        y[i] = 0.299F * static_cast<float>(p[0]) + 0.587F * static_cast<float>(p[1]) + 0.114F * static_cast<float>(p[2]);
    }
    return y;
}

struct Window {
    std::uint32_t x, y, width, height;
};

double window_ssim(const std::vector<float>& a, const std::vector<float>& b, std::uint32_t stride, const Window& w) {
    constexpr double c1 = (0.01 * 255) * (0.01 * 255);
    constexpr double c2 = (0.03 * 255) * (0.03 * 255);
    double sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
    for (std::uint32_t y = w.y; y < w.y + w.height; ++y)
        for (std::uint32_t x = w.x; x < w.x + w.width; ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * stride + x;
            const double va = a[at];
            const double vb = b[at];
            sum_a += va;
            sum_b += vb;
            aa += va * va;
            bb += vb * vb;
            ab += va * vb;
        }
    const double n = static_cast<double>(w.width) * w.height;
    const double mean_a = sum_a / n;
    const double mean_b = sum_b / n;
    const double var_a = aa / n - mean_a * mean_a;
    const double var_b = bb / n - mean_b * mean_b;
    const double covariance = ab / n - mean_a * mean_b;
    return ((2 * mean_a * mean_b + c1) * (2 * covariance + c2)) /
           ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
}

/// Starts of windows along one side: every 4 pixels, and one flush with the far edge so that no pixel is left out.
std::vector<std::uint32_t> window_starts(std::uint32_t side, std::uint32_t window) {
    std::vector<std::uint32_t> starts;
    for (std::uint32_t at = 0; at + window <= side; at += 4) starts.push_back(at);
    if (starts.back() + window < side) starts.push_back(side - window);
    return starts;
}

}  // namespace

Snr snr(std::span<const std::uint8_t> simplified, std::span<const std::uint8_t> reference) {
    Snr result;
    if (simplified.size() != reference.size() || simplified.size() < channels) {
        result.defined = false;
        return result;
    }
    const std::size_t pixels = simplified.size() / channels;
    const double count = static_cast<double>(pixels) * 3;
    std::uint64_t squared_error = 0;
    for (std::size_t i = 0; i < simplified.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int64_t d = std::int64_t{simplified[i + c]} - std::int64_t{reference[i + c]};
            squared_error += static_cast<std::uint64_t>(d * d);
        }
    result.mse = static_cast<double>(squared_error) / count;
    const double var_simplified = constant(simplified) ? 0 : variance(sums_of(simplified), count);
    const double var_reference = constant(reference) ? 0 : variance(sums_of(reference), count);
    result.db = decibels(var_simplified, result.mse);
    result.var_reference_db = decibels(var_reference, result.mse);
    result.defined = result.mse == 0 || var_simplified > 0;
    return result;
}

double ssim(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, std::uint32_t width, std::uint32_t height) {
    const std::size_t bytes = static_cast<std::size_t>(width) * height * channels;
    if (a.size() != bytes || b.size() != bytes || bytes == 0) return 0;
    const auto luma_a = luma(a);
    const auto luma_b = luma(b);
    const std::uint32_t w = std::min<std::uint32_t>(8, width);
    const std::uint32_t h = std::min<std::uint32_t>(8, height);
    const auto across = window_starts(width, w);
    const auto down = window_starts(height, h);
    double sum = 0;
    for (const auto y : down)
        for (const auto x : across) sum += window_ssim(luma_a, luma_b, width, {x, y, w, h});
    return sum / (static_cast<double>(across.size()) * static_cast<double>(down.size()));
}

double share_within(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, int steps) {
    if (a.size() != b.size()) return 0;
    if (a.empty()) return 1;
    std::size_t within = 0;
    for (std::size_t i = 0; i < a.size(); i += channels) {
        bool near = true;
        for (std::size_t c = 0; c < 3; ++c) near = near && std::abs(int{a[i + c]} - int{b[i + c]}) <= steps;
        within += near ? 1 : 0;
    }
    const std::size_t pixels = a.size() / channels;
    return static_cast<double>(within) / static_cast<double>(pixels);
}

std::vector<std::uint8_t> difference_image(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
    constexpr int amplification = 4;
    if (a.size() != b.size()) return {};
    std::vector<std::uint8_t> out(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        const bool alpha = i % channels == 3;
        out[i] = static_cast<std::uint8_t>(alpha ? 255 : std::min(255, amplification * std::abs(int{a[i]} - int{b[i]})));
    }
    return out;
}

}  // namespace surefoot::measure
