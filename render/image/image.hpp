// Images in memory and in files: PNG and JPEG to RGBA8, RGBA8 to PNG.
#pragma once

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

}  // namespace surefoot::image
