// Pictures inside a page: RGBA to a data URI.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace surefoot::report {

/// A JPEG of quality 1..100 as "data:image/jpeg;base64,…"; empty where the picture is empty or its size does not fit.
std::string jpeg_data_uri(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, int quality);
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace surefoot::report
