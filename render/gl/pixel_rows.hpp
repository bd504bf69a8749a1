// Memory that a screen is read from, and copying pictures into it. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/window_fit.hpp"

namespace surefoot::gl {

/// What a picture is shown on: a window, or a screen.
struct Surface {
    std::uint32_t width = 0, height = 0;  ///< pixels; 0: the picture's own size
    bool half_turn = false;               ///< it stands on its head
};

/// Memory that a screen is read from: rows of 32-bit pixels, the top one first.
struct PixelRows {
    std::uint32_t* first = nullptr;  ///< null: there is none
    std::size_t stride = 0;          ///< pixels from row to row
    Surface surface;
};

/// Copies pictures into such memory, each as large as fits. Pixels of other sizes are the nearest ones. Its tables are made once.
class RowCopier {
public:
    RowCopier() = default;
    RowCopier(std::uint32_t width, std::uint32_t height, const Surface& surface);
    /// `picture`: its rows from the lowest, as GL reads them.
    void copy(std::span<const std::uint32_t> picture, const PixelRows& rows) const;

private:
    std::uint32_t width_ = 0;
    FittedPicture fit_;
    std::vector<std::uint32_t> column_;  ///< of the picture, for each of the part's
    std::vector<std::uint32_t> row_;     ///< of the picture, for each of the part's from the top
};

}  // namespace surefoot::gl
