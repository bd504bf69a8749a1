// Bilinear enlarging, row by row: first to the full width, then between two rows (enlarge_pixels.hpp).
#include "render/gl/enlarge_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace surefoot::gl {

namespace {

// Vectors in the compiler's own words: any processor has them.
using Two [[gnu::vector_size(16)]] = std::int64_t;       ///< pixels of four channels
using Channels [[gnu::vector_size(16)]] = std::int16_t;  ///< of two pixels
using Bytes [[gnu::vector_size(8)]] = std::uint8_t;
constexpr std::size_t lanes = 8;
constexpr int share_bits = 7;  // a difference of 255 times 128 still fits 16 bits

template <class Vector>
Vector load(const std::int16_t* from) {
    Vector v;
    std::memcpy(&v, from, sizeof(v));
    return v;
}

/// From a to b.
template <class T, class S>
T blended(T a, T b, S share) {
    return static_cast<T>(a + (((b - a) * share + (1 << (share_bits - 1))) >> share_bits));
}

}  // namespace

std::vector<PixelEnlarger::Blend> PixelEnlarger::blends(std::uint32_t from, std::uint32_t to) {
    std::vector<Blend> out(to);
    for (std::uint32_t i = 0; i < to; ++i) {
        const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, static_cast<double>(from - 1));
        out[i].first = static_cast<std::uint32_t>(at);
        out[i].share = static_cast<std::int16_t>(std::lround((1 << share_bits) * (at - out[i].first)));
    }
    return out;
}

PixelEnlarger::PixelEnlarger(model::Viewport from, model::Viewport to)
    : from_(from),
      to_(to),
      columns_(blends(from.width, to.width)),
      rows_(blends(from.height, to.height)),
      wide_(4 * (std::size_t{from.width} + 1)),
      upper_(4 * std::size_t{to.width}),
      lower_(4 * std::size_t{to.width}) {
    for (const Blend& column : columns_) column_shares_.insert(column_shares_.end(), 4, column.share);
}

/// One row of the source at the full width, two pixels at once.
void PixelEnlarger::stretch(std::span<const std::uint32_t> row, std::vector<std::int16_t>& out) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(row.data());
    const std::size_t channels = 4 * std::size_t{from_.width};
    std::size_t i = 0;
    for (; i + lanes <= channels; i += lanes) {
        Bytes bytes8;
        std::memcpy(&bytes8, bytes + i, sizeof(bytes8));
        const Channels eight = __builtin_convertvector(bytes8, Channels);
        std::memcpy(wide_.data() + i, &eight, sizeof(eight));
    }
    for (; i < channels; ++i) wide_[i] = bytes[i];
    std::copy_n(wide_.data() + channels - 4, 4, wide_.data() + channels);
    std::size_t x = 0;
    for (; x + 2 <= columns_.size(); x += 2) {
        const Two left = load<Two>(wide_.data() + 4 * std::size_t{columns_[x].first});
        const Two right = load<Two>(wide_.data() + 4 * std::size_t{columns_[x + 1].first});
        const auto a = reinterpret_cast<Channels>(__builtin_shufflevector(left, right, 0, 2));
        const auto b = reinterpret_cast<Channels>(__builtin_shufflevector(left, right, 1, 3));
        const Channels p = blended(a, b, load<Channels>(column_shares_.data() + 4 * x));
        std::memcpy(out.data() + 4 * x, &p, sizeof(p));
    }
    for (; x < columns_.size(); ++x) {
        const std::int16_t* at = wide_.data() + 4 * std::size_t{columns_[x].first};
        for (std::size_t c = 0; c < 4; ++c) out[4 * x + c] = blended<std::int16_t, int>(at[c], at[4 + c], columns_[x].share);
    }
}

/// A row between the two stretched ones.
void PixelEnlarger::mix(std::span<std::uint8_t> out, std::int16_t share) const {
    std::size_t i = 0;
    for (; i + lanes <= out.size(); i += lanes) {
        const Channels p = blended(load<Channels>(upper_.data() + i), load<Channels>(lower_.data() + i), share);
        const Bytes bytes8 = __builtin_convertvector(p, Bytes);
        std::memcpy(out.data() + i, &bytes8, sizeof(bytes8));
    }
    for (; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(blended<std::int16_t, int>(upper_[i], lower_[i], share));
}

void PixelEnlarger::enlarge(std::span<const std::uint32_t> source, std::span<std::uint32_t> result) {
    const auto row = [&](std::uint32_t y) { return source.subspan(std::size_t{y} * from_.width, from_.width); };
    std::uint32_t upper = from_.height, lower = from_.height;  // which rows the stretched ones are: none yet
    for (std::uint32_t y = 0; y < to_.height; ++y) {
        const std::uint32_t first = rows_[y].first, second = std::min(first + 1, from_.height - 1);
        if (upper != first) {
            if (lower == first)
                upper_.swap(lower_);
            else
                stretch(row(first), upper_);
            lower = from_.height;
        }
        if (lower != second) stretch(row(second), lower_);
        upper = first;
        lower = second;
        mix({reinterpret_cast<std::uint8_t*>(result.data() + std::size_t{y} * to_.width), 4 * std::size_t{to_.width}},
            rows_[y].share);
    }
}

}  // namespace surefoot::gl
