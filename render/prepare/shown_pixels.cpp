// Pixels that leaves show: large ones by an item buffer, small ones from near to far over its points.
#include "render/prepare/shown_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/check.hpp"

namespace surefoot::prepare {

namespace {

constexpr float unseen_layers = 0.5F;    // of what is not in the picture yet
constexpr float min_points = 12.0F;      // of an outline: a smaller leaf is not drawn
constexpr float large_points = 2000.0F;  // a seventh of the picture: each triangle is drawn
constexpr float pieces_a_point = 0.5F;

float outline_points(const Outline& outline) {
    const auto inside = [](float low, float high) { return std::max(0.0F, std::min(high, 1.0F) - std::max(low, -1.0F)); };
    return 0.25F * inside(outline.left, outline.right) * inside(outline.low, outline.high) *
           static_cast<float>(ItemBuffer::columns * ItemBuffer::rows);
}

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
    pieces_.resize(max_pieces);
}

float ShownPixels::show(const Outline& outline, float surface_px, float depth_m, const Tiles& tiles) {
    const Range x = range_of(outline.left, outline.right, across), y = range_of(outline.low, outline.high, down);
    double area_sum = 0, open_sum = 0;  // of thousands of points
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) {
            const float part = x.share(i) * y.share(j);
            area_sum += static_cast<double>(part);
            if (depth_m < drawn_.at(i, j).depth)
                open_sum += static_cast<double>(part * open_[static_cast<std::size_t>(j * across + i)]);
        }
    }
    const auto area = static_cast<float>(area_sum), open = static_cast<float>(open_sum);
    if (!(area > 0.0F)) return 0.0F;
    float layers = unseen_layers;
    if (surface_px > 0.0F) {
        constexpr float quarter = 0.25F * static_cast<float>(across * down);  // from -1..1 each way to points
        const float in_picture =
            quarter * within(outline.left, outline.right, tiles.picture_x) * within(outline.low, outline.high, tiles.picture_y);
        layers = (surface_px / tiles.px + unseen_layers * std::max(0.0F, area - in_picture)) / area;
    }
    const float cover = 1.0F - std::exp(-layers);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            if (depth_m < drawn_.at(i, j).depth)
                open_[static_cast<std::size_t>(j * across + i)] *= 1.0F - cover * x.share(i) * y.share(j);
    return cover * open * tiles.px;
}

bool ShownPixels::draw(std::uint32_t leaf, const Choice& finest, const Box& box, float points, const model::ViewScale& wide,
                       const Tiles& tiles, const LeafSurfaces& surfaces) {
    if (pieces_drawn_ >= max_pieces_a_frame) return false;
    const model::PixelEstimator::Pieces of{points > large_points, 16 + static_cast<std::uint32_t>(pieces_a_point * points)};
    const std::ptrdiff_t count =
        surfaces.estimator->pieces(*surfaces.model, finest.rep, box, surfaces.eye, wide, of, std::span(pieces_));
    if (count < 0) return false;
    pieces_drawn_ += static_cast<std::size_t>(count);
    drawn_.draw(leaf, std::span(pieces_).first(static_cast<std::size_t>(count)), tiles.px);
    return true;
}

std::span<const float> ShownPixels::run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                                        std::span<const Choice> choices, const model::ViewScale& wide,
                                        const model::ViewScale& picture, const LeafSurfaces& surfaces) {
    const float focal_px = wide.pixels_per_radian;
    const Tiles tiles{4.0F * wide.tan_half_x * wide.tan_half_y * focal_px * focal_px / static_cast<float>(across * down),
                      picture.tan_half_x / wide.tan_half_x, picture.tan_half_y / wide.tan_half_y};
    CHECK(candidates.size() <= shown_.size(), "Shown pixels are of no more candidates than were reserved");
    order_.clear();
    std::fill_n(shown_.begin(), candidates.size(), 0.0F);
    std::fill(open_.begin(), open_.end(), 1.0F);
    drawn_.clear();
    pieces_drawn_ = 0;
    for (std::uint32_t i = 0; i < candidates.size(); ++i)
        if (candidates[i].child_count == 0) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return weights[a].distance_m != weights[b].distance_m ? weights[a].distance_m < weights[b].distance_m : a < b;
    });
    const auto finest = [&](std::uint32_t i) -> const Choice& {
        return choices[candidates[i].first_choice + candidates[i].choice_count - 1];
    };
    if (surfaces.model != nullptr) {
        std::erase_if(order_, [&](std::uint32_t i) {
            const float points = outline_points(weights[i].outline);
            return points >= min_points &&
                   draw(i, finest(i), surfaces.model->nodes[candidates[i].node].box, points, wide, tiles, surfaces);
        });
    }
    for (const std::uint32_t i : order_) {
        float depth_m = weights[i].distance_m;
        if (surfaces.model != nullptr)
            depth_m = glm::dot(wide.forward, vec3(surfaces.model->nodes[candidates[i].node].box.centre() - surfaces.eye));
        shown_[i] = show(weights[i].outline, finest(i).surface_px, depth_m, tiles);
    }
    const std::span<const ItemBuffer::Point> points = drawn_.points();
    for (std::size_t p = 0; p < points.size(); ++p)
        if (points[p].item != ItemBuffer::none) shown_[points[p].item] += open_[p] * tiles.px;
    return std::span(shown_).first(candidates.size());
}

}  // namespace surefoot::prepare
