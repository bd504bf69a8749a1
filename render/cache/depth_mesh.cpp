// Decimates depth pictures. Errors are found from the smallest triangles up: each triangle differs from its two halves by no more
// than the middle of its longest side does.
#include "render/cache/depth_mesh.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "rt/base/check.hpp"

namespace surefoot::cache {

namespace {

constexpr float must_split = std::numeric_limits<float>::infinity();
/// A corner is a mean of up to four texels, each joined to the next: none is farther from it than one and a half steps.
constexpr float max_step_share = 2.0F / 3;
constexpr std::uint32_t max_corners = 0xffff;  // known_ holds a number more

/// Quadrants about a point: bit 0 to the right, bit 1 above.
constexpr unsigned quadrants = 4;

int x_of(unsigned quadrant) { return (quadrant & 1U) != 0 ? 0 : -1; }
int y_of(unsigned quadrant) { return (quadrant & 2U) != 0 ? 0 : -1; }

/// Where a triangle lies, seen from one of its corners.
unsigned towards(int dx, int dy) { return (dx >= 0 ? 1U : 0U) | (dy >= 0 ? 2U : 0U); }

/// The first or second triangle with this longest side's middle, by its apex.
std::size_t side_of(int mx, int my, int ax, int ay) { return ax > mx || (ax == mx && ay > my) ? 0 : 1; }

}  // namespace

double mesh_tolerance(const Picture& picture, double share) { return 0.5 * share * (1 / picture.near_m - 1 / picture.far_m); }

double mesh_error(const Picture& picture, double tolerance, const dvec3& eye) {
    const dvec3 by = eye - picture.eye;
    const double ahead = glm::dot(by, picture.forward), near = picture.near_m - ahead;
    const double aside = glm::length(by - ahead * picture.forward);
    if (!(near >= model::near_plane_m) || !std::isfinite(aside)) return std::numeric_limits<double>::infinity();
    const double nearer = ahead > 0 ? picture.near_m / near : picture.far_m / (picture.far_m - ahead);
    return tolerance * nearer * nearer * (aside + picture.tangent * std::abs(ahead));
}

DepthMesher::DepthMesher(std::uint32_t max_texels, std::uint32_t max_triangles) : stride_(max_texels) {
    CHECK(std::has_single_bit(max_texels), "The side of a depth picture is a power of two");
    const std::size_t texels = stride_ * stride_, points = (stride_ + 1) * (stride_ + 1);
    depths_.resize(texels);
    values_.resize(points);
    errors_.resize(points);
    covers_.resize(2 * points);
    known_.resize(quadrants * points);
    max_indices_ = std::size_t{3} * max_triangles;
    indices_.reserve(max_indices_);
    corners_.reserve(std::min<std::size_t>(max_corners, max_indices_));
}

/// The lowest quadrant that is joined to this one, round the point.
unsigned DepthMesher::group_of(Point p, unsigned quadrant) const {
    constexpr std::array<unsigned, quadrants> round = {0, 1, 3, 2};
    std::array<float, quadrants> depths{};
    for (unsigned i = 0; i < quadrants; ++i) depths[i] = texel(p.x + x_of(round[i]), p.y + y_of(round[i]));
    const auto here = static_cast<unsigned>(std::find(round.begin(), round.end(), quadrant) - round.begin());
    unsigned lowest = quadrant;
    for (unsigned i = here; i < here + 3 && joined(depths[i % 4], depths[(i + 1) % 4]); ++i)
        lowest = std::min(lowest, round[(i + 1) % 4]);
    for (unsigned i = here + 4; i > here + 1 && joined(depths[i % 4], depths[(i - 1) % 4]); --i)
        lowest = std::min(lowest, round[(i - 1) % 4]);
    return lowest;
}

/// The mean of the texels round the point that belong to the skin of one of them.
float DepthMesher::value(Point p, unsigned quadrant) const {
    if (const float same = values_[at(p)]; same >= 0) return same;
    const unsigned group = group_of(p, quadrant);
    float sum = 0, count = 0;
    for (unsigned q = 0; q < quadrants; ++q) {
        const float depth = texel(p.x + x_of(q), p.y + y_of(q));
        if (!(depth > 0) || group_of(p, q) != group) continue;
        sum += depth;
        ++count;
    }
    return count > 0 ? sum / count : 0.0F;
}

void DepthMesher::fill_values() {
    for (int y = 0; y <= side_; ++y) {
        for (int x = 0; x <= side_; ++x) {
            const float a = texel(x - 1, y - 1), b = texel(x, y - 1), c = texel(x, y), d = texel(x - 1, y);
            const bool whole = joined(a, b) && joined(b, c) && joined(c, d) && joined(d, a);
            values_[at({x, y})] = whole ? 0.25F * (a + b + c + d) : -1.0F;
        }
    }
}

/// Parts of a line, level or upright, whose two texels are not joined.
int DepthMesher::cuts_along(Point from, Point to) const {
    const int dx = to.x > from.x ? 1 : to.x < from.x ? -1 : 0, dy = to.y > from.y ? 1 : to.y < from.y ? -1 : 0;
    int cuts = 0;
    for (Point p = from; p.x != to.x || p.y != to.y; p.x += dx, p.y += dy) {
        const int x = dx < 0 ? p.x - 1 : p.x, y = dy < 0 ? p.y - 1 : p.y;
        cuts += (dx == 0 ? joined(texel(x - 1, y), texel(x, y)) : joined(texel(x, y - 1), texel(x, y))) ? 0 : 1;
    }
    return cuts;
}

/// The two triangles that share a level or an upright longest side of 2 * half. Their halves lie in squares of side `half`.
void DepthMesher::judge_edge(Point middle, int half, bool horizontal) {
    const Point a = horizontal ? Point{middle.x - half, middle.y} : Point{middle.x, middle.y - half};
    const Point b = horizontal ? Point{middle.x + half, middle.y} : Point{middle.x, middle.y + half};
    float error = 0;
    for (const int way : {1, -1}) {
        const Point apex = horizontal ? Point{middle.x, middle.y + way * half} : Point{middle.x + way * half, middle.y};
        const std::size_t which = 2 * at(middle) + side_of(middle.x, middle.y, apex.x, apex.y);
        covers_[which] = Filled::nothing;
        if (apex.x < 0 || apex.y < 0 || apex.x > side_ || apex.y > side_) continue;
        std::array<Filled, 2> covers{};
        std::array<float, 2> errors{};
        for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
            const Point& from = end == 0 ? a : b;
            if (half == 1) {
                const int x = std::min(from.x, apex.x), y = std::min(from.y, apex.y);
                const float depth = texel(x, y);
                covers[end] = depth > 0 ? Filled::all : Filled::nothing;
                if (!(depth > 0)) continue;
                const float shown =
                    0.5F * (value(from, towards(x - from.x, y - from.y)) + value(apex, towards(x - apex.x, y - apex.y)));
                errors[end] = std::abs(depth - shown);
            } else {
                const Point square{(from.x + apex.x) / 2, (from.y + apex.y) / 2};
                covers[end] = covers_[2 * at(square) + side_of(square.x, square.y, middle.x, middle.y)];
                errors[end] = errors_[at(square)];
            }
        }
        Filled cover = covers[0] == covers[1] ? covers[0] : Filled::mixed;
        if (cover == Filled::all && cuts_along(middle, apex) > 0) cover = Filled::mixed;
        covers_[which] = cover;
        if (cover == Filled::mixed) error = must_split;
        if (cover != Filled::all || error == must_split) continue;
        const int in_x = apex.x - middle.x, in_y = apex.y - middle.y;
        const float flat = 0.5F * (value(a, towards(middle.x - a.x + in_x, middle.y - a.y + in_y)) +
                                   value(b, towards(middle.x - b.x + in_x, middle.y - b.y + in_y)));
        const float bulge = std::abs(value(middle, towards(in_x, in_y)) - flat);
        error = std::max(error, bulge + std::max(errors[0], errors[1]));
    }
    // Along a cut, sides are as short as walls are: else there would be cracks between them.
    const bool both = covers_[2 * at(middle)] == Filled::all && covers_[2 * at(middle) + 1] == Filled::all;
    if (both && cuts_along(a, b) > 0) error = must_split;
    errors_[at(middle)] = error;
}

/// The two halves of a square of side 2 * half, cut along the diagonal that leads to the middle of the next larger one.
void DepthMesher::judge_square(Point middle, int half) {
    const bool rises = (((middle.x - half) / (2 * half) + (middle.y - half) / (2 * half)) & 1) == 0;
    const int up = rises ? half : -half;
    const Point a{middle.x - half, middle.y - up}, b{middle.x + half, middle.y + up};
    float error = 0;
    for (const Point apex : {Point{b.x, a.y}, Point{a.x, b.y}}) {
        const std::size_t which = 2 * at(middle) + side_of(middle.x, middle.y, apex.x, apex.y);
        const Point level{middle.x, apex.y}, upright{apex.x, middle.y};
        const Filled first = covers_[2 * at(level) + side_of(level.x, level.y, middle.x, middle.y)];
        const Filled second = covers_[2 * at(upright) + side_of(upright.x, upright.y, middle.x, middle.y)];
        const Filled cover = first == second ? first : Filled::mixed;
        covers_[which] = cover;
        if (cover == Filled::mixed) error = must_split;
        if (cover != Filled::all || error == must_split) continue;
        const auto seen_from = [&](const Point& p) { return towards(middle.x - p.x, middle.y - p.y); };
        const float flat = 0.5F * (value(a, seen_from(a)) + value(b, seen_from(b)));
        const float bulge = std::abs(value(middle, towards(apex.x - middle.x, apex.y - middle.y)) - flat);
        error = std::max(error, bulge + std::max(errors_[at(level)], errors_[at(upright)]));
    }
    errors_[at(middle)] = error;
}

/// The corner of a skin at a point. max_corners: there is no room.
std::uint16_t DepthMesher::corner(Point p, unsigned quadrant) {
    std::uint16_t& known = known_[quadrants * at(p) + (values_[at(p)] >= 0 ? 0U : group_of(p, quadrant))];
    if (known > 0) return static_cast<std::uint16_t>(known - 1);
    if (corners_.size() == corners_.capacity() || corners_.size() >= max_corners) return max_corners;
    const auto x = static_cast<float>(p.x), y = static_cast<float>(p.y);
    corners_.push_back({x, y, value(p, quadrant), x, y});
    known = static_cast<std::uint16_t>(corners_.size());
    return static_cast<std::uint16_t>(known - 1);
}

bool DepthMesher::add(Point a, Point b, Point apex) {
    if (indices_.size() + 3 > max_indices_) return false;
    for (const Point& p : {a, b, apex}) {
        const std::uint16_t index = corner(p, towards(a.x + b.x + apex.x - 3 * p.x, a.y + b.y + apex.y - 3 * p.y));
        if (index == max_corners) return false;
        indices_.push_back(index);
    }
    return true;
}

/// False: there are too many triangles.
bool DepthMesher::split(Point a, Point b, Point apex) {
    if (std::abs(a.x - b.x) == 1 && std::abs(a.y - b.y) == 1)
        return !(texel(std::min(a.x, b.x), std::min(a.y, b.y)) > 0) || add(a, b, apex);
    const Point middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
    if (covers_[2 * at(middle) + side_of(middle.x, middle.y, apex.x, apex.y)] == Filled::nothing) return true;
    if (errors_[at(middle)] <= tolerance_) return add(a, b, apex);
    return split(a, apex, middle) && split(apex, b, middle);
}

/// Of two texels that a line parts: below it or to its left, and the other one. It runs to the right or up.
bool DepthMesher::add_wall(Point from, Point to, bool low_is_near, bool horizontal) {
    if (indices_.size() + 6 > max_indices_ || corners_.size() + 4 > corners_.capacity()) return false;
    // From an end of the line, quadrants of the texels: those towards the other end.
    const unsigned along = horizontal ? 1U : 2U, high = horizontal ? 2U : 1U;
    const unsigned far_side = low_is_near ? high : 0U, near_side = low_is_near ? 0U : high;
    const float shift = low_is_near ? 0.5F : -0.5F;
    const auto first = static_cast<std::uint16_t>(corners_.size());
    for (const bool end : {false, true}) {
        const Point p = end ? to : from;
        const unsigned inward = end ? 0U : along;
        const auto x = static_cast<float>(p.x), y = static_cast<float>(p.y);
        const float inner = end ? -0.5F : 0.5F;
        const float at_x = horizontal ? x + inner : x + shift, at_y = horizontal ? y + shift : y + inner;
        for (const unsigned side : {near_side, far_side}) corners_.push_back({x, y, value(p, inward | side), at_x, at_y});
    }
    for (const int i : {0, 1, 2, 2, 1, 3}) indices_.push_back(static_cast<std::uint16_t>(first + i));
    walls_ += 2;
    return true;
}

/// Between skins: where neighbours that are both covered are not joined.
bool DepthMesher::add_walls() {
    for (int y = 0; y < side_; ++y) {
        for (int x = 0; x < side_; ++x) {
            const float here = texel(x, y), right = texel(x + 1, y), above = texel(x, y + 1);
            if (!(here > 0)) continue;
            if (right > 0 && !joined(here, right) && !add_wall({x + 1, y}, {x + 1, y + 1}, here > right, false)) return false;
            if (above > 0 && !joined(here, above) && !add_wall({x, y + 1}, {x + 1, y + 1}, here > above, true)) return false;
        }
    }
    return true;
}

DepthMeshResult DepthMesher::make(std::span<const float> inverse_depths, std::uint32_t texels, const DepthMeshLimits& limits) {
    CHECK(std::has_single_bit(texels) && texels <= stride_, "The side of a depth picture is a power of two, up to the largest");
    CHECK(inverse_depths.size() >= std::size_t{texels} * texels, "A depth picture has a depth for each texel");
    side_ = static_cast<int>(texels);
    tolerance_ = std::max(0.0F, limits.tolerance);
    max_step_ = max_step_share * tolerance_;
    max_indices_ = std::min(indices_.capacity(), std::size_t{3} * limits.max_triangles);
    corners_.clear();
    indices_.clear();
    covered_ = walls_ = 0;
    for (int y = 0; y < side_; ++y) {
        for (int x = 0; x < side_; ++x) {
            const float depth = inverse_depths[static_cast<std::size_t>(y) * texels + x];
            const bool covered = depth > 0 && std::isfinite(depth);
            depths_[static_cast<std::size_t>(y) * stride_ + x] = covered ? depth : 0.0F;
            covered_ += covered ? 1 : 0;
        }
    }
    if (covered_ == 0) return DepthMeshResult::empty;
    fill_values();
    std::fill_n(known_.begin(), quadrants * (at({side_, side_}) + 1), std::uint16_t{0});
    for (int half = 1; half < side_; half *= 2) {
        for (int y = 0; y <= side_; y += half)
            for (int x = (y / half) % 2 == 0 ? half : 0; x <= side_; x += 2 * half) judge_edge({x, y}, half, (y / half) % 2 == 0);
        for (int y = half; y < side_; y += 2 * half)
            for (int x = half; x < side_; x += 2 * half) judge_square({x, y}, half);
    }
    const Point low{0, 0}, high{side_, side_};
    if (!split(low, high, {side_, 0}) || !split(low, high, {0, side_}) || !add_walls()) {
        corners_.clear();
        indices_.clear();
        return DepthMeshResult::too_dear;
    }
    return DepthMeshResult::made;
}

}  // namespace surefoot::cache
