// Mip levels of masks: a mean of alphas is no mean of what a mask shows. Thin leaves and wires fall below the cutoff and vanish
// with distance, dense ones grow together. After Castaño, "Computing Alpha Mipmaps" (2010), with coverage counted between texels
// too.
#pragma once

#include <cstdint>
#include <span>

namespace surefoot::bake {

/// RGBA8, width * height texels.
struct MaskLevel {
    std::span<std::uint8_t> rgba;
    std::uint32_t width = 0, height = 0;
    bool clamp = false;
};

/// Share of the picture, 0..1, where alpha (0..255) is at least `cutoff`, drawn large with bilinear filtering.
double mask_coverage(const MaskLevel& level, float cutoff);

/// Scales the alphas, so that the share is as near to `coverage` as one factor can bring it; returns how far off that is. Nothing
/// where it is 0 or 1.
double keep_coverage(const MaskLevel& level, float cutoff, double coverage);

}  // namespace surefoot::bake
