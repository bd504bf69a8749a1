// Images in memory and in files: PNG and JPEG to RGBA8, RGBA8 to PNG. Also converts between linear light (glTF factors and
// vertex colours) and the sRGB encoding of a Scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::image {

/// Decoded RGBA8, row 0 on top.
struct Image {
    std::string name;
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    bool clamp = false;
};

/// PNG or JPEG by signature. Refuses dimensions over 16384 before allocating.
Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& place);
/// Encodes width * height RGBA8 texels as PNG; as RGB if all are opaque. For snapshots and scene generators.
Result<void> write_png(const std::string& file, std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);
std::vector<std::uint8_t> encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// IEC 61966-2-1; 0..1 to 0..1, not a number to 1 (white).
inline float encode_srgb(float linear) {
    if (!(linear < 1.0F)) return 1.0F;
    const float v = std::max(linear, 0.0F);
    return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1.0F / 2.4F) - 0.055F;
}

inline float decode_srgb(float encoded) {
    if (!(encoded < 1.0F)) return 1.0F;
    const float v = std::max(encoded, 0.0F);
    return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

/// 0..1 to 0..255, rounded; not a number to 255.
inline std::uint8_t to_byte(float v) {
    if (!(v < 1.0F)) return 255;
    return static_cast<std::uint8_t>(std::max(v, 0.0F) * 255.0F + 0.5F);  // NOLINT(bugprone-incorrect-roundings): never negative
}

}  // namespace surefoot::image
