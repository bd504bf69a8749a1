// Fitting pictures into windows (fit_picture.hpp).
#include "render/gl/fit_picture.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::gl {

WindowPart fitted(std::uint32_t width, std::uint32_t height, const Window& window) {
    if (width == 0 || height == 0 || window.width == 0 || window.height == 0)
        return {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    const double scale = std::min(static_cast<double>(window.width) / width, static_cast<double>(window.height) / height);
    WindowPart part;
    part.width = std::clamp(static_cast<std::int32_t>(std::lround(scale * width)), 1, static_cast<std::int32_t>(window.width));
    part.height = std::clamp(static_cast<std::int32_t>(std::lround(scale * height)), 1, static_cast<std::int32_t>(window.height));
    part.x = (static_cast<std::int32_t>(window.width) - part.width) / 2;
    part.y = (static_cast<std::int32_t>(window.height) - part.height) / 2;
    return part;
}

RowCopier::RowCopier(std::uint32_t width, std::uint32_t height, const Window& window)
    : width_(width), part_(fitted(width, height, window)) {
    const auto nearest = [](std::int32_t at, std::int32_t shown, std::uint32_t drawn, bool turned) {
        const auto pixel =
            static_cast<std::uint32_t>((2 * static_cast<std::int64_t>(at) + 1) * drawn / (2 * static_cast<std::int64_t>(shown)));
        return turned ? drawn - 1 - pixel : pixel;
    };
    column_.resize(static_cast<std::size_t>(part_.width));
    for (std::int32_t x = 0; x < part_.width; ++x)
        column_[static_cast<std::size_t>(x)] = nearest(x, part_.width, width, window.half_turn);
    row_.resize(static_cast<std::size_t>(part_.height));
    for (std::int32_t y = 0; y < part_.height; ++y)  // the picture's lowest row is its first
        row_[static_cast<std::size_t>(y)] = nearest(y, part_.height, height, !window.half_turn);
}

void RowCopier::copy(std::span<const std::uint32_t> picture, const PixelRows& rows) const {
    const bool whole = part_.fills(rows.window);
    const std::int32_t top = static_cast<std::int32_t>(rows.window.height) - part_.y - part_.height;
    for (std::uint32_t y = 0; y < rows.window.height && !whole; ++y)
        std::fill_n(rows.first + y * rows.stride, rows.window.width, 0U);
    const bool copies = column_.size() == width_ && (column_.empty() || column_.front() == 0);
    for (std::size_t y = 0; y < row_.size(); ++y) {
        const std::uint32_t* from = picture.data() + std::size_t{row_[y]} * width_;
        std::uint32_t* to = rows.first + (static_cast<std::size_t>(top) + y) * rows.stride + part_.x;
        if (copies)
            std::copy_n(from, width_, to);
        else
            std::transform(column_.begin(), column_.end(), to, [&](std::uint32_t x) { return from[x]; });
    }
}

}  // namespace surefoot::gl
