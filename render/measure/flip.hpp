// FLIP: the difference that a viewer sees who flips between two pictures (Andersson et al. 2020, for pictures of low dynamic
// range).
#pragma once

#include <cstdint>
#include <span>

namespace surefoot::measure {

/// A 0.7 m wide monitor of 3840 pixels, seen from 0.7 m: the paper's default viewer.
constexpr double default_pixels_per_degree = 67.02;

/// Mean FLIP of two pictures, 0 (equal) to 1. Both RGBA8 in sRGB, of width x height pixels; alpha is ignored.
/// 0 if a size is wrong. Beyond the edge the nearest pixel stands. About 1 us a pixel; allocates.
double flip(std::span<const std::uint8_t> test, std::span<const std::uint8_t> reference, std::uint32_t width,
            std::uint32_t height, double pixels_per_degree = default_pixels_per_degree);

}  // namespace surefoot::measure
