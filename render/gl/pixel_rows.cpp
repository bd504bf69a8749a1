// Copying pictures into memory of a screen (pixel_rows.hpp).
#include "render/gl/pixel_rows.hpp"

#include <algorithm>

namespace surefoot::gl {

RowCopier::RowCopier(std::uint32_t width, std::uint32_t height, const Surface& surface)
    : width_(width), fit_(fit_picture(width, height, surface.width, surface.height)) {
    const auto nearest = [](std::int32_t at, std::int32_t shown, std::uint32_t drawn, bool turned) {
        const auto pixel =
            static_cast<std::uint32_t>((2 * static_cast<std::int64_t>(at) + 1) * drawn / (2 * static_cast<std::int64_t>(shown)));
        return turned ? drawn - 1 - pixel : pixel;
    };
    column_.resize(static_cast<std::size_t>(fit_.width));
    for (std::int32_t x = 0; x < fit_.width; ++x)
        column_[static_cast<std::size_t>(x)] = nearest(x, fit_.width, width, surface.half_turn);
    row_.resize(static_cast<std::size_t>(fit_.height));
    for (std::int32_t y = 0; y < fit_.height; ++y)  // the picture's lowest row is its first
        row_[static_cast<std::size_t>(y)] = nearest(y, fit_.height, height, !surface.half_turn);
}

void RowCopier::copy(std::span<const std::uint32_t> picture, const PixelRows& rows) const {
    const bool whole = static_cast<std::uint32_t>(fit_.width) == rows.surface.width &&
                       static_cast<std::uint32_t>(fit_.height) == rows.surface.height;
    const std::int32_t top = static_cast<std::int32_t>(rows.surface.height) - fit_.y - fit_.height;
    for (std::uint32_t y = 0; y < rows.surface.height && !whole; ++y)
        std::fill_n(rows.first + y * rows.stride, rows.surface.width, 0U);
    const bool copies = column_.size() == width_ && (column_.empty() || column_.front() == 0);
    for (std::size_t y = 0; y < row_.size(); ++y) {
        const std::uint32_t* from = picture.data() + std::size_t{row_[y]} * width_;
        std::uint32_t* to = rows.first + (static_cast<std::size_t>(top) + y) * rows.stride + fit_.x;
        if (copies)
            std::copy_n(from, width_, to);
        else
            std::transform(column_.begin(), column_.end(), to, [&](std::uint32_t x) { return from[x]; });
    }
}

}  // namespace surefoot::gl
