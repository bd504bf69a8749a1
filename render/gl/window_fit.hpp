// Where a picture lies in a window of another size: as large as fits, in its own shape, in the middle. A pure function.
#pragma once

#include <algorithm>
#include <cstdint>

namespace surefoot::gl {

/// A rectangle in pixels; x and y from the window's lower left corner.
struct FittedPicture {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
    bool operator==(const FittedPicture&) const = default;
};

/// All sides above 0. The longer way is filled exactly; what is left is the same on both sides, give or take a pixel.
inline FittedPicture fit_picture(std::uint32_t width, std::uint32_t height, std::uint32_t window_width,
                                 std::uint32_t window_height) {
    const std::uint64_t by_width = std::uint64_t{window_width} * height, by_height = std::uint64_t{window_height} * width;
    FittedPicture fit{0, 0, static_cast<std::int32_t>(window_width), static_cast<std::int32_t>(window_height)};
    const auto rounded = [](std::uint64_t over, std::uint32_t under) {
        return static_cast<std::int32_t>(std::max<std::uint64_t>(1, (over + under / 2) / under));
    };
    if (by_width < by_height) {
        fit.height = rounded(by_width, width);
        fit.y = (static_cast<std::int32_t>(window_height) - fit.height) / 2;
    } else if (by_width > by_height) {
        fit.width = rounded(by_height, height);
        fit.x = (static_cast<std::int32_t>(window_width) - fit.width) / 2;
    }
    return fit;
}

}  // namespace surefoot::gl
