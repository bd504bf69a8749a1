// Mip levels of alpha-tested textures. Averaged alphas do not keep the share that passes the test: thin leaves and wires vanish
// with distance, dense ones grow together. Source: Castaño 2010, "Computing Alpha Mipmaps"; here coverage is also counted
// between texels.
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

/// Share of the image, 0..1, where the bilinearly filtered alpha (0..255) is at least `cutoff`.
double mask_coverage(const MaskLevel& level, float cutoff);

/// Multiplies all alphas by one factor, so that the share is as near to `coverage` as possible. Returns the remaining difference.
/// Does nothing where the share is 0 or 1.
double keep_coverage(const MaskLevel& level, float cutoff, double coverage);

}  // namespace surefoot::bake
