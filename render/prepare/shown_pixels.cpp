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
constexpr float samples_a_point = 0.5F;
constexpr std::uint32_t work_a_piece = 4;  // as many points take the same time
constexpr int block = 10, blocks_across = ItemBuffer::columns / block, blocks_down = ItemBuffer::rows / block;  // points a side
constexpr float min_share = 0.001F;  // of a leaf's outline: what comes into sight next is ordered too

/// Of a point.
std::size_t block_of(int x, int y) {
    return static_cast<std::size_t>(y / block) * blocks_across + static_cast<std::size_t>(x / block);
}

float outline_points(const Outline& outline) {
    const auto inside = [](float low, float high) { return std::max(0.0F, std::min(high, 1.0F) - std::max(low, -1.0F)); };
    return 0.25F * inside(outline.left, outline.right) * inside(outline.low, outline.high) *
           static_cast<float>(ItemBuffer::columns * ItemBuffer::rows);
}

/// How much of a range lies within -limit..limit, in the same unit.
float within(float low, float high, float limit) {
    return std::max(0.0F, std::clamp(high, -limit, limit) - std::clamp(low, -limit, limit));
}

/// A range of points, with the shares of the first and the last.
struct Range {
    int first = 0, last = -1;
    float first_share = 0, last_share = 0;
    [[nodiscard]] float share(int i) const { return i == first ? first_share : i == last ? last_share : 1.0F; }
};
Range range_of(float low, float high, int points) {
    const auto scaled = [&](float x) { return 0.5F * (std::clamp(x, -1.0F, 1.0F) + 1.0F) * static_cast<float>(points); };
    const float from = scaled(low), to = scaled(high);
    if (!(to > from)) return {};
    Range range;
    range.first = std::min(static_cast<int>(from), points - 1);
    range.last = std::min(static_cast<int>(to), points - 1);
    range.first_share = std::min(to, static_cast<float>(range.first + 1)) - from;
    range.last_share = range.last == range.first ? range.first_share : to - static_cast<float>(range.last);
    return range;
}

}  // namespace

void ShownPixels::reserve(std::uint32_t max_candidates, std::uint32_t max_hidden) {
    order_.reserve(max_candidates);
    shown_.resize(max_candidates);
    coarse_.reserve(max_candidates);
    sky_.reserve(max_candidates, max_hidden);
    open_.resize(static_cast<std::size_t>(across) * down);
    pieces_.resize(model::PixelEstimator::max_pieces);
    blocks_.reserve(open_.size());
    blocks_before_.reserve(open_.size());
}

float ShownPixels::cover(const Outline& outline, float surface_px, float points, const Grid& grid) {
    float layers = unseen_layers;
    if (surface_px > 0.0F) {
        constexpr float quarter = 0.25F * static_cast<float>(across * down);  // from -1..1 each way to points
        const float in_picture =
            quarter * within(outline.left, outline.right, grid.picture_x) * within(outline.low, outline.high, grid.picture_y);
        layers = (surface_px / grid.point_px + unseen_layers * std::max(0.0F, points - in_picture)) / points;
    }
    return 1.0F - std::exp(-layers);
}

void ShownPixels::begin_blocks() {
    blocks_.assign(static_cast<std::size_t>(blocks_across) * blocks_down, 0.0F);
    constexpr float of_point = 1.0F / static_cast<float>(block * block);
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x)
            if (drawn_.at(x, y).item == ItemBuffer::none) blocks_[block_of(x, y)] += of_point;
    blocks_before_ = blocks_;
}

/// What blocks lost, their open points lose.
void ShownPixels::end_blocks() {
    for (int y = 0; y < down; ++y) {
        for (int x = 0; x < across; ++x) {
            const std::size_t at = block_of(x, y);
            const float before = blocks_before_[at];
            if (before > 0.0F && drawn_.at(x, y).item == ItemBuffer::none) open_[ItemBuffer::place(x, y)] = blocks_[at] / before;
        }
    }
}

float ShownPixels::show_coarsely(const Outline& outline, float surface_px, const Grid& grid) {
    const float points = outline_points(outline);
    if (!(points > 0.0F)) return 0.0F;
    if (blocks_.empty()) begin_blocks();
    const float covered = cover(outline, surface_px, points, grid);
    const Range x = range_of(outline.left, outline.right, blocks_across), y = range_of(outline.low, outline.high, blocks_down);
    float open = 0;
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) {
            float& of_block = blocks_[block_of(i * block, j * block)];
            const float taken = covered * x.share(i) * y.share(j) * of_block;
            open += taken;
            of_block -= taken;
        }
    }
    return open * static_cast<float>(block * block) * grid.point_px;
}

float ShownPixels::show(const Outline& outline, float surface_px, float depth_m, std::uint32_t rank, const Grid& grid) {
    const Range x = range_of(outline.left, outline.right, across), y = range_of(outline.low, outline.high, down);
    double area_sum = 0, open_sum = 0;  // of thousands of points
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) {
            const float part = x.share(i) * y.share(j);
            area_sum += static_cast<double>(part);
            drawn_.cover(i, j, rank);
            if (depth_m < drawn_.at(i, j).depth) open_sum += static_cast<double>(part * open_[ItemBuffer::place(i, j)]);
        }
    }
    const auto area = static_cast<float>(area_sum), open = static_cast<float>(open_sum);
    if (!(area > 0.0F)) return 0.0F;
    const float covered = cover(outline, surface_px, area, grid);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            if (depth_m < drawn_.at(i, j).depth) open_[ItemBuffer::place(i, j)] *= 1.0F - covered * x.share(i) * y.share(j);
    return covered * open * grid.point_px;
}

bool ShownPixels::draw(std::uint32_t leaf, const Candidate& candidate, const Choice& finest, const Outline& outline,
                       const model::ViewScale& wide, const Grid& grid, const LeafSurfaces& surfaces) {
    if (work_ >= max_work) return false;
    const float points = outline_points(outline);
    const model::PixelEstimator::Pieces of{points >= large_points, 16 + static_cast<std::uint32_t>(samples_a_point * points)};
    const model::Representation& rep = surfaces.model->reps[finest.rep];
    work_ += work_a_piece * std::min(rep.triangles, of.each_triangle ? static_cast<std::uint32_t>(pieces_.size()) : 256U);
    const auto pieces_in = [&](const Box& box, const dvec3& eye, const model::ViewScale& view) {
        return surfaces.estimator->pieces(*surfaces.model, finest.rep, box, eye, view, of, std::span(pieces_));
    };
    const auto moving = surfaces.moving != nullptr ? surfaces.moving->find(candidate.node) : std::nullopt;
    const std::ptrdiff_t count =
        moving ? pieces_in(moving->rest, moving->pose.back(surfaces.eye), model::turned_back(wide, moving->pose))
               : pieces_in(surfaces.model->nodes[candidate.node].box, surfaces.eye, wide);
    if (count < 0) return false;
    const Range x = range_of(outline.left, outline.right, across), y = range_of(outline.low, outline.high, down);
    const ItemBuffer::Item item{leaf,
                                candidate.node,
                                {x.first, y.first, x.last, y.last},
                                grid.point_px,
                                work_ < max_work ? max_work - work_ : 0U,
                                sky_.rank(leaf)};
    work_ += drawn_.draw(item, std::span(pieces_).first(static_cast<std::size_t>(count)));
    return true;
}

void ShownPixels::show_before_sky(std::uint32_t leaf, float pixels, const Weight& of, int x, int y, const Grid& grid) {
    const auto beside = [](int i, int points, float picture) {
        return std::abs((static_cast<float>(2 * i + 1) / static_cast<float>(points)) - 1.0F) > picture;
    };
    if (!beside(x, across, grid.picture_x) && !beside(y, down, grid.picture_y))
        sky_.show(leaf, pixels, of.pixel_weight, drawn_, x, y);
}

void ShownPixels::show_before_sky(std::uint32_t leaf, const Weight& of, const Grid& grid) {
    const auto point = [](float low, float high, int count) {
        const float middle = 0.5F * (std::clamp(low, -1.0F, 1.0F) + std::clamp(high, -1.0F, 1.0F));
        return std::min(count - 1, static_cast<int>(0.5F * (middle + 1.0F) * static_cast<float>(count)));
    };
    const Outline& o = of.outline;
    if (o.right > o.left && o.high > o.low)
        show_before_sky(leaf, shown_[leaf], of, point(o.left, o.right, across), point(o.low, o.high, down), grid);
}

std::span<const float> ShownPixels::run(std::span<const Weight> weights, std::span<const Candidate> candidates,
                                        std::span<const Choice> choices, const model::ViewScale& wide,
                                        const model::ViewScale& picture, const LeafSurfaces& surfaces,
                                        std::span<const HiddenNode> hidden) {
    const float focal_px = wide.pixels_per_radian;
    const Grid grid{4.0F * wide.tan_half_x * wide.tan_half_y * focal_px * focal_px / static_cast<float>(across * down),
                    picture.tan_half_x / wide.tan_half_x, picture.tan_half_y / wide.tan_half_y};
    CHECK(candidates.size() <= shown_.size(), "Shown pixels are of no more candidates than were reserved");
    order_.clear();
    std::fill_n(shown_.begin(), candidates.size(), 0.0F);
    std::fill(open_.begin(), open_.end(), 1.0F);
    drawn_.clear();
    work_ = 0;
    blocks_.clear();
    sky_.begin(candidates, hidden);
    coarse_.clear();
    for (std::uint32_t i = 0; i < candidates.size(); ++i)
        if (candidates[i].child_count == 0) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return weights[a].distance_m != weights[b].distance_m ? weights[a].distance_m < weights[b].distance_m : a < b;
    });
    const auto finest = [&](std::uint32_t i) -> const Choice& {
        return choices[candidates[i].first_choice + candidates[i].choice_count - 1];
    };
    if (surfaces.model != nullptr) {
        std::size_t small = 0;  // they stay in order_
        for (const std::uint32_t i : order_) {
            const Outline& outline = weights[i].outline;
            shown_[i] = min_share * outline_points(outline) * grid.point_px;
            if (outline_points(outline) < min_points)
                order_[small++] = i;
            else if (!draw(i, candidates[i], finest(i), outline, wide, grid, surfaces)) {
                shown_[i] += show_coarsely(outline, finest(i).surface_px, grid);
                sky_.cover(outline, sky_.rank(i));
                coarse_.push_back(i);
            }
        }
        order_.resize(small);
        if (!blocks_.empty()) end_blocks();
    }
    for (const std::uint32_t i : order_) {
        float depth_m = weights[i].distance_m;
        if (surfaces.model != nullptr) {
            const Box box = surfaces.moving != nullptr ? surfaces.moving->box(candidates[i].node)
                                                       : surfaces.model->nodes[candidates[i].node].box;
            depth_m =
                glm::dot(wide.forward, vec3(box.centre() - surfaces.eye)) - glm::dot(glm::abs(wide.forward), vec3(box.half()));
        }
        shown_[i] += show(weights[i].outline, finest(i).surface_px, depth_m, sky_.rank(i), grid);
    }
    for (const std::uint32_t i : order_) show_before_sky(i, weights[i], grid);
    for (const std::uint32_t i : coarse_) show_before_sky(i, weights[i], grid);
    for (int y = 0; y < down; ++y) {
        for (int x = 0; x < across; ++x) {
            const std::uint32_t i = drawn_.at(x, y).item;
            if (i == ItemBuffer::none) continue;
            const float pixels = open_[ItemBuffer::place(x, y)] * grid.point_px;
            shown_[i] += pixels;
            show_before_sky(i, pixels, weights[i], x, y, grid);
        }
    }
    return std::span(shown_).first(candidates.size());
}

}  // namespace surefoot::prepare
