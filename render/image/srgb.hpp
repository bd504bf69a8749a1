// Between linear light (glTF factors and vertex colours) and the sRGB encoding that a Scene holds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace surefoot::image {

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
