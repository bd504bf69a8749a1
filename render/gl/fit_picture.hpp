// A picture in a window or on a screen of another size: as large as its shape allows, in the middle, black around it. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace surefoot::gl {

/// Where a picture is shown.
struct Window {
    std::uint32_t width = 0, height = 0;  ///< pixels; 0: the picture's own size
    bool half_turn = false;               ///< it stands on its head
};

/// A part of a window. Its corner is the lower left one, as GL counts.
struct WindowPart {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
    [[nodiscard]] bool fills(const Window& window) const {
        return static_cast<std::uint32_t>(width) == window.width && static_cast<std::uint32_t>(height) == window.height;
    }
};

/// The largest part of the picture's shape, to a pixel, in the middle.
WindowPart fitted(std::uint32_t width, std::uint32_t height, const Window& window);

/// Memory that a screen is read from: rows of 32-bit pixels, the top one first.
struct PixelRows {
    std::uint32_t* first = nullptr;  ///< null: there is none
    std::size_t stride = 0;          ///< pixels from row to row
    Window window;
};

/// Copies pictures into such memory. Pixels of other sizes are the nearest ones. Its tables are made once.
class RowCopier {
public:
    RowCopier() = default;
    RowCopier(std::uint32_t width, std::uint32_t height, const Window& window);
    /// `picture`: its rows from the lowest, as GL reads them.
    void copy(std::span<const std::uint32_t> picture, const PixelRows& rows) const;

private:
    std::uint32_t width_ = 0;
    WindowPart part_;
    std::vector<std::uint32_t> column_;  ///< of the picture, for each of the part's
    std::vector<std::uint32_t> row_;     ///< of the picture, for each of the part's from the top
};

}  // namespace surefoot::gl
