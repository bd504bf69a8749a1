// Enlarges a picture by the processor: where the driver is software, its own passes take three times as long.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/view.hpp"

namespace surefoot::gl {

/// Bilinear enlarging between two sizes: pixel centres in their places, edges from inside the picture. Pixels have four channels
/// of 8 bits, each at most 1 off the exact value. Memory is taken when it is made; one thread at a time.
class PixelEnlarger {
public:
    /// Both sizes at least one pixel each way, `from` at most `to`.
    PixelEnlarger(model::Viewport from, model::Viewport to);

    /// Row by row; `source` and `result` have as many pixels as the sizes say.
    void enlarge(std::span<const std::uint32_t> source, std::span<std::uint32_t> result);

private:
    /// By place: the first of two neighbours, and the share of the second in 128ths.
    struct Blend {
        std::uint32_t first = 0;
        std::int16_t share = 0;
    };
    static std::vector<Blend> blends(std::uint32_t from, std::uint32_t to);
    void stretch(std::span<const std::uint32_t> row, std::vector<std::int16_t>& out);
    void mix(std::span<std::uint8_t> out, std::int16_t share) const;

    model::Viewport from_{}, to_{};
    std::vector<Blend> columns_, rows_;
    std::vector<std::int16_t> column_shares_;  ///< four of each column
    std::vector<std::int16_t> wide_;           ///< a row of the source in 16 bits a channel, and its last pixel twice
    std::vector<std::int16_t> upper_, lower_;  ///< two rows of the source, stretched to the full width
};

}  // namespace surefoot::gl
