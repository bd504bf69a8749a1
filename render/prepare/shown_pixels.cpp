// Pixels that leaves show, from near to far over a grid of tiles.
#include "render/prepare/shown_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/check.hpp"

namespace surefoot::prepare {

namespace {

constexpr float unseen_layers = 0.5F;  // of what is not in the picture yet

/// How much of a range lies within -limit..limit, in the same unit.
float within(float low, float high, float limit) {
    return std::max(0.0F, std::clamp(high, -limit, limit) - std::clamp(low, -limit, limit));
}

/// A range of tiles, with the shares of the first and the last.
struct Range {
    int first = 0, last = -1;
    float first_share = 0, last_share = 0;
    [[nodiscard]] float share(int i) const { return i == first ? first_share : i == last ? last_share : 1.0F; }
};
Range range_of(float low, float high, int tiles) {
    const auto scaled = [&](float x) { return 0.5F * (std::clamp(x, -1.0F, 1.0F) + 1.0F) * static_cast<float>(tiles); };
    const float from = scaled(low), to = scaled(high);
    if (!(to > from)) return {};
    Range range;
    range.first = std::min(static_cast<int>(from), tiles - 1);
    range.last = std::min(static_cast<int>(to), tiles - 1);
    range.first_share = std::min(to, static_cast<float>(range.first + 1)) - from;
    range.last_share = range.last == range.first ? range.first_share : to - static_cast<float>(range.last);
    return range;
}

}  // namespace

void ShownPixels::reserve(std::uint32_t max_candidates) {
    order_.reserve(max_candidates);
    shown_.resize(max_candidates);
    open_.resize(static_cast<std::size_t>(across) * down);
}

float ShownPixels::show(const Outline& outline, float surface_px, const Tiles& tiles) {
    const Range x = range_of(outline.left, outline.right, across), y = range_of(outline.low, outline.high, down);
    float area = 0, open = 0;
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) {
            const float part = x.share(i) * y.share(j);
            area += part;
            open += part * open_[static_cast<std::size_t>(j * across + i)];
        }
    }
    if (!(area > 0.0F)) return 0.0F;
    float layers = unseen_layers;
    if (surface_px > 0.0F) {
        constexpr float quarter = 0.25F * static_cast<float>(across * down);  // from -1..1 each way to tiles
        const float in_picture =
            quarter * within(outline.left, outline.right, tiles.picture_x) * within(outline.low, outline.high, tiles.picture_y);
        layers = (surface_px / tiles.px + unseen_layers * std::max(0.0F, area - in_picture)) / area;
    }
    const float cover = 1.0F - std::exp(-layers);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            open_[static_cast<std::size_t>(j * across + i)] *= 1.0F - cover * x.share(i) * y.share(j);
    return cover * open * tiles.px;
}

std::span<const float> ShownPixels::run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                                        std::span<const Choice> choices, const model::ViewScale& wide,
                                        const model::ViewScale& picture) {
    const float focal_px = wide.pixels_per_radian;
    const Tiles tiles{4.0F * wide.tan_half_x * wide.tan_half_y * focal_px * focal_px / static_cast<float>(across * down),
                      picture.tan_half_x / wide.tan_half_x, picture.tan_half_y / wide.tan_half_y};
    CHECK(candidates.size() <= shown_.size(), "Shown pixels are of no more candidates than were reserved");
    order_.clear();
    std::fill_n(shown_.begin(), candidates.size(), 0.0F);
    std::fill(open_.begin(), open_.end(), 1.0F);
    for (std::uint32_t i = 0; i < candidates.size(); ++i)
        if (candidates[i].child_count == 0) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return weights[a].distance_m != weights[b].distance_m ? weights[a].distance_m < weights[b].distance_m : a < b;
    });
    for (const std::uint32_t i : order_) {
        const Choice& finest = choices[candidates[i].first_choice + candidates[i].choice_count - 1];
        shown_[i] = show(weights[i].outline, finest.surface_px, tiles);
    }
    return std::span(shown_).first(candidates.size());
}

}  // namespace surefoot::prepare
